#include "common/camera/stereo_bias.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/median.h"

namespace thalweg {
namespace {

/// What is believed about coefficients of which the last `n` are off and the others good, for an unknown n.
template <int kSize>
struct Judgment {
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  struct Prior {
    Vector good_sigma;
    Vector off_sigma;
    double off = 0.0;  ///< Probability of each n > 0.
  };

  /// @param lasting  What the measurement's covariance is larger by than L^-1: (lasting L^-1)^2.
  Judgment(const Matrix& evidence, const Vector& evidence_vector, double lasting, const Prior& prior) {
    // (L^-1 + (lasting L^-1)^2)^-1 = (L + lasting^2 I)^-1 L^2, which is defined for a singular L, too.
    const Matrix kept =
        (evidence + std::max(1e-12, lasting * lasting) * Matrix::Identity()).inverse() * evidence;
    const Matrix information = kept * evidence;
    const Vector information_vector = kept * evidence_vector;
    std::array<double, kSize + 1> log_weights{};
    std::array<Vector, kSize + 1> means{};
    std::array<Matrix, kSize + 1> covariances{};
    const auto is_off = [](std::size_t n, int i) { return i + static_cast<int>(n) >= kSize; };
    for (std::size_t n = 0; n <= kSize; ++n) {
      Matrix P = Matrix::Zero();
      for (int i = 0; i < kSize; ++i) {
        const double sigma = is_off(n, i) ? prior.off_sigma[i] : prior.good_sigma[i];
        P(i, i) = sigma * sigma;
      }
      // (L + P^-1)^-1 = P (I + L P)^-1
      const Matrix grown = Matrix::Identity() + information * P;
      covariances[n] = P * grown.inverse();
      means[n] = covariances[n] * information_vector;
      log_weights[n] = std::log(n == 0 ? 1.0 - kSize * prior.off : prior.off) +
                       0.5 * (information_vector.dot(means[n]) - std::log(grown.determinant()));
    }
    const double largest = *std::max_element(log_weights.begin(), log_weights.end());
    double sum = 0.0;
    for (const double log_weight : log_weights) sum += std::exp(log_weight - largest);
    for (std::size_t n = 0; n <= kSize; ++n) {
      const double probability = std::exp(log_weights[n] - largest) / sum;
      mean += probability * means[n];
      second_moment += probability * (covariances[n] + means[n] * means[n].transpose());
      for (int i = 0; i < kSize; ++i) {
        if (is_off(n, i)) correction[i] += probability * means[n][i];
      }
      if (n > 0) off_probability += probability;
    }
  }

  Vector mean = Vector::Zero();
  Matrix second_moment = Matrix::Zero();
  Vector correction = Vector::Zero();
  double off_probability = 0.0;
};

}  // namespace

double OffsetInImage(const PinholeCamera& camera, const Eigen::Matrix2d& moment) {
  constexpr int kColumns = 32;
  double mean_square = 0.0;
  for (int k = 0; k < kColumns; ++k) {
    const Eigen::Vector2d basis = BiasBasis(camera, (k + 0.5) / kColumns * camera.width_px - 0.5);
    mean_square += basis.dot(moment * basis) / kColumns;
  }
  return std::sqrt(std::max(0.0, mean_square));
}

StereoBiasMonitor::StereoBiasMonitor(const Options& options) : options_(options) {
  const auto require = [](bool holds, const char* text) {
    if (!holds) throw std::invalid_argument(std::string("stereo bias: ") + text);
  };
  require(options.good_sigma_px.minCoeff() > 0.0, "good_sigma_px must be > 0");
  require((options.off_sigma_px - options.good_sigma_px).minCoeff() > 0.0,
          "off_sigma_px must be > good_sigma_px");
  require(options.off_prior > 0.0 && options.off_prior < 0.5, "off_prior must be between 0 and 0.5");
  require(options.lasting_sigma_px >= 0.0, "lasting_sigma_px must be >= 0");
  require(options.good_row_sigma_px > 0.0, "good_row_sigma_px must be > 0");
  require(options.off_row_sigma_px > options.good_row_sigma_px,
          "off_row_sigma_px must be > good_row_sigma_px");
  require(options.row_sigma_px > 0.0, "row_sigma_px must be > 0");
  require(options.lasting_row_sigma_px >= 0.0, "lasting_row_sigma_px must be >= 0");
  require(options.memory >= 1.0, "memory must be >= 1");
  JudgeDisparities();
  JudgeRows();
}

void StereoBiasMonitor::AddDisparities(const DisparityBias& measured, const Eigen::Matrix2d& information,
                                       double with_known_motion) {
  const double kept = std::exp(-1.0 / options_.memory);
  information_ = kept * information_ + information;
  information_vector_ = kept * information_vector_ + information * measured;
  with_known_motion_ = kept * with_known_motion_ + with_known_motion;
  JudgeDisparities();
}

void StereoBiasMonitor::AddRows(std::vector<double> offsets) {
  if (static_cast<int>(offsets.size()) < options_.least_rows) return;
  const double kept = std::exp(-1.0 / options_.memory);
  const double information = 1.0 / (options_.row_sigma_px * options_.row_sigma_px);
  row_information_ = kept * row_information_ + information;
  row_information_vector_ = kept * row_information_vector_ + information * Median(std::move(offsets));
  JudgeRows();
}

Eigen::Matrix2d StereoBiasMonitor::ErrorMoment() const {
  return second_moment_ - mean_ * correction_.transpose() - correction_ * mean_.transpose() +
         correction_ * correction_.transpose();
}

CalibrationFinding StereoBiasMonitor::Finding(const PinholeCamera& camera) const {
  CalibrationFinding finding;
  finding.disparity_px = mean_;
  finding.disparity_sigma_px = (second_moment_.diagonal() - mean_.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  finding.row_px = row_;
  finding.row_sigma_px = row_sigma_;
  finding.off_probability = std::max(off_probability_, row_off_probability_);
  finding.offset_px = std::hypot(OffsetInImage(camera, mean_ * mean_.transpose()), row_);
  finding.left_px = OffsetInImage(camera, ErrorMoment());
  return finding;
}

void StereoBiasMonitor::JudgeDisparities() {
  const Judgment<2> judgment(information_, information_vector_,
                             options_.lasting_sigma_px * with_known_motion_,
                             {options_.good_sigma_px, options_.off_sigma_px, options_.off_prior});
  mean_ = judgment.mean;
  second_moment_ = judgment.second_moment;
  correction_ = judgment.correction;
  off_probability_ = judgment.off_probability;
}

void StereoBiasMonitor::JudgeRows() {
  using Scalar = Eigen::Matrix<double, 1, 1>;
  const Judgment<1> judgment(
      Scalar(row_information_), Scalar(row_information_vector_),
      options_.lasting_row_sigma_px * row_information_,
      {Scalar(options_.good_row_sigma_px), Scalar(options_.off_row_sigma_px), options_.off_prior});
  row_ = judgment.mean[0];
  row_sigma_ = std::sqrt(std::max(0.0, judgment.second_moment(0, 0) - row_ * row_));
  row_correction_ = judgment.correction[0];
  row_off_probability_ = judgment.off_probability;
}

}  // namespace thalweg
