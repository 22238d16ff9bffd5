#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/camera/stereo_rectifier.h"
#include "services/stereo/core/calibration.h"
#include "services/stereo/core/row_alignment.h"

namespace thalweg::stereo {

/// "9x6": inner corners along a row and along a column.
std::string ToText(const Board& board);
/// Parses such a text, 3x3 to 100x100. Throws std::runtime_error naming the option of `thalweg calibrate` and
/// what it accepts.
/// @param square  [m] Finite, > 0.
Board BoardFrom(const std::string& text, double square);

struct PicturePair {
  std::filesystem::path left, right;
};
/// Pairs left*.* with right*.* of equal endings, in order. Throws std::runtime_error naming the folder if it
/// does not exist or has no such pairs.
std::vector<PicturePair> PicturePairsIn(const std::filesystem::path& folder);

/// A calibration from images of a board.
struct PictureCalibration {
  CalibrationResult result;
  std::size_t pairs = 0;
  std::size_t views = 0;  ///< Pairs that show the whole board in both images; the others are left out.
  StereoGeometry rectified;
  ByteImage first_pair;  ///< The first pair used, rectified, side by side, with scan lines: RGB.
};

/// Calibrates from images. Throws std::runtime_error naming a file that is not an image or differs in size
/// from the first, and std::invalid_argument as Calibrate does.
/// @param left_out  Called for each pair that does not show the whole board.
PictureCalibration CalibrateFromPictures(const std::vector<PicturePair>& pairs, const Board& board,
                                         const std::function<void(const PicturePair&)>& left_out);

/// How well a calibration fits images that it was not made from.
struct CalibrationCheck {
  std::size_t pairs = 0;
  std::optional<RowAlignment> rows = std::nullopt;  ///< Median over the pairs that show enough.
  std::size_t views = 0;                            ///< Pairs that show the whole board in both images.
  /// Sides of the board's squares, as triangulated, over their true length: median over the views. 1 without
  /// views.
  double scale = 1.0;
  /// [px] What would have to be added to all disparities for the median view's squares to have their length.
  double disparity_off_px = 0.0;

  /// Whether rows agree within kMostRowDifference and lengths within a hundredth.
  bool good() const;
};

/// @param board  Nothing: only rows are compared, and the images may show anything.
/// @param max_disparity  [px] Disparities below it are searched for rows.
/// Throws std::runtime_error naming a file that is not an image or not of the calibration's size.
CalibrationCheck CheckCalibration(const StereoCalibration& calibration, const std::vector<PicturePair>& pairs,
                                  const std::optional<Board>& board, int max_disparity);

/// For people: what was measured, and the verdict.
std::string Describe(const CalibrationCheck& check);

/// One line for people: number of pairs, errors and baseline.
std::string Describe(const PictureCalibration& calibration);

}  // namespace thalweg::stereo
