#include "services/visual_odometry/core/patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace thalweg::visual_odometry {
namespace {

constexpr int kMostPatchSteps = 15;
constexpr float kSettledPatch = 0.01F;  // [px]
constexpr float kLeastInformation =
    40.0F;  // mean squared gradient in the weakest direction [gray^2 / px^2] * pixels

float Interpolate(const cv::Mat& image, float u, float v) {
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const float a = u - static_cast<float>(column);
  const float b = v - static_cast<float>(row);
  const std::uint8_t* const p = image.ptr<std::uint8_t>(row) + column;
  const std::uint8_t* const q = p + image.step;
  const float top = static_cast<float>(p[0]) + a * static_cast<float>(p[1] - p[0]);
  const float bottom = static_cast<float>(q[0]) + a * static_cast<float>(q[1] - q[0]);
  return top + b * (bottom - top);
}

bool IsInside(const cv::Mat& image, const Eigen::Vector2f& p, float margin) {
  return p.x() >= margin && p.y() >= margin && p.x() < static_cast<float>(image.cols - 1) - margin &&
         p.y() < static_cast<float>(image.rows - 1) - margin;
}

/// Largest distance along an axis that a warped square of half-size `half` reaches from its center.
float Reach(const Eigen::Matrix2f& to_image, float half) {
  return half * to_image.cwiseAbs().rowwise().sum().maxCoeff();
}

/// The smaller eigenvalue.
float Weakest(const Eigen::Matrix2f& information) {
  const float trace = information.trace();
  return 0.5F * trace - std::sqrt(std::max(0.0F, 0.25F * trace * trace - information.determinant()));
}

}  // namespace

Pyramid MakePyramid(const cv::Mat& image, int levels) {
  Pyramid pyramid(static_cast<std::size_t>(levels));
  cv::GaussianBlur(image, pyramid[0], {3, 3}, 0.7);
  for (std::size_t level = 1; level < pyramid.size(); ++level)
    cv::pyrDown(pyramid[level - 1], pyramid[level]);
  return pyramid;
}

cv::Mat WithoutLight(const cv::Mat& image) {
  cv::Mat mean;
  cv::boxFilter(image, mean, CV_8U, {15, 15});
  cv::Mat result;
  cv::addWeighted(image, 2.0, mean, -2.0, 128.0, result, CV_8U);
  return result;
}

std::optional<Patch> Patch::Cut(const cv::Mat& image, const Eigen::Vector2f& center,
                                const Eigen::Matrix2f& to_image) {
  constexpr int kWide = kSize + 2;
  if (!IsInside(image, center, Reach(to_image, kRadius + 1))) return std::nullopt;
  std::array<float, kWide * kWide> wide;
  for (int row = 0; row < kWide; ++row) {
    for (int column = 0; column < kWide; ++column) {
      const Eigen::Vector2f p = center + to_image * Eigen::Vector2f(static_cast<float>(column - kRadius - 1),
                                                                    static_cast<float>(row - kRadius - 1));
      wide[static_cast<std::size_t>(row * kWide + column)] = Interpolate(image, p.x(), p.y());
    }
  }
  Patch patch;
  patch.information_.setZero();
  float sum = 0.0F;
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      const auto at = static_cast<std::size_t>((row + 1) * kWide + column + 1);
      const auto k = static_cast<std::size_t>(row * kSize + column);
      const Eigen::Vector2f gradient(0.5F * (wide[at + 1] - wide[at - 1]),
                                     0.5F * (wide[at + kWide] - wide[at - kWide]));
      patch.value_[k] = wide[at];
      patch.gradient_u_[k] = gradient.x();
      patch.gradient_v_[k] = gradient.y();
      patch.information_ += gradient * gradient.transpose();
      sum += wide[at];
    }
  }
  const float mean = sum / static_cast<float>(kPixels);
  for (float& value : patch.value_) {
    value -= mean;
    patch.energy_ += value * value;
  }
  if (Weakest(patch.information_) < kLeastInformation) return std::nullopt;
  patch.Orthogonalise(patch.gradient_u_);
  patch.Orthogonalise(patch.gradient_v_);
  patch.information_.setZero();
  for (std::size_t k = 0; k < kPixels; ++k) {
    const Eigen::Vector2f gradient(patch.gradient_u_[k], patch.gradient_v_[k]);
    patch.information_ += gradient * gradient.transpose();
  }
  if (Weakest(patch.information_) < 0.1F * kLeastInformation) return std::nullopt;
  return patch;
}

void Patch::Orthogonalise(std::array<float, kPixels>& gradient) const {
  float sum = 0.0F;
  float product = 0.0F;
  for (std::size_t k = 0; k < kPixels; ++k) {
    sum += gradient[k];
    product += gradient[k] * value_[k];
  }
  const float mean = sum / static_cast<float>(kPixels);
  const float share = product / energy_;
  for (std::size_t k = 0; k < kPixels; ++k) gradient[k] -= mean + share * value_[k];
}

template <bool kAlongRow>
std::optional<Patch::Match> Patch::Walk(const cv::Mat& image, const Eigen::Vector2f& start,
                                        float reach) const {
  const Eigen::Matrix2f inverse = information_.inverse();
  Eigen::Vector2f p = start;
  std::array<float, kPixels> seen;
  for (int step = 0; step < kMostPatchSteps; ++step) {
    if (!IsInside(image, p, kRadius)) return std::nullopt;
    // The interpolation weights are the same for all pixels of the patch, since these are whole pixels apart.
    const float corner_u = p.x() - kRadius;
    const float corner_v = p.y() - kRadius;
    const int first_column = static_cast<int>(corner_u);
    const int first_row = static_cast<int>(corner_v);
    const float a = corner_u - static_cast<float>(first_column);
    const float b = corner_v - static_cast<float>(first_row);
    const float w00 = (1.0F - a) * (1.0F - b);
    const float w01 = a * (1.0F - b);
    const float w10 = (1.0F - a) * b;
    const float w11 = a * b;
    float sum = 0.0F;
    for (int row = 0; row < kSize; ++row) {
      const std::uint8_t* const top = image.ptr<std::uint8_t>(first_row + row) + first_column;
      const std::uint8_t* const bottom = top + image.step;
      for (int column = 0; column < kSize; ++column) {
        const float value =
            w00 * static_cast<float>(top[column]) + w01 * static_cast<float>(top[column + 1]) +
            w10 * static_cast<float>(bottom[column]) + w11 * static_cast<float>(bottom[column + 1]);
        seen[static_cast<std::size_t>(row * kSize + column)] = value;
        sum += value;
      }
    }
    const float mean = sum / static_cast<float>(kPixels);
    float product = 0.0F;
    float energy = 0.0F;
    for (std::size_t k = 0; k < kPixels; ++k) {
      seen[k] -= mean;
      product += seen[k] * value_[k];
      energy += seen[k] * seen[k];
    }
    if (energy <= 0.0F || product <= 0.0F) return std::nullopt;
    // Contrast relative to the patch: seen = value_ / gain apart from position
    const float gain = product / energy_;
    Eigen::Vector2f descent = Eigen::Vector2f::Zero();
    for (std::size_t k = 0; k < kPixels; ++k) {
      const float difference = seen[k] / gain - value_[k];
      descent.x() += gradient_u_[k] * difference;
      descent.y() += gradient_v_[k] * difference;
    }
    const Eigen::Vector2f move = kAlongRow ? Eigen::Vector2f(descent.x() / information_(0, 0), 0.0F)
                                           : Eigen::Vector2f(inverse * descent);
    if (!move.allFinite()) return std::nullopt;
    p -= move;
    if ((p - start).squaredNorm() > reach * reach) return std::nullopt;
    if (move.squaredNorm() < kSettledPatch * kSettledPatch) {
      if (!IsInside(image, p, kRadius)) return std::nullopt;
      return Match{p, product / std::sqrt(energy * energy_)};
    }
  }
  return std::nullopt;
}

std::optional<Patch::Match> Patch::Find(const cv::Mat& image, const Eigen::Vector2f& start,
                                        float reach) const {
  return Walk<false>(image, start, reach);
}

std::optional<Patch::Match> Patch::FindAlongRow(const cv::Mat& image, const Eigen::Vector2f& start,
                                                float reach) const {
  return Walk<true>(image, start, reach);
}

std::optional<SearchPatch> SearchPatch::Cut(const cv::Mat& image, const Eigen::Vector2f& center,
                                            const Eigen::Matrix2f& to_image) {
  if (!IsInside(image, center, Reach(to_image, kSize / 2))) return std::nullopt;
  SearchPatch patch;
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      const Eigen::Vector2f p = center + to_image * Eigen::Vector2f(static_cast<float>(column - kSize / 2),
                                                                    static_cast<float>(row - kSize / 2));
      patch.value_[static_cast<std::size_t>(row * kSize + column)] =
          static_cast<std::uint8_t>(Interpolate(image, p.x(), p.y()) + 0.5F);
    }
  }
  return patch;
}

std::optional<SearchPatch::Match> SearchPatch::Search(const cv::Mat& image, const cv::Rect& centers) const {
  const cv::Rect fits(kSize / 2, kSize / 2, image.cols - kSize + 1, image.rows - kSize + 1);
  const cv::Rect area = centers & fits;
  if (area.empty()) return std::nullopt;
  thread_local std::vector<int> sums;
  sums.resize(static_cast<std::size_t>(area.area()));
  const auto at = [&](int row, int column) -> int& {
    return sums[static_cast<std::size_t>(row * area.width + column)];
  };
  int best = std::numeric_limits<int>::max();
  cv::Point best_at;
  for (int row = 0; row < area.height; ++row) {
    for (int column = 0; column < area.width; ++column) {
      int sum = 0;
      for (int i = 0; i < kSize; ++i) {
        const std::uint8_t* const seen =
            image.ptr<std::uint8_t>(area.y + row - kSize / 2 + i) + area.x + column - kSize / 2;
        const std::uint8_t* const own = &value_[static_cast<std::size_t>(i * kSize)];
        for (int j = 0; j < kSize; ++j) sum += std::abs(static_cast<int>(seen[j]) - static_cast<int>(own[j]));
      }
      at(row, column) = sum;
      if (sum < best) {
        best = sum;
        best_at = {column, row};
      }
    }
  }
  int rival = std::numeric_limits<int>::max();
  for (int row = 0; row < area.height; ++row) {
    for (int column = 0; column < area.width; ++column) {
      if (std::abs(row - best_at.y) <= 2 && std::abs(column - best_at.x) <= 2) continue;
      rival = std::min(rival, at(row, column));
    }
  }
  const auto fraction = [](int before, int here, int after) {
    const int curvature = before - 2 * here + after;
    return curvature > 0 ? 0.5F * static_cast<float>(before - after) / static_cast<float>(curvature) : 0.0F;
  };
  Match match{{static_cast<float>(area.x + best_at.x), static_cast<float>(area.y + best_at.y)}, best, rival};
  if (best_at.x > 0 && best_at.x + 1 < area.width) {
    match.position.x() += fraction(at(best_at.y, best_at.x - 1), best, at(best_at.y, best_at.x + 1));
  }
  if (best_at.y > 0 && best_at.y + 1 < area.height) {
    match.position.y() += fraction(at(best_at.y - 1, best_at.x), best, at(best_at.y + 1, best_at.x));
  }
  return match;
}

}  // namespace thalweg::visual_odometry
