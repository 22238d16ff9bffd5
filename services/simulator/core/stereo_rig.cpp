#include "services/simulator/core/stereo_rig.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "common/base/parallel.h"

namespace thalweg::simulator {
namespace {

constexpr double kViewDistance = 1000.0;              // [m]
const Eigen::Vector3d kBackground(60.0, 70.0, 85.0);  // color of rays that hit nothing

/// What one ray sees.
struct Sample {
  Eigen::Vector3d color = kBackground;
  Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();
  double depth = std::numeric_limits<double>::quiet_NaN();
  bool textured = false;
};

/// Ambient light plus two broad lights from above, such as a window and a lamp.
double LightOn(const Eigen::Vector3d& normal_W) {
  static const Eigen::Vector3d window = Eigen::Vector3d(0.7, 0.4, 0.6).normalized();
  static const Eigen::Vector3d lamp = Eigen::Vector3d(-0.35, -0.6, 0.72).normalized();
  // Half-Lambert: surfaces facing away from a light still receive some of it, as in a room with bright walls.
  const auto wrapped = [&](const Eigen::Vector3d& light) { return 0.5 + 0.5 * normal_W.dot(light); };
  return 0.45 + 0.40 * wrapped(window) + 0.32 * wrapped(lamp);
}

/// Renders the view of one of the two cameras.
class Eye {
 public:
  Eye(const World& world, const PinholeCamera& camera, const RigidTransform& T_WC, std::size_t threads)
      : world_(world), camera_(camera), T_WC_(T_WC), threads_(threads) {}

  Sample Look(double u, double v) const {
    const Eigen::Vector3d ray_C = camera_.RayAtUnitDepth(u, v);
    const double length = ray_C.norm();
    const auto hit = world_.CastRay(T_WC_.translation(), T_WC_.linear() * (ray_C / length), kViewDistance);
    if (!hit) return {};
    Sample sample;
    sample.depth = hit->distance / length;
    sample.normal_W = hit->normal_W;
    const Rgb color = world_.ColorAt(*hit, sample.depth / camera_.fx);
    sample.color =
        LightOn(hit->normal_W) * Eigen::Vector3d(double(color.r), double(color.g), double(color.b));
    sample.textured = world_.HasTexture(*hit);
    return sample;
  }

  /// Averages n x n rays spread evenly over the pixel.
  Eigen::Vector3d LookFinely(int u, int v, int n) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) sum += Look(u - 0.5 + (i + 0.5) / n, v - 0.5 + (j + 0.5) / n).color;
    }
    return sum / (n * n);
  }

  std::vector<Sample> LookEverywhere() const {
    const auto width = static_cast<std::size_t>(camera_.width_px);
    std::vector<Sample> samples(width * static_cast<std::size_t>(camera_.height_px));
    ParallelFor(
        static_cast<std::size_t>(camera_.height_px), 8,
        [&](std::size_t row) {
          for (std::size_t column = 0; column < width; ++column) {
            samples[row * width + column] = Look(static_cast<double>(column), static_cast<double>(row));
          }
        },
        threads_);
    return samples;
  }

 private:
  const World& world_;
  PinholeCamera camera_;
  RigidTransform T_WC_;
  std::size_t threads_;
};

/// Whether two neighboring pixels see different surfaces.
bool IsEdge(const Sample& a, const Sample& b) {
  if (std::isnan(a.depth) || std::isnan(b.depth)) return std::isnan(a.depth) != std::isnan(b.depth);
  return a.normal_W.dot(b.normal_W) < 0.98 || std::abs(a.depth - b.depth) > 0.1 * std::min(a.depth, b.depth);
}

std::uint8_t ToByte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// Turns the samples of one camera into an image: supersampled where needed, in gray or color, with noise.
class Developer {
 public:
  Developer(const StereoRigModel& model, std::uint32_t seed, std::size_t threads)
      : model_(model), seed_(seed), threads_(threads) {}

  RenderedImage Develop(const Eye& eye, const std::vector<Sample>& samples) const {
    RenderedImage image{model_.camera.width_px, model_.camera.height_px, model_.color ? 3 : 1, {}};
    image.data.resize(samples.size() * static_cast<std::size_t>(image.channels));
    ParallelFor(
        static_cast<std::size_t>(image.height_px), 8,
        [&](std::size_t row) {
          std::mt19937 random(seed_ * 65537U + static_cast<std::uint32_t>(row));
          std::normal_distribution<double> noise(0.0, 1.0);
          const auto noisy = [&](double value) {
            return ToByte(model_.noise_sigma > 0.0 ? value + model_.noise_sigma * noise(random) : value);
          };
          for (int column = 0; column < image.width_px; ++column) {
            const std::size_t pixel = Pixel(column, static_cast<int>(row));
            const Eigen::Vector3d color =
                NeedsMore(samples, column, static_cast<int>(row))
                    ? eye.LookFinely(column, static_cast<int>(row), model_.edge_samples)
                    : samples[pixel].color;
            if (model_.color) {
              for (int k = 0; k < 3; ++k)
                image.data[3 * pixel + static_cast<std::size_t>(k)] = noisy(color[k]);
            } else {
              image.data[pixel] = noisy(color.dot(Eigen::Vector3d(0.299, 0.587, 0.114)));  // luma, BT.601
            }
          }
        },
        threads_);
    return image;
  }

 private:
  std::size_t Pixel(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(model_.camera.width_px) +
           static_cast<std::size_t>(column);
  }

  bool NeedsMore(const std::vector<Sample>& samples, int column, int row) const {
    if (model_.edge_samples < 2) return false;
    const Sample& own = samples[Pixel(column, row)];
    const auto differs = [&](int u, int v) {
      if (u < 0 || v < 0 || u >= model_.camera.width_px || v >= model_.camera.height_px) return false;
      return IsEdge(own, samples[Pixel(u, v)]);
    };
    return own.textured || differs(column - 1, row) || differs(column + 1, row) || differs(column, row - 1) ||
           differs(column, row + 1);
  }

  const StereoRigModel& model_;
  std::uint32_t seed_;
  std::size_t threads_;
};

}  // namespace

StereoRig::StereoRig(const StereoRigModel& model, std::uint32_t noise_seed, std::size_t threads)
    : model_(model), seed_(noise_seed), threads_(threads) {
  if (model.camera.width_px <= 0 || model.camera.height_px <= 0 || model.baseline <= 0.0) {
    throw std::invalid_argument("stereo camera: width, height and baseline must be > 0");
  }
}

StereoPair StereoRig::Capture(const World& world, const RigidTransform& T_WC) {
  RigidTransform T_WR = T_WC;
  T_WR.translation() += model_.baseline * T_WC.linear().col(0);
  const Eye left(world, model_.camera, T_WC, threads_);
  const Eye right(world, model_.camera, T_WR, threads_);
  const std::vector<Sample> left_samples = left.LookEverywhere();
  const std::uint32_t seed = seed_ + 2U * captures_++;
  StereoPair pair;
  pair.left = Developer(model_, seed, threads_).Develop(left, left_samples);
  pair.right = Developer(model_, seed + 1U, threads_).Develop(right, right.LookEverywhere());
  pair.depth.reserve(left_samples.size());
  for (const Sample& sample : left_samples) pair.depth.push_back(static_cast<float>(sample.depth));
  return pair;
}

}  // namespace thalweg::simulator
