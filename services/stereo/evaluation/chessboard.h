#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/camera/stereo_rectifier.h"
#include "services/stereo/core/calibration.h"

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

/// One line for people: number of pairs, errors and baseline.
std::string Describe(const PictureCalibration& calibration);

}  // namespace thalweg::stereo
