#include "services/evaluator/core/flown_trajectory.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <unordered_set>

#include "services/evaluator/core/contact_meter.h"
#include "services/evaluator/core/run_sensor.h"

namespace thalweg::evaluator {
namespace {

/// The poses at any time between the first and the last; times must not decrease.
class Track {
 public:
  explicit Track(std::span<const TimedPose> poses) : poses_(poses) {}
  RigidTransform At(Time time) {
    while (next_ + 1 < poses_.size() && poses_[next_].stamp < time) ++next_;
    const TimedPose& before = poses_[next_ - 1];
    const TimedPose& after = poses_[next_];
    const double share = Seconds(time - before.stamp) / Seconds(after.stamp - before.stamp);
    return Interpolate(before.T, after.T, std::clamp(share, 0.0, 1.0));
  }

 private:
  std::span<const TimedPose> poses_;
  std::size_t next_ = 1;
};

}  // namespace

LockstepResult Fly(const simulator::World& given, std::span<const TimedPose> T_WBs,
                   const LockstepOptions& options, mapper::FusedMap& map, const simulator::TrueMap& truth) {
  if (T_WBs.size() < 2) throw std::invalid_argument("a trajectory needs at least two poses");
  for (std::size_t k = 1; k < T_WBs.size(); ++k) {
    if (T_WBs[k].stamp <= T_WBs[k - 1].stamp) throw std::invalid_argument("stamps must increase");
  }
  std::optional<simulator::World> own_world;  // where parts move, since others use the given one as well
  if (!given.parts().empty()) own_world = given.AtStart();
  const simulator::World& world = own_world ? *own_world : given;
  RunSensor sensor(options.sensor, options.stereo, options.noise_seed, /*colors=*/false);
  ContactMeter contacts(world, options.robot);
  MotionMeter motion(T_WBs.front().T);
  Track track(T_WBs);
  LockstepResult result;
  std::unordered_set<VoxelIndex, VoxelIndexHash> known;
  std::size_t observed = 0;
  const auto scan = [&](const RigidTransform& T_WB, double time) {
    const RigidTransform T_WC = T_WB * options.robot.T_BC;
    for (const VoxelChange& change : map.Integrate(sensor.Capture(world, T_WC), T_WC)) {
      if (!known.insert(change.voxel).second) continue;
      if (truth.Observable(change.voxel)) ++observed;
    }
    ++result.scans;
    result.samples.push_back({time, result.distance, T_WB.translation(), known.size(), observed});
  };

  const Time begin = T_WBs.front().stamp;
  const Time end = T_WBs.back().stamp;
  const Duration step = FromSeconds(options.time_step);
  const Duration period = FromSeconds(1.0 / sensor.rate());
  Time next_scan = begin;
  Eigen::Vector3d before_W = T_WBs.front().T.translation();
  Time before = begin;
  for (Time now = begin;; now = std::min(now + step, end)) {
    const RigidTransform T_WB = track.At(now);
    double approach = 0.0;
    if (now > before) {
      motion.Move(T_WB, Seconds(now - before));
      if (own_world)
        approach = own_world->MoveParts(Seconds(now - before), options.robot, T_WB.translation());
    }
    before = now;
    const double travel = (T_WB.translation() - before_W).norm();
    before_W = T_WB.translation();
    result.distance += travel;
    contacts.Move(T_WB.translation(), travel + approach);
    if (now >= next_scan || now == end) {
      scan(T_WB, Seconds(now - begin));
      next_scan += period;
    }
    if (now == end || options.stop.stop_requested()) break;
  }
  result.end = {.kind = options.stop.stop_requested() ? RunEnd::Kind::kInterrupted : RunEnd::Kind::kFlown};
  result.duration = Seconds(end - begin);
  result.motion = motion.figures();
  result.collisions = contacts.collisions();
  result.least_clearance = contacts.least_clearance();
  return result;
}

}  // namespace thalweg::evaluator
