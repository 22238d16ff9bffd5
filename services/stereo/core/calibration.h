#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/camera/stereo_rectifier.h"
#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// Rectifies an image of our own type.
ByteImage Rectify(const StereoRectifier& rectifier, Side side, const ByteImage& raw);

/// The inner corners of a chessboard, row by row, as seen by both cameras.
struct BoardView {
  std::vector<Eigen::Vector2f> left, right;
};
struct Board {
  int columns = 9;      ///< Inner corners along a row.
  int rows = 6;         ///< Inner corners along a column.
  double square = 0.0;  ///< [m]
};
/// Finds the board's corners with subpixel accuracy; nothing unless the whole board is visible.
/// @param image  Grayscale.
std::optional<std::vector<Eigen::Vector2f>> FindBoard(const ByteImage& image, const Board& board);

struct CalibrationResult {
  StereoCalibration calibration;
  double reprojection_px = 0.0;  ///< Root mean square over all corners in both cameras.
  double epipolar_px = 0.0;      ///< Median row difference of a corner between the rectified images.
  double epipolar_worst_px = 0.0;
};
/// Calibrates each camera by Zhang's method, then both together, using OpenCV. Throws std::invalid_argument
/// if there are fewer than 3 views.
CalibrationResult Calibrate(const std::vector<BoardView>& views, const Board& board, int width_px,
                            int height_px);

}  // namespace thalweg::stereo
