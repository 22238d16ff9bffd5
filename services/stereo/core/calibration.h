#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/camera/stereo_rectifier.h"
#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// As the rectifier does it, for our kind of image.
ByteImage Rectify(const StereoRectifier& rectifier, Side side, const ByteImage& raw);

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
