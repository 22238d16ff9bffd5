#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/stereo/core/image.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// A raw camera: pinhole K and lens distortion as OpenCV has it (k1, k2, p1, p2, k3, ...).
struct RawCamera {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  std::vector<double> distortion;  ///< 0, 4, 5, 8, 12 or 14 numbers.
};

/// Two raw cameras. A point p_L of the left camera's frame is R p_L + T in the right one's.
struct StereoCalibration {
  int width_px = 0;
  int height_px = 0;
  RawCamera left, right;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d T = Eigen::Vector3d::Zero();  ///< [m]
};

/// What is wrong with it, naming the field; none when nothing is.
std::optional<std::string> MistakeIn(const StereoCalibration& calibration);

enum class Side { kLeft, kRight };

/// Turns raw images into those of two equal cameras side by side, through a table that is made once.
class Rectifier {
 public:
  /// Throws std::invalid_argument with MistakeIn's text.
  explicit Rectifier(const StereoCalibration& calibration);
  ~Rectifier();
  Rectifier(Rectifier&&) noexcept;
  Rectifier& operator=(Rectifier&&) noexcept;

  /// Bilinear; black where the raw image does not reach. Throws std::invalid_argument naming both sizes when
  /// the image is not of the calibration's.
  ByteImage Rectify(Side side, const ByteImage& raw) const;
  /// Where a pixel of the raw image comes to lie.
  Eigen::Vector2d RectifyPoint(Side side, const Eigen::Vector2d& raw) const;

  const StereoGeometry& camera() const { return camera_; }

 private:
  struct Tables;
  StereoGeometry camera_;
  std::unique_ptr<Tables> tables_;
};

/// Inner corners of a chessboard, row by row, as both cameras see them.
struct BoardView {
  std::vector<Eigen::Vector2f> left, right;
};
struct Board {
  int columns = 9;      ///< Inner corners along a row.
  int rows = 6;         ///< Inner corners along a column.
  double square = 0.0;  ///< [m]
};
/// To a fraction of a pixel; none when the board is not seen whole. @param image  Grey.
std::optional<std::vector<Eigen::Vector2f>> FindBoard(const ByteImage& image, const Board& board);

struct CalibrationResult {
  StereoCalibration calibration;
  double reprojection_px = 0.0;  ///< Root mean square over all corners of both cameras.
  double epipolar_px = 0.0;      ///< Median distance of the rows of a corner in both rectified images.
  double epipolar_worst_px = 0.0;
};
/// Zhang's method, then both cameras together, by OpenCV. Throws std::invalid_argument when there are fewer
/// than 3 views.
CalibrationResult Calibrate(const std::vector<BoardView>& views, const Board& board, int width_px,
                            int height_px);

}  // namespace thalweg::stereo
