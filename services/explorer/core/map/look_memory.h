#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/time.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Why unknown or doubtful voxels are no longer something to go for.
enum class AsideReason : std::uint8_t {
  kNone = 0,
  kLookedAt,    ///< Looked at from different places without anything in between, and it stayed.
  kVisited,     ///< A plan was made for its cluster and carried out, and nothing of it changed.
  kOutOfSight,  ///< No place that the robot can reach sees it.
  kLostThere,   ///< On the way to see it the robot lost its own place, again and again.
  kNoDepth,     ///< When it was looked at, the sensor mostly had no depth in that direction.
};
std::string_view ToText(AsideReason reason);

/// What a sensor that looked in some direction had there.
enum class Sensed : std::uint8_t { kDepth, kNothing };

/// What the explorer remembers of unknown and doubtful voxels: how often it looked at them, and which it has
/// set aside.
///
/// A voxel cut by a surface, crossed by grazing rays and hit by none, is called free; the voxel behind it
/// lies in the solid and can never be seen. Without a memory the explorer would go there for ever. So it
/// would where scans go on to contradict each other: each time that a voxel which was known for sure becomes
/// doubtful uses up one of its chances. Threading: one thread.
class LookMemory {
 public:
  struct Options {
    int looks = 2;        ///< So many looks, and a voxel is set aside.
    double apart = 0.25;  ///< [m] Looks from nearer than that to the last one are the same.
    Duration expiry = std::chrono::seconds(300);  ///< A voxel set aside gets one more chance after that.
    int chances = 3;                              ///< No more than so many.
  };
  explicit LookMemory(const Options& options) : options_(options) {}

  /// Follows the map's box; forgets nothing that is still inside.
  void Cover(const VoxelBox& box);
  void Clear();

  int Looks(const VoxelIndex& i) const { return entries_[i].looks; }
  const DenseGrid<std::uint8_t>& set_aside() const { return aside_; }

  /// An unobstructed look at a voxel from p. Sets it aside when it is one too many: as kNoDepth when most
  /// looks sensed nothing.
  void Look(const VoxelIndex& i, const Eigen::Vector3d& p_W, Sensed sensed, Time now);
  /// The same whatever the place: a look that was planned for this voxel, or its cluster.
  void CountLook(const VoxelIndex& i, AsideReason reason, Sensed sensed, Time now);
  void SetAside(const VoxelIndex& i, AsideReason reason, Time now);

  /// Follows changes of state: what became known is forgotten, what became sure is no longer set aside; what
  /// got a new free neighbour, and with it a new side to be seen from, gets another chance.
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
