#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/geometry/timed_pose.h"

namespace thalweg::visual_odometry {

/// Reads KITTI's format: twelve numbers per line, a 3 x 4 pose matrix row by row. Throws std::runtime_error
/// naming file and line: a wrong number of numbers, one that is invalid or not finite, a matrix that is not a
/// rotation.
std::vector<RigidTransform> ReadKittiPoses(const std::filesystem::path& file);

/// Reads the format of the TUM RGB-D benchmark: "stamp tx ty tz qx qy qz qw" per line [s, m], # for comments.
/// Throws std::runtime_error naming file and line, also if the stamps do not increase.
std::vector<TimedPose> ReadTumTrajectory(const std::filesystem::path& file);

/// Reads either of the two, distinguished by the number of values in the first line. KITTI's poses get the
/// stamps k / rate.
std::vector<TimedPose> ReadTrajectory(const std::filesystem::path& file, double kitti_rate);

/// Reads EuRoC's "time_ns, px, py, pz, qw, qx, qy, qz, ..." with a header line. The same errors.
std::vector<TimedPose> ReadEurocTruth(const std::filesystem::path& file);

/// Interpolates linearly between the poses before and after a stamp; nothing before the first pose, after the
/// last, or in a gap longer than `longest_gap`.
class Trajectory {
 public:
  /// @param poses  With increasing stamps.
  Trajectory(std::vector<TimedPose> poses, Duration longest_gap)
      : poses_(std::move(poses)), longest_gap_(longest_gap) {}
  const std::vector<TimedPose>& poses() const { return poses_; }
  std::optional<RigidTransform> At(Time stamp) const;

 private:
  std::vector<TimedPose> poses_;
  Duration longest_gap_;
};

}  // namespace thalweg::visual_odometry
