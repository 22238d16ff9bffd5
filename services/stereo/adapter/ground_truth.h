#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/stereo/core/evaluation.h"

namespace thalweg::stereo {

// Pairs with known disparity on disk. All throw std::runtime_error naming the file, the line where there is
// one, and what is wrong.

/// A line of pairs.csv.
struct ListedPair {
  std::string where;  ///< FILE:LINE
  std::string name;   ///< Of its folder.
  double scale = 1.0;
  int max_disparity = 0;
};
struct PairList {
  std::vector<ListedPair> pairs;
  std::vector<std::string> mistakes;  ///< Of the lines that are none, with their places.
};
/// Columns name, scale and max_disparity, in the order that the first line tells, among others or not;
/// without such a line in this order. Throws when there is no such file, or no line in it.
PairList ReadPairs(const std::filesystem::path& file);

/// The picture of that name, whatever its ending, .png before all others; empty when there is none.
std::filesystem::path FindPicture(const std::filesystem::path& folder, const std::string& stem);
/// As above; throws when there is none.
std::filesystem::path RequirePicture(const std::filesystem::path& folder, const std::string& stem);

struct GroundTruth {
  DisparityMap disparity;
  EvaluationMasks masks;
  std::string non_occluded_from;  ///< Where it is known from which pixels both cameras see, for people.
};
/// @param right   Truth of the right image; empty: none. @param scale  Grey values a pixel of disparity.
/// @param masks   Folder of mask_nonocc, mask_disc, mask_all, white where a pixel counts; empty: none.
///                Those that are not there are made from the truth, as MasksFrom does.
/// @param images  The left image, for its size.
GroundTruth ReadGroundTruth(const std::filesystem::path& file, const std::filesystem::path& right,
                            double scale, const std::filesystem::path& masks, const ByteImage& images);

}  // namespace thalweg::stereo
