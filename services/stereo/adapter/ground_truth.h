#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/stereo/core/evaluation.h"

namespace thalweg::stereo {

// Reads image pairs with known disparity from disk. All functions throw std::runtime_error naming the file,
// the line if there is one, and what is wrong.

/// A line of pairs.csv.
struct ListedPair {
  std::string where;  ///< FILE:LINE
  std::string name;   ///< Name of its folder.
  double scale = 1.0;
  int max_disparity = 0;
};
struct PairList {
  std::vector<ListedPair> pairs;
  std::vector<std::string> mistakes;  ///< Errors in lines that could not be parsed, with their places.
};
/// Reads columns name, scale and max_disparity, in the order given by a header line, which may name others;
/// without a header, in this order. Throws if there is no such file or no line in it.
PairList ReadPairs(const std::filesystem::path& file);

/// Finds the image with this name whatever its extension, preferring .png; empty if there is none.
std::filesystem::path FindPicture(const std::filesystem::path& folder, const std::string& stem);
/// As FindPicture, but throws if there is none.
std::filesystem::path RequirePicture(const std::filesystem::path& folder, const std::string& stem);

struct GroundTruth {
  DisparityMap disparity;
  EvaluationMasks masks;
  std::string non_occluded_from;  ///< How the pixels seen by both cameras were determined, for people.
};
/// @param right   Ground truth of the right image; may be empty.
/// @param scale   Gray values per pixel of disparity.
/// @param masks   Folder with mask_nonocc, mask_disc and mask_all, which are white where a pixel counts; may
///   be empty. Missing masks are derived from the ground truth by MasksFrom.
/// @param images  The left image, for its size.
GroundTruth ReadGroundTruth(const std::filesystem::path& file, const std::filesystem::path& right,
                            double scale, const std::filesystem::path& masks, const ByteImage& images);

}  // namespace thalweg::stereo
