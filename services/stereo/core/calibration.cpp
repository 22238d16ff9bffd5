#include "services/stereo/core/calibration.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "common/base/median.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr std::size_t kLeastViews = 3;
const cv::Size kSubpixelWindow(5, 5);

RawCamera CameraFrom(const cv::Mat& k, const cv::Mat& d, const cv::Size& size) {
  RawCamera camera{size.width, size.height, {}, {d.begin<double>(), d.end<double>()}};
  cv::cv2eigen(k, camera.K);
  return camera;
}

std::vector<cv::Point2f> ToCv(const std::vector<Eigen::Vector2f>& points) {
  std::vector<cv::Point2f> out;
  out.reserve(points.size());
  for (const Eigen::Vector2f& p : points) out.emplace_back(p.x(), p.y());
  return out;
}

}  // namespace

ByteImage Rectify(const StereoRectifier& rectifier, Side side, const ByteImage& raw) {
  const StereoGeometry& geometry = rectifier.geometry();
  ByteImage out(geometry.camera.width_px, geometry.camera.height_px, raw.channels());
  const cv::Mat rectified = rectifier.Rectify(side, ViewOf(raw));
  std::copy(rectified.datastart, rectified.dataend, out.data().begin());
  return out;
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
  calibration.left = CameraFrom(k_left, d_left, size);
  calibration.right = CameraFrom(k_right, d_right, size);
  Eigen::Matrix3d R_RL;
  Eigen::Vector3d t_RL;
  cv::cv2eigen(r, R_RL);
  cv::cv2eigen(t, t_RL);
  calibration.T_RL = MakeTransform(R_RL, t_RL);

  const StereoRectifier rectifier(calibration);
  std::vector<double> errors;
  for (const BoardView& view : views) {
    for (std::size_t i = 0; i < view.left.size(); ++i) {
      const Eigen::Vector2d p = rectifier.RectifyPoint(Side::kLeft, view.left[i].cast<double>());
      const Eigen::Vector2d q = rectifier.RectifyPoint(Side::kRight, view.right[i].cast<double>());
      errors.push_back(std::abs(p.y() - q.y()));
    }
  }
  result.epipolar_px = Median(errors);
  result.epipolar_worst_px = *std::max_element(errors.begin(), errors.end());
  return result;
}

}  // namespace thalweg::stereo
