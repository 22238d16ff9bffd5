#include "services/stereo/core/row_alignment.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/base/median.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr int kMostCorners = 400;
constexpr int kHalfPatch = 8;     // [px]
constexpr int kSearchedRows = 7;  // above and below; one at each end is only for the peak's shape
constexpr double kLeastCorrelation = 0.9;
constexpr std::size_t kFewestCorners = 30;
constexpr double kSigmaOfMedian = 1.4826;  // of the median of absolute deviations, for normal ones
constexpr double kLeastSigma = 0.02;       // [px] no corner is placed better
constexpr double kOutlier = 3.0;           // sigma

struct Difference {
  double x, y;     // from -0.5 to 0.5 across the image
  double rows_px;  // row in the right image minus that in the left one
};

/// The peak of the quadratic function through 3 x 3 correlations: its row relative to the middle one. Nothing
/// if there is no peak near the middle.
std::optional<double> RowOfPeak(const cv::Mat_<float>& score, const cv::Point& at) {
  const auto c = [&](int x, int y) { return static_cast<double>(score(at.y + y, at.x + x)); };
  const Eigen::Vector2d gradient(0.5 * (c(1, 0) - c(-1, 0)), 0.5 * (c(0, 1) - c(0, -1)));
  const double xy = 0.25 * (c(1, 1) - c(1, -1) - c(-1, 1) + c(-1, -1));
  Eigen::Matrix2d hessian;
  hessian << c(1, 0) - 2.0 * c(0, 0) + c(-1, 0), xy, xy, c(0, 1) - 2.0 * c(0, 0) + c(0, -1);
  if (!(hessian(0, 0) < 0.0 && hessian.determinant() > 0.0)) return std::nullopt;
  const Eigen::Vector2d peak = -hessian.inverse() * gradient;
  return peak.cwiseAbs().maxCoeff() <= 1.0 ? std::optional(peak.y()) : std::nullopt;
}

/// Finds the corner's patch in the right image.
std::optional<double> RowsDown(const cv::Mat& left, const cv::Mat& right, const cv::Point& corner,
                               int max_disparity) {
  const cv::Rect patch(corner.x - kHalfPatch, corner.y - kHalfPatch, 2 * kHalfPatch + 1, 2 * kHalfPatch + 1);
  const int first = std::max(0, patch.x - max_disparity);
  const int last = std::min(left.cols, patch.x + patch.width + 1);
  const cv::Rect strip(first, patch.y - kSearchedRows, last - first, patch.height + 2 * kSearchedRows);
  const cv::Rect image(0, 0, left.cols, left.rows);
  if ((patch & image) != patch || (strip & image) != strip || strip.width < patch.width + 2)
    return std::nullopt;
  cv::Mat_<float> score;
  cv::matchTemplate(right(strip), left(patch), score, cv::TM_CCOEFF_NORMED);
  double best = 0.0;
  cv::Point at;
  cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
  const bool inside = at.x > 0 && at.y > 0 && at.x + 1 < score.cols && at.y + 1 < score.rows;
  if (best < kLeastCorrelation || !inside) return std::nullopt;
  const auto beyond = RowOfPeak(score, at);
  return beyond ? std::optional(at.y - kSearchedRows + *beyond) : std::nullopt;
}

/// Fits the model by least squares, without what does not agree with it.
std::optional<RowAlignment> Fit(const std::vector<Difference>& differences) {
  std::vector<double> rows;
  for (const Difference& difference : differences) rows.push_back(difference.rows_px);
  Eigen::Vector3d model(Median(rows), 0.0, 0.0);
  RowAlignment fitted;
  for (int iteration = 0; iteration < 10; ++iteration) {
    const auto residual = [&](const Difference& d) {
      return d.rows_px - model.dot(Eigen::Vector3d(1.0, d.x, d.y));
    };
    std::vector<double> deviations;
    for (const Difference& difference : differences) deviations.push_back(std::abs(residual(difference)));
    const double sigma = std::max(kSigmaOfMedian * Median(deviations), kLeastSigma);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::size_t used = 0;
    for (const Difference& difference : differences) {
      if (std::abs(residual(difference)) > kOutlier * sigma) continue;
      const Eigen::Vector3d row(1.0, difference.x, difference.y);
      normal += row * row.transpose();
      right += row * difference.rows_px;
      ++used;
    }
    if (used < kFewestCorners) return std::nullopt;
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (!solver.isPositive() || solver.rcond() < 1e-6) return std::nullopt;  // all in one place
    model = solver.solve(right);
    fitted.corners = used;
    fitted.covariance_px2 = sigma * sigma * normal.inverse();
  }
  fitted.offset_px = model[0];
  fitted.tilt_px = model[1];
  fitted.slant_px = model[2];
  return fitted;
}

}  // namespace

double RowAlignment::CertainPx() const {
  double certain = 0.0;
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {-0.5, -0.5}, {-0.5, 0.5}, {0.5, -0.5}, {0.5, 0.5}}) {
    const Eigen::Vector3d row(1.0, x, y);
    const double sigma = std::sqrt(row.dot(covariance_px2 * row));
    certain = std::max(certain, std::abs(AtPx(x, y)) - 3.0 * sigma);
  }
  return certain;
}

std::optional<RowAlignment> MeasureRowAlignment(const ByteImage& left, const ByteImage& right,
                                                int max_disparity) {
  constexpr double kQuality = 0.01;
  const cv::Mat left_view = ViewOf(left);
  const cv::Mat right_view = ViewOf(right);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(left_view, corners, kMostCorners, kQuality, left.width() / 50.0);
  std::vector<Difference> differences;
  for (const cv::Point2f& corner : corners) {
    const cv::Point pixel(static_cast<int>(corner.x), static_cast<int>(corner.y));
    const auto rows = RowsDown(left_view, right_view, pixel, max_disparity);
    if (!rows) continue;
    differences.push_back({.x = (pixel.x + 0.5) / left.width() - 0.5,
                           .y = (pixel.y + 0.5) / left.height() - 0.5,
                           .rows_px = *rows});
  }
  return differences.size() < kFewestCorners ? std::nullopt : Fit(differences);
}

std::string Describe(const RowAlignment& rows) {
  double worst = 0.0;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) worst = std::max(worst, std::abs(rows.AtPx(x, y)));
  }
  if (rows.CertainPx() <= kMostRowDifference)
    return fmt::format("rows agree within {:.2f} px ({} corners)", worst, rows.corners);
  return fmt::format(
      "the rows of the two images differ by up to {:.1f} px: {:+.2f} in the middle, {:+.2f} more from left "
      "to right, {:+.2f} from top to bottom ({} corners); the calibration is no longer right",
      worst, rows.offset_px, rows.tilt_px, rows.slant_px, rows.corners);
}

std::optional<std::string> RowMonitor::Add(const RowAlignment& rows) {
  const bool differs = rows.CertainPx() > kMostRowDifference;
  against_ = differs == warned_ ? 0 : against_ + 1;
  if (against_ < kPairs) return std::nullopt;
  warned_ = differs;
  against_ = 0;
  return Describe(rows);
}

}  // namespace thalweg::stereo
