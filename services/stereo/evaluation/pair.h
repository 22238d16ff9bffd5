#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/point_cloud.h"
#include "common/geometry/stereo_geometry.h"
#include "services/stereo/adapter/ground_truth.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// A percentage with two decimals; "-" where there was nothing to judge by (NaN). @param share  0 to 1.
std::string PercentText(double share);

/// The disparities, and the time that a matcher takes once it has its memory.
DisparityMap MatchTimed(Matcher& matcher, const ByteImage& left, const ByteImage& right,
                        double& milliseconds);

/// A line for people where the truth cannot be found for its size; else empty.
std::string BeyondRange(const GroundTruth& truth, int max_disparity);

/// Two images, and what is known about them.
struct PairFiles {
  std::filesystem::path left, right;
  std::vector<std::filesystem::path> calibration;  ///< As ReadCalibration takes it; empty: rectified already.
  std::filesystem::path truth;                     ///< These four as ReadGroundTruth; empty: not known.
  std::filesystem::path truth_right;
  std::filesystem::path masks;
  double scale = 1.0;
};

struct PairOptions {
  std::string engine = kBestEngine;
  MatcherOptions matcher;
  TriangulationOptions triangulation;  ///< With a calibration.
  bool refine = false;                 ///< Disparities for a cloud, as the service does.
};

struct PairResult {
  DisparityMap disparity;
  PointCloud cloud;  ///< [m] of C; in baselines, for a lens as wide as the image, without a calibration.
  StereoGeometry camera;
  TriangulationOptions triangulation;  ///< That made the cloud.
  bool calibrated = false;
  double milliseconds = 0.0;
  std::string why_no_matches;  ///< For people; empty where enough was matched.
  std::optional<GroundTruth> truth;
  std::optional<Evaluation> evaluation;  ///< Where the truth is known.
};

/// Throws std::runtime_error and std::invalid_argument as the readers and MakeMatcher do.
PairResult MatchFiles(const PairFiles& files, const PairOptions& options);

/// disparity.pfm, disparity.png and cloud.ply. Throws std::runtime_error naming the file.
void WriteResult(const PairResult& result, const PairOptions& options, const std::filesystem::path& folder);

/// For people: density, time, cloud and, where the truth is known, how much is wrong.
std::string Describe(const PairResult& result, const PairOptions& options);

}  // namespace thalweg::stereo
