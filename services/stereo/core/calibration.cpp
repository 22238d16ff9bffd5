#include "services/stereo/core/calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr int kWidest = 65536;
constexpr double kRotationTolerance = 1e-3;
constexpr std::size_t kLeastViews = 3;
constexpr std::array<std::size_t, 6> kDistortionCounts = {0, 4, 5, 8, 12, 14};
const cv::Size kSubpixelWindow(5, 5);

std::optional<std::string> MistakeIn(const RawCamera& camera, const std::string& number) {
  const std::string k = "K" + number;
  if (!camera.K.allFinite()) return k + " holds a value that is not finite";
  if (camera.K(0, 0) <= 0.0 || camera.K(1, 1) <= 0.0) return k + " has focal lengths that are not > 0";
  if (camera.K(1, 0) != 0.0 || camera.K.row(2) != Eigen::RowVector3d(0.0, 0.0, 1.0)) {
    return k + " is no camera matrix: its lower part must be 0 and its last row 0, 0, 1";
  }
  const std::string d = "D" + number;
  const std::size_t count = camera.distortion.size();
  if (std::find(kDistortionCounts.begin(), kDistortionCounts.end(), count) == kDistortionCounts.end()) {
    return d + " has " + std::to_string(count) + " numbers, must be 0, 4, 5, 8, 12 or 14";
  }
  for (const double value : camera.distortion) {
    if (!std::isfinite(value)) return d + " holds a value that is not finite";
  }
  return std::nullopt;
}

cv::Matx33d ToCv(const Eigen::Matrix3d& m) {
  cv::Matx33d out;
  cv::eigen2cv(m, out);
  return out;
}

std::vector<cv::Point2f> ToCv(const std::vector<Eigen::Vector2f>& points) {
  std::vector<cv::Point2f> out;
  out.reserve(points.size());
  for (const Eigen::Vector2f& p : points) out.emplace_back(p.x(), p.y());
  return out;
}

}  // namespace

std::optional<std::string> MistakeIn(const StereoCalibration& calibration) {
  const StereoCalibration& c = calibration;
  if (c.width_px < 2 || c.height_px < 2 || c.width_px > kWidest || c.height_px > kWidest) {
    return "image size is " + std::to_string(c.width_px) + " x " + std::to_string(c.height_px) +
           ", must be 2 to 65536";
  }
  if (const auto mistake = MistakeIn(c.left, "1")) return mistake;
  if (const auto mistake = MistakeIn(c.right, "2")) return mistake;
  if (!c.R.allFinite()) return "R holds a value that is not finite";
  if (!(c.R * c.R.transpose()).isIdentity(kRotationTolerance) || c.R.determinant() < 0.0) {
    return "R is no rotation";
  }
  if (!c.T.allFinite()) return "T holds a value that is not finite";
  const Eigen::Vector3d right_in_left = -c.R.transpose() * c.T;
  if (right_in_left.x() <= 0.0 || std::abs(right_in_left.x()) < std::abs(right_in_left.y())) {
    return "T does not put the right camera to the right of the left one";
  }
  return std::nullopt;
}

struct Rectifier::Tables {
  struct Camera {
    cv::Matx33d K, R;
    std::vector<double> distortion;
    cv::Matx34d P;
    cv::Mat where;     // fixed-point coordinates
    cv::Mat fraction;  // and their fractions, as cv::remap likes them best
  };
  cv::Size size;
  std::array<Camera, 2> cameras;
};

Rectifier::Rectifier(const StereoCalibration& calibration) : tables_(std::make_unique<Tables>()) {
  if (const auto mistake = MistakeIn(calibration)) throw std::invalid_argument(*mistake);
  const cv::Size size(calibration.width_px, calibration.height_px);
  auto& [left, right] = tables_->cameras;
  tables_->size = size;
  left.K = ToCv(calibration.left.K);
  right.K = ToCv(calibration.right.K);
  left.distortion = calibration.left.distortion;
  right.distortion = calibration.right.distortion;
  const cv::Vec3d t(calibration.T.x(), calibration.T.y(), calibration.T.z());
  cv::Matx44d q;
  cv::stereoRectify(left.K, left.distortion, right.K, right.distortion, size, ToCv(calibration.R), t, left.R,
                    right.R, left.P, right.P, q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
  for (Tables::Camera& camera : tables_->cameras) {
    cv::initUndistortRectifyMap(camera.K, camera.distortion, camera.R, camera.P, size, CV_16SC2, camera.where,
                                camera.fraction);
  }
  camera_.camera = {calibration.width_px, calibration.height_px, left.P(0, 0),
                    left.P(1, 1),         left.P(0, 2),          left.P(1, 2)};
  camera_.baseline = -right.P(0, 3) / right.P(0, 0);
}

Rectifier::~Rectifier() = default;
Rectifier::Rectifier(Rectifier&&) noexcept = default;
Rectifier& Rectifier::operator=(Rectifier&&) noexcept = default;

ByteImage Rectifier::Rectify(Side side, const ByteImage& raw) const {
  if (raw.width() != tables_->size.width || raw.height() != tables_->size.height) {
    throw std::invalid_argument("image is " + std::to_string(raw.width()) + " x " +
                                std::to_string(raw.height()) + ", the calibration is for " +
                                std::to_string(tables_->size.width) + " x " +
                                std::to_string(tables_->size.height));
  }
  const Tables::Camera& camera = tables_->cameras[side == Side::kLeft ? 0 : 1];
  ByteImage out(raw.width(), raw.height(), raw.channels());
  cv::Mat to(raw.height(), raw.width(), CV_MAKETYPE(CV_8U, raw.channels()), out.data().data());
  cv::remap(ViewOf(raw), to, camera.where, camera.fraction, cv::INTER_LINEAR);
  return out;
}

Eigen::Vector2d Rectifier::RectifyPoint(Side side, const Eigen::Vector2d& raw) const {
  const Tables::Camera& camera = tables_->cameras[side == Side::kLeft ? 0 : 1];
  const std::vector<cv::Point2d> in = {{raw.x(), raw.y()}};
  std::vector<cv::Point2d> out;
  cv::undistortPoints(in, out, camera.K, camera.distortion, camera.R, camera.P);
  return {out[0].x, out[0].y};
}

std::optional<std::vector<Eigen::Vector2f>> FindBoard(const ByteImage& image, const Board& board) {
  std::vector<cv::Point2f> corners;
  const cv::Mat view = ViewOf(image);
  if (!cv::findChessboardCorners(view, {board.columns, board.rows}, corners)) return std::nullopt;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 0.01);
  cv::cornerSubPix(view, corners, kSubpixelWindow, {-1, -1}, until);
  std::vector<Eigen::Vector2f> out;
  out.reserve(corners.size());
  for (const cv::Point2f& corner : corners) out.emplace_back(corner.x, corner.y);
  return out;
}

CalibrationResult Calibrate(const std::vector<BoardView>& views, const Board& board, int width_px,
                            int height_px) {
  if (views.size() < kLeastViews) {
    throw std::invalid_argument("the board was found in " + std::to_string(views.size()) +
                                " pairs, at least 3 are needed");
  }
  std::vector<cv::Point3f> on_board;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      on_board.emplace_back(static_cast<float>(column * board.square), static_cast<float>(row * board.square),
                            0.0F);
    }
  }
  const std::vector<std::vector<cv::Point3f>> boards(views.size(), on_board);
  std::vector<std::vector<cv::Point2f>> left;
  std::vector<std::vector<cv::Point2f>> right;
  for (const BoardView& view : views) {
    left.push_back(ToCv(view.left));
    right.push_back(ToCv(view.right));
  }
  const cv::Size size(width_px, height_px);
  cv::Mat k_left, k_right, d_left, d_right, r, t, e, f;
  cv::calibrateCamera(boards, left, size, k_left, d_left, cv::noArray(), cv::noArray());
  cv::calibrateCamera(boards, right, size, k_right, d_right, cv::noArray(), cv::noArray());
  CalibrationResult result;
  result.reprojection_px = cv::stereoCalibrate(boards, left, right, k_left, d_left, k_right, d_right, size, r,
                                               t, e, f, cv::CALIB_USE_INTRINSIC_GUESS,
                                               {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-6});
  StereoCalibration& calibration = result.calibration;
  calibration.width_px = width_px;
  calibration.height_px = height_px;
  cv::cv2eigen(k_left, calibration.left.K);
  cv::cv2eigen(k_right, calibration.right.K);
  cv::cv2eigen(r, calibration.R);
  cv::cv2eigen(t, calibration.T);
  calibration.left.distortion.assign(d_left.begin<double>(), d_left.end<double>());
  calibration.right.distortion.assign(d_right.begin<double>(), d_right.end<double>());

  const Rectifier rectifier(calibration);
  std::vector<double> errors;
  for (const BoardView& view : views) {
    for (std::size_t i = 0; i < view.left.size(); ++i) {
      const Eigen::Vector2d p = rectifier.RectifyPoint(Side::kLeft, view.left[i].cast<double>());
      const Eigen::Vector2d q = rectifier.RectifyPoint(Side::kRight, view.right[i].cast<double>());
      errors.push_back(std::abs(p.y() - q.y()));
    }
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  result.epipolar_px = *middle;
  result.epipolar_worst_px = *std::max_element(middle, errors.end());
  return result;
}

}  // namespace thalweg::stereo
