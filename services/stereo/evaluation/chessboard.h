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
/// The same backwards, 3x3 to 100x100. @param square  [m] Finite, > 0.
/// Throws std::runtime_error naming the option of `thalweg calibrate` and what it may be.
Board BoardFrom(const std::string& text, double square);

struct PicturePair {
  std::filesystem::path left, right;
};
/// left*.* and right*.* of the same endings, in order. Throws std::runtime_error naming the folder when it is
/// none or has no such pairs.
std::vector<PicturePair> PicturePairsIn(const std::filesystem::path& folder);

/// A calibration from pictures of a board.
struct PictureCalibration {
  CalibrationResult result;
  std::size_t pairs = 0;
  std::size_t views = 0;  ///< Pairs that show the whole board in both pictures; the others are left out.
  StereoGeometry rectified;
  ByteImage first_pair;  ///< The first view rectified, left beside right, with scan lines: RGB.
};

/// @param left_out  Called for each pair that does not show the whole board.
/// Throws std::runtime_error naming the file that is no picture or of another size than the first, and
/// std::invalid_argument as Calibrate does.
PictureCalibration CalibrateFromPictures(const std::vector<PicturePair>& pairs, const Board& board,
                                         const std::function<void(const PicturePair&)>& left_out);

/// One line for people: how many pairs, how large the errors are, the baseline.
std::string Describe(const PictureCalibration& calibration);

}  // namespace thalweg::stereo
