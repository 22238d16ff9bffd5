#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/time.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Why unknown or doubtful voxels are no longer targets.
enum class AsideReason : std::uint8_t {
  kNone = 0,
  kLookedAt,    ///< Looked at from different places with nothing in between, and it did not change.
  kVisited,     ///< A plan for its cluster was carried out, and nothing in the cluster changed.
  kOutOfSight,  ///< No place that the robot can reach sees it.
  kLostThere,   ///< On the way to see it the robot lost its own place, again and again.
  kNoDepth,     ///< When it was looked at, the sensor mostly had no depth in that direction.
};
std::string_view ToText(AsideReason reason);

/// What a sensor had in the direction of a look.
enum class Sensed : std::uint8_t { kDepth, kNothing };

/// What the explorer remembers of unknown and doubtful voxels: how often it looked at them, and which it has
/// set aside.
///
/// A voxel that a surface cuts is called free when grazing rays cross it and none hits it; the voxel behind
/// it lies in the solid and can never be seen. Without a memory the explorer would go there forever. The same
/// holds where scans keep contradicting each other: each time a voxel that was known for sure becomes
/// doubtful, it uses up one of its chances. Threading: one thread.
class LookMemory {
 public:
  struct Options {
    int looks = 2;        ///< After this many looks a voxel is set aside.
    double apart = 0.25;  ///< [m] Looks from nearer than this to the last one count as the same look.
    Duration expiry = std::chrono::seconds(300);  ///< A voxel set aside gets one more chance after that.
    int chances = 3;                              ///< No more than this many.
  };
  explicit LookMemory(const Options& options) : options_(options) {}

  /// Follows the map's box; forgets nothing that is still inside.
  void Cover(const VoxelBox& box);
  void Clear();

  int Looks(const VoxelIndex& i) const { return entries_[i].looks; }
  const DenseGrid<std::uint8_t>& set_aside() const { return aside_; }

  /// Records an unobstructed look at a voxel from p. Sets the voxel aside when it was the last one allowed:
  /// as kNoDepth when most looks sensed nothing.
  void Look(const VoxelIndex& i, const Eigen::Vector3d& p_W, Sensed sensed, Time now);
  /// The same wherever the robot was: a look that was planned for this voxel, or its cluster.
  void CountLook(const VoxelIndex& i, AsideReason reason, Sensed sensed, Time now);
  void SetAside(const VoxelIndex& i, AsideReason reason, Time now);

  /// Follows changes of state: forgets voxels that became known, no longer sets aside those that became sure,
  /// and gives another chance to those with a new free neighbor, from which they can be seen.
  void Follow(std::span<const PlanningMap::StateChange> changes);
  /// The clock went back by that much.
  void ShiftTimes(Duration back);
  /// Gives another chance to what was set aside longer than `expiry` ago.
  void Expire(Time now);
  /// Gives another chance to all that was set aside for that reason. @return how many voxels.
  std::size_t Release(AsideReason reason);

  /// All voxels set aside, by reason.
  std::map<AsideReason, std::vector<VoxelIndex>> SetAsideVoxels() const;

 private:
  struct Entry {
    std::uint8_t looks = 0;
    std::uint8_t sensed_nothing = 0;  ///< Of these looks.
    std::uint8_t chances = 0;
    Eigen::Vector3f last_W{0, 0, 0};
    Time set_aside;
  };
  void Reopen(const VoxelIndex& i);
  void BecomeDoubtful(const VoxelIndex& i);

  Options options_;
  DenseGrid<Entry> entries_;
  DenseGrid<std::uint8_t> aside_;  ///< AsideReason
};

}  // namespace thalweg::explorer
