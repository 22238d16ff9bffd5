#pragma once

#include <optional>

#include "common/base/stamp_order.h"
#include "common/dds/health.h"
#include "common/geometry/pose_history.h"

namespace thalweg::dds {

/// The poses by which clouds are placed, and the order of both streams, which share a clock that may be
/// restarted. What is not later than its predecessor, and every restart, is counted in the health.
///
/// Threading: the bus's thread.
class CloudPlacement {
 public:
  using Verdict = StampOrder::Verdict;

  /// @param health  Must outlive the object.
  explicit CloudPlacement(Health& health) : health_(health) {}

  /// Judges a pose before it is added to poses(); those from before a restart are discarded.
  Verdict JudgePose(Time stamp) {
    const Verdict verdict = pose_order_.Judge(stamp);
    if (verdict == Verdict::kNotLater) health_.Drop<topics::Odometry>(kNotLater);
    if (verdict == Verdict::kRestarted) {
      health_.Drop<topics::Odometry>("time jumped back: earlier poses discarded");
      poses_.Clear();
    }
    if (!joined_ || verdict == Verdict::kRestarted) joined_ = stamp;
    return verdict;
  }

  /// Judges a cloud. After a restart, the caller discards the clouds that wait for their poses.
  Verdict JudgeCloud(Time stamp, const char* topic) {
    const Verdict verdict = cloud_order_.Judge(stamp);
    if (verdict == Verdict::kNotLater) health_.Drop(topic, kNotLater);
    if (verdict == Verdict::kRestarted) {
      health_.Drop(topic, "time jumped back: earlier clouds discarded");
      // Poses from before the jump must not place this cloud; poses that already follow the jump may.
      if (pose_order_.IsRestartedAt(stamp)) poses_.Clear();
    }
    return verdict;
  }

  /// The pose of the body at a cloud's stamp. A cloud without one is counted, unless it was taken just before
  /// the first pose came: nobody lost what was sent while this process joined.
  std::optional<RigidTransform> PoseAt(Time stamp, const char* topic) {
    constexpr Duration kJoining = std::chrono::seconds(1);
    const Result<RigidTransform> pose = poses_.At(stamp);
    if (pose) return *pose;
    const bool while_joining = joined_ && stamp < *joined_ && *joined_ - stamp < kJoining;
    if (!while_joining) health_.Drop(topic, pose.error());
    return std::nullopt;
  }

  PoseHistory& poses() { return poses_; }
  const std::optional<Time>& newest_pose() const { return pose_order_.newest(); }
  const std::optional<Time>& newest_cloud() const { return cloud_order_.newest(); }

 private:
  static constexpr auto kNotLater = "not later than the previous one";

  Health& health_;
  PoseHistory poses_;
  StampOrder pose_order_;
  StampOrder cloud_order_;
  std::optional<Time> joined_;  ///< Stamp of the first pose, since the last restart.
};

}  // namespace thalweg::dds
