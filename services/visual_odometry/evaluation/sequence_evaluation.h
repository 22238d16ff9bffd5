#pragma once

#include <array>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/statistics.h"
#include "common/geometry/timed_pose.h"
#include "services/visual_odometry/adapter/sequence.h"
#include "services/visual_odometry/core/trajectory_error.h"
#include "services/visual_odometry/core/visual_odometry.h"

namespace thalweg::visual_odometry {

/// Result of visual odometry on a sequence.
struct SequenceEvaluation {
  std::string layout;  ///< KITTI, EuRoC
  std::size_t frames = 0;
  std::array<int, 3> states{};        ///< Number of frames by TrackingState.
  int recognized = 0;                 ///< Number of frames that recognized a place.
  std::size_t places = 0;             ///< Number of places kept at the end.
  std::vector<TimedPose> trajectory;  ///< T_OC
  std::vector<PosePair> compared;     ///< The poses whose ground truth is known.
  /// What is believed about the calibration at the end; nothing if there were no frames.
  std::optional<CalibrationFinding> calibration;
  std::optional<TrajectoryError> error;  ///< Their errors, if there are at least two.
  TimingStatistics::Summary time;        ///< [ms] Per frame.
};

struct SequenceOptions {
  std::size_t first = 0;                                       ///< First frame to use.
  std::size_t most = std::numeric_limits<std::size_t>::max();  ///< Number of frames to use.
  /// [px] By how much right images are bent first, as a camera would whose calibration is off, see
  /// DisparityBias: disparities become smaller by bend^T (1, x^2), rows larger by bend_rows.
  DisparityBias bend = DisparityBias::Zero();
  double bend_rows = 0.0;
  double truth_sigma = 0.0;  ///< [m] Standard deviation of each coordinate of the true positions.
  VisualOdometry::Options estimator;
};

/// Shows points of a right image at u + bend^T (1, x^2), v + rows [px]; repeats the border.
cv::Mat Bent(const cv::Mat& right, const PinholeCamera& camera, const DisparityBias& bend, double rows);

/// Runs visual odometry on a sequence. Throws std::runtime_error if the sequence has no frame `first`, or
/// naming a file that is not an image.
/// @param remark  Receives a line for people when the tracking state changes for a reason.
SequenceEvaluation Evaluate(const Sequence& sequence, const SequenceOptions& options,
                            const std::function<void(const std::string&)>& remark);

/// For people, one line each: frames and states, time, errors. "-" means unknown.
std::vector<std::string> Describe(const SequenceEvaluation& evaluation);

/// For people, one line for each length of path segments; none if the ground truth is unknown.
std::vector<std::string> DescribeByLength(const SequenceEvaluation& evaluation);

/// For programs; keys include their units, unknown values are null.
nlohmann::ordered_json ToJson(const SequenceEvaluation& evaluation);

/// The estimated path and the true one, in the frame of the ground truth; the latter is empty if unknown.
struct Paths {
  std::vector<Eigen::Vector3d> estimated;
  std::vector<Eigen::Vector3d> truth;
};
Paths PathsOf(const SequenceEvaluation& evaluation);

}  // namespace thalweg::visual_odometry
