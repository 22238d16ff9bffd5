#pragma once

#include <array>
#include <functional>
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

/// How well visual odometry follows the camera of a sequence.
struct SequenceEvaluation {
  std::string layout;  ///< KITTI, EuRoC
  std::size_t frames = 0;
  std::array<int, 3> states{};           ///< Frames, by TrackingState.
  int recognized = 0;                    ///< Frames that saw a place again.
  std::size_t places = 0;                ///< Kept at the end.
  std::vector<TimedPose> trajectory;     ///< T_OC
  std::vector<PosePair> compared;        ///< The poses whose truth is known,
  std::optional<TrajectoryError> error;  ///< and how far off they are: of two or more.
  TimingStatistics::Summary time;        ///< [ms] a frame
};

struct SequenceOptions {
  std::size_t first = 0;  ///< Frame to begin with.
  VisualOdometry::Options estimator;
};

/// @param remark  Gets a line for people where the tracking changes for a reason.
/// Throws std::runtime_error when the sequence has no frame `first`, or naming a file that is no image.
SequenceEvaluation Evaluate(const Sequence& sequence, const SequenceOptions& options,
                            const std::function<void(const std::string&)>& remark);

/// For people, a line each: frames and states, time, errors. "-" stands for what is not known.
std::vector<std::string> Describe(const SequenceEvaluation& evaluation);

/// For people, a line for each length of stretches; none where the truth is not known.
std::vector<std::string> DescribeByLength(const SequenceEvaluation& evaluation);

/// For programs; keys carry their units, what is not known is null.
nlohmann::ordered_json ToJson(const SequenceEvaluation& evaluation);

/// The path and the true one, in the frame of the truth; the latter empty where it is not known.
struct Paths {
  std::vector<Eigen::Vector3d> estimated;
  std::vector<Eigen::Vector3d> truth;
};
Paths PathsOf(const SequenceEvaluation& evaluation);

}  // namespace thalweg::visual_odometry
