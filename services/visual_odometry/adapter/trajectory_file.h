#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/geometry/timed_pose.h"

namespace thalweg::visual_odometry {

/// Twelve numbers a line: a 3 x 4 pose matrix, row by row, as KITTI has it.
/// Throws std::runtime_error naming file and line: a wrong number of numbers, one that is none or not finite,
/// a matrix that is no rotation.
std::vector<RigidTransform> ReadKittiPoses(const std::filesystem::path& file);

/// "stamp tx ty tz qx qy qz qw" a line [s, m], # for comments, as the TUM RGB-D benchmark has it.
/// Throws std::runtime_error naming file and line; also when the stamps do not increase.
std::vector<TimedPose> ReadTumTrajectory(const std::filesystem::path& file);

/// Either of the two, told apart by the numbers in the first line. KITTI's poses get the stamps k / rate.
std::vector<TimedPose> ReadTrajectory(const std::filesystem::path& file, double kitti_rate);

/// EuRoC's "time_ns, px, py, pz, qw, qx, qy, qz, ..." with a header line. The same errors.
std::vector<TimedPose> ReadEurocTruth(const std::filesystem::path& file);

/// Straight between the two poses around it; nothing before the first, after the last, or in a gap longer
/// than `longest_gap`.
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
