#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/point_cloud.h"
#include "common/geometry/stereo_geometry.h"
#include "services/stereo/adapter/ground_truth.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/row_alignment.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// A percentage with two decimals; "-" where there was nothing to evaluate (NaN).
/// @param share  0 to 1.
std::string PercentText(double share);

/// Matches a pair and measures the time, once the matcher has allocated its memory.
DisparityMap MatchTimed(Matcher& matcher, const ByteImage& left, const ByteImage& right,
                        double& milliseconds);

/// A line for people if ground truth disparities lie outside the range searched; else empty.
std::string BeyondRange(const GroundTruth& truth, int max_disparity);

/// Two images, and what is known about them.
struct PairFiles {
  std::filesystem::path left, right;
  std::vector<std::filesystem::path> calibration;  ///< As for ReadCalibration; empty: already rectified.
  /// This and the next three as for ReadGroundTruth; empty: unknown.
  std::filesystem::path truth;
  std::filesystem::path truth_right;
  std::filesystem::path masks;
  double scale = 1.0;
};

struct PairOptions {
  std::string engine = kBestEngine;
  MatcherOptions matcher;
  TriangulationOptions triangulation;  ///< Used with a calibration.
  bool refine = false;                 ///< Whether to refine disparities for a cloud, as the service does.
};

struct PairResult {
  DisparityMap disparity;
  /// [m] In C; without a calibration in baselines, for a focal length equal to the image's width.
  PointCloud cloud;
  StereoGeometry camera;
  TriangulationOptions triangulation;  ///< Used for the cloud.
  bool calibrated = false;
  double milliseconds = 0.0;
  std::string why_no_matches;        ///< For people; empty if enough was matched.
  std::optional<RowAlignment> rows;  ///< Unless the pair shows too little.
  std::optional<GroundTruth> truth;
  std::optional<Evaluation> evaluation;  ///< If the ground truth is known.
};

/// Throws std::runtime_error and std::invalid_argument as the readers and MakeMatcher do.
PairResult MatchFiles(const PairFiles& files, const PairOptions& options);

/// Writes disparity.pfm, disparity.png and cloud.ply. Throws std::runtime_error naming the file.
void WriteResult(const PairResult& result, const PairOptions& options, const std::filesystem::path& folder);

/// For people: density, time, cloud and, if the ground truth is known, the error rates.
std::string Describe(const PairResult& result, const PairOptions& options);

}  // namespace thalweg::stereo
