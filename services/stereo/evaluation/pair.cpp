#include "services/stereo/evaluation/pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/stopwatch.h"
#include "common/files/ply.h"
#include "common/files/write_file.h"
#include "services/stereo/adapter/calibration_file.h"
#include "services/stereo/adapter/image_files.h"
#include "services/stereo/core/calibration.h"
#include "services/stereo/core/refinement.h"

namespace thalweg::stereo {
namespace {

constexpr double kPercent = 100.0;
constexpr double kLeastDisparity = 1.0;  // [px] of a cloud without calibration

/// Without a calibration, depths are in baselines, for a focal length equal to the image's width.
StereoGeometry UnknownCamera(const ByteImage& left) {
  const double f = left.width();
  return {{left.width(), left.height(), f, f, 0.5 * (left.width() - 1), 0.5 * (left.height() - 1)}, 1.0};
}

/// Without a scale in meters: keeps every point with a significant disparity.
TriangulationOptions WithoutMeters(const StereoGeometry& camera) {
  TriangulationOptions options;
  options.min_depth = 0.0;
  options.max_depth = camera.camera.fx * camera.baseline / kLeastDisparity;
  options.max_depth_error = std::numeric_limits<double>::infinity();
  return options;
}

std::string EvaluationText(const Evaluation& e, const GroundTruth& truth) {
  return fmt::format(
      "bad pixels (> 1 px) in %: non-occluded {}, near discontinuities {}, all {}, of the matched {}\n"
      "  non-occluded pixels determined from {}\n",
      PercentText(e.bad_non_occluded), PercentText(e.bad_near_discontinuities), PercentText(e.bad_all),
      PercentText(e.bad_matched), truth.non_occluded_from);
}

}  // namespace

std::string PercentText(double share) {
  return std::isnan(share) ? "-" : fmt::format("{:.2f}", kPercent * share);
}

DisparityMap MatchTimed(Matcher& matcher, const ByteImage& left, const ByteImage& right,
                        double& milliseconds) {
  matcher.Match(left, right);
  const Stopwatch stopwatch;
  DisparityMap disparity = matcher.Match(left, right);
  milliseconds = stopwatch.Milliseconds();
  return disparity;
}

std::string BeyondRange(const GroundTruth& truth, int max_disparity) {
  float greatest = 0.0F;
  for (const float d : truth.disparity.data()) greatest = d > greatest ? d : greatest;  // not NaN
  if (greatest < static_cast<float>(max_disparity)) return "";
  return fmt::format(
      "  the ground truth reaches {:g} px, but only disparities below {} are searched: check its scale and "
      "the "
      "range\n",
      greatest, max_disparity);
}

PairResult MatchFiles(const PairFiles& files, const PairOptions& options) {
  ByteImage left = ReadImage(files.left);
  ByteImage right = ReadImage(files.right);
  CheckPair(left, right);
  PairResult result;
  result.camera = UnknownCamera(left);
  result.triangulation = WithoutMeters(result.camera);
  result.calibrated = !files.calibration.empty();
  if (result.calibrated) {
    const StereoRectifier rectifier(
        ReadCalibration(files.calibration, ImageSize{left.width(), left.height()}));
    left = Rectify(rectifier, Side::kLeft, left);
    right = Rectify(rectifier, Side::kRight, right);
    result.camera = rectifier.geometry();
    result.triangulation = options.triangulation;
  }
  if (!files.truth.empty()) {
    result.truth = ReadGroundTruth(files.truth, files.truth_right, files.scale, files.masks, left);
  }
  const auto matcher = MakeMatcher(options.engine, options.matcher);
  result.disparity = MatchTimed(*matcher, left, right, result.milliseconds);
  if (options.refine) {
    Refine(ToGray(left), ToGray(right), {}, static_cast<std::size_t>(options.matcher.threads),
           result.disparity);
  }
  result.cloud = Triangulate(result.disparity, left, result.camera, result.triangulation);
  result.why_no_matches = WhyNoMatches(result.disparity, left, right, options.matcher.max_disparity);
  result.rows = MeasureRowAlignment(ToGray(left), ToGray(right), options.matcher.max_disparity);
  if (result.truth) {
    result.evaluation = Evaluate(result.disparity, result.truth->disparity, result.truth->masks);
  }
  return result;
}

void WriteResult(const PairResult& result, const PairOptions& options, const std::filesystem::path& folder) {
  WritePfm(folder / "disparity.pfm", result.disparity);
  WriteColored(folder / "disparity.png", result.disparity, options.matcher.max_disparity);
  WriteFile(folder / "cloud.ply", PlyOf(result.cloud));
}

std::string Describe(const PairResult& result, const PairOptions& options) {
  const auto points = std::ranges::count_if(result.cloud.points_C,
                                            [](const Eigen::Vector3f& p_C) { return p_C.allFinite(); });
  const double density = Density(result.disparity);
  std::string text = fmt::format(
      "{}: density {:.1f} %, {:.1f} ms\ncloud.ply: {} points, depths to {:.1f}{}\n", options.engine,
      kPercent * density, result.milliseconds, points, FarthestDepth(result.camera, result.triangulation),
      result.calibrated ? " m" : " baselines, for a lens as wide as the image (no --calibration)");
  if (!result.why_no_matches.empty()) text += result.why_no_matches + '\n';
  if (result.rows) text += Describe(*result.rows) + '\n';
  if (points == 0 && density > 0.0) {
    text += fmt::format(
        "no point of the cloud is left: the baseline is {:.3f} m; is the calibration in meters?\n",
        result.camera.baseline);
  }
  if (result.evaluation) {
    text += EvaluationText(*result.evaluation, *result.truth);
    text += BeyondRange(*result.truth, options.matcher.max_disparity);
  }
  return text;
}

}  // namespace thalweg::stereo
