#include "services/visual_odometry/evaluation/sequence_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "common/base/angles.h"
#include "common/base/stopwatch.h"
#include "services/visual_odometry/adapter/text.h"

namespace thalweg::visual_odometry {

namespace {

std::string DescribeCalibration(const CalibrationFinding& found) {
  return fmt::format(
      "calibration: {}; disparities too small by {} +- {} px and {} +- {} px x^2, rows by {} +- {} px",
      found.off_probability > 0.5 ? fmt::format("off by about {} px, corrected to {} px",
                                                Fixed(found.offset_px, 1), Fixed(found.left_px, 2))
                                  : "good",
      Fixed(found.disparity_px[0], 2), Fixed(found.disparity_sigma_px[0], 2), Fixed(found.disparity_px[1], 2),
      Fixed(found.disparity_sigma_px[1], 2), Fixed(found.row_px, 2), Fixed(found.row_sigma_px, 2));
}

}  // namespace

cv::Mat Bent(const cv::Mat& right, const PinholeCamera& camera, const DisparityBias& bend, double rows) {
  cv::Mat map_u(right.size(), CV_32F);
  cv::Mat map_v(right.size(), CV_32F);
  for (int v = 0; v < right.rows; ++v) {
    for (int u = 0; u < right.cols; ++u) {
      map_u.at<float>(v, u) = static_cast<float>(u - bend.dot(BiasBasis(camera, u)));
      map_v.at<float>(v, u) = static_cast<float>(v - rows);
    }
  }
  cv::Mat bent;
  cv::remap(right, bent, map_u, map_v, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return bent;
}

SequenceEvaluation Evaluate(const Sequence& sequence, const SequenceOptions& options,
                            const std::function<void(const std::string&)>& remark) {
  if (options.first >= sequence.size()) {
    throw std::runtime_error(fmt::format("the first frame is {}, must be less than the number of frames, {}",
                                         options.first, sequence.size()));
  }
  SequenceEvaluation out;
  out.layout = sequence.layout();
  VisualOdometry odometry(sequence.geometry(), options.estimator);
  TimingStatistics timing;
  std::string last_reason;
  const bool bends = options.bend != DisparityBias::Zero() || options.bend_rows != 0.0;
  const std::size_t end = options.first + std::min(options.most, sequence.size() - options.first);
  for (std::size_t i = options.first; i < end; ++i) {
    StereoImages images = sequence.Load(i);
    if (bends) {
      images.right = Bent(images.right, sequence.geometry().camera, options.bend, options.bend_rows);
    }
    const Stopwatch watch;
    const PoseEstimate estimate = odometry.Track(images);
    timing.Add(watch.Milliseconds());
    ++out.frames;
    ++out.states[static_cast<std::size_t>(estimate.state)];
    out.recognized += estimate.recognized ? 1 : 0;
    const std::string reason = ReasonText(estimate.reason);
    if (!reason.empty() && reason != last_reason)
      remark(fmt::format("frame {}: {}, {}", i, NameOf(estimate.state), reason));
    last_reason = reason;
    out.calibration = estimate.calibration;
    out.trajectory.push_back({estimate.stamp, estimate.T_OC});
    if (const auto T_WC_true = sequence.TruthAt(i)) {
      out.compared.push_back({estimate.stamp, estimate.T_OC, *T_WC_true, estimate.covariance});
      // The first pose is what both are aligned by.
      if (out.compared.size() > 1) {
        out.compared.back().covariance.diagonal().head<3>().array() +=
            options.truth_sigma * options.truth_sigma;
      }
    }
  }
  out.places = odometry.places().size();
  out.time = timing.Summarize();
  if (out.compared.size() >= 2) out.error = Compare(out.compared);
  return out;
}

std::vector<std::string> Describe(const SequenceEvaluation& evaluation) {
  std::vector<std::string> lines;
  lines.push_back(
      fmt::format("{}, {} frames: {} tracking, {} degraded, {} lost; {} places kept, recognized {} times",
                  evaluation.layout, evaluation.frames, evaluation.states[0], evaluation.states[1],
                  evaluation.states[2], evaluation.places, evaluation.recognized));
  lines.push_back(fmt::format("ms per frame: median {}, 95 % {}, max {}", Fixed(evaluation.time.p50_ms, 1),
                              Fixed(evaluation.time.p95_ms, 1), Fixed(evaluation.time.max_ms, 1)));
  if (evaluation.calibration) lines.push_back(DescribeCalibration(*evaluation.calibration));
  if (!evaluation.error) {
    lines.emplace_back("no ground truth to compare with");
    return lines;
  }
  const TrajectoryError& error = *evaluation.error;
  lines.push_back(fmt::format("path {} m, ATE {} m (max {}), end off by {} m (max {}) and {} deg",
                              Fixed(error.path_length, 2), Fixed(error.ate_rmse, 4), Fixed(error.ate_max, 4),
                              Fixed(error.drift, 4), Fixed(error.drift_max, 4),
                              Fixed(error.drift_angle / kDegree, 3)));
  lines.push_back(fmt::format("relative errors: {} %, {} deg/m", Fixed(100.0 * error.relative_translation, 3),
                              Fixed(error.relative_rotation / kDegree, 5)));
  lines.push_back(fmt::format("within the 95 % ellipsoid: position {} %, rotation {} % of the frames",
                              Fixed(100.0 * error.inside_position, 1),
                              Fixed(100.0 * error.inside_rotation, 1)));
  return lines;
}

std::vector<std::string> DescribeByLength(const SequenceEvaluation& evaluation) {
  std::vector<std::string> lines;
  if (!evaluation.error) return lines;
  for (const RelativeError& relative : evaluation.error->by_length) {
    lines.push_back(fmt::format("{} m, {} stretches: {} %, {} deg/m", Fixed(relative.length, 0),
                                relative.stretches, Fixed(100.0 * relative.translation, 3),
                                Fixed(relative.rotation / kDegree, 5)));
  }
  return lines;
}

nlohmann::ordered_json ToJson(const SequenceEvaluation& evaluation) {
  nlohmann::ordered_json json;
  json["layout"] = evaluation.layout;
  json["frames"] = evaluation.frames;
  for (const auto state : {TrackingState::kTracking, TrackingState::kDegraded, TrackingState::kLost}) {
    json["states"][NameOf(state)] = evaluation.states[static_cast<std::size_t>(state)];
  }
  json["places"] = evaluation.places;
  json["recognized"] = evaluation.recognized;
  json["frame_time_ms"] = {
      {"p50", evaluation.time.p50_ms}, {"p95", evaluation.time.p95_ms}, {"max", evaluation.time.max_ms}};
  if (evaluation.calibration) {
    const CalibrationFinding& found = *evaluation.calibration;
    json["calibration"] = {{"off_probability", found.off_probability},
                           {"offset_px", found.offset_px},
                           {"left_px", found.left_px},
                           {"disparity_px", {found.disparity_px[0], found.disparity_px[1]}},
                           {"disparity_sigma_px", {found.disparity_sigma_px[0], found.disparity_sigma_px[1]}},
                           {"row_px", found.row_px},
                           {"row_sigma_px", found.row_sigma_px}};
  }
  if (!evaluation.error) {
    json["error"] = nullptr;
    return json;
  }
  const TrajectoryError& error = *evaluation.error;
  auto& to = json["error"];
  to["poses"] = error.poses;
  to["path_length_m"] = error.path_length;
  to["ate_rmse_m"] = error.ate_rmse;
  to["ate_max_m"] = error.ate_max;
  to["drift_m"] = error.drift;
  to["drift_max_m"] = error.drift_max;
  to["drift_deg"] = error.drift_angle / kDegree;
  to["inside_95_percent"] = {{"position", error.inside_position}, {"rotation", error.inside_rotation}};
  to["relative_translation_percent"] = 100.0 * error.relative_translation;  // NaN becomes null
  to["relative_rotation_deg_per_m"] = error.relative_rotation / kDegree;
  to["by_length"] = nlohmann::ordered_json::array();
  for (const RelativeError& relative : error.by_length) {
    to["by_length"].push_back({{"length_m", relative.length},
                               {"stretches", relative.stretches},
                               {"translation_percent", 100.0 * relative.translation},
                               {"rotation_deg_per_m", relative.rotation / kDegree}});
  }
  return json;
}

Paths PathsOf(const SequenceEvaluation& evaluation) {
  RigidTransform T_WO = RigidTransform::Identity();
  if (!evaluation.compared.empty()) {
    const PosePair& first = evaluation.compared.front();
    T_WO = first.T_WC_true * first.T_OC.inverse();
  }
  Paths paths;
  for (const TimedPose& pose : evaluation.trajectory)
    paths.estimated.push_back((T_WO * pose.T).translation());
  for (const PosePair& pair : evaluation.compared) paths.truth.push_back(pair.T_WC_true.translation());
  return paths;
}

}  // namespace thalweg::visual_odometry
