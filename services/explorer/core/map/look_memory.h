#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Why unknown or doubtful voxels are no longer targets.
enum class AsideReason : std::uint8_t {
  kNone = 0,
  kLookedAt,    ///< Unchanged after unobstructed looks from different positions.
  kVisited,     ///< A plan for its cluster was executed, and nothing in the cluster changed.
  kOutOfSight,  ///< No position that the robot can reach sees it.
  kLostThere,   ///< The robot repeatedly got lost, or was stopped, on the path to it.
  kNoDepth,     ///< During most looks the sensor had no depth in that direction.
  kIgnored,     ///< An operator commanded it; it never gets another chance.
  kTooSmall,    ///< Its cluster is too small to be worth a visit. Not remembered.
  kNoRoom,      ///< The robot turns only in curves, and none of them leads to a view of it.
};
/// All of them but kNone.
inline constexpr AsideReason kAsideReasons[] = {
    AsideReason::kLookedAt, AsideReason::kVisited, AsideReason::kOutOfSight, AsideReason::kLostThere,
    AsideReason::kNoDepth,  AsideReason::kIgnored, AsideReason::kTooSmall,   AsideReason::kNoRoom,
};
/// Whether the robot tried to see it, and failed.
bool IsInVain(AsideReason reason);
/// The name under which files keep it, which no rewording changes: "looked_at", ...
std::string_view NameOf(AsideReason reason);
std::optional<AsideReason> AsideReasonNamed(std::string_view name);

/// What a sensor measured in the direction of a look.
enum class Sensed : std::uint8_t { kDepth, kNothing };

/// Remembers how often unknown and doubtful voxels were looked at, and which of them are set aside.
///
/// A voxel that a surface cuts is marked free when grazing rays cross it and none hits the surface; the voxel
/// behind it is inside the solid and can never be seen. Without a memory, the explorer would return to it
/// forever. The same holds where scans keep contradicting each other: each time a confidently known voxel
/// becomes doubtful, it uses up one of its chances.
/// Threading: one thread.
class LookMemory {
 public:
  struct Options {
    bool sets_aside = true;  ///< Whether anything is set aside but what an operator ignores.
    int looks = 2;           ///< Looks after which a voxel is set aside.
    double apart = 0.25;     ///< [m] A look from nearer than this to the last one does not count again.
    Duration expiry = std::chrono::seconds(300);  ///< Time after which a voxel set aside gets another chance.
    int chances = 3;                              ///< Most chances per voxel.
  };
  explicit LookMemory(const Options& options) : options_(options) {}

  /// Extends the memory to the map's box; keeps everything that is inside.
  void Cover(const VoxelBox& box);
  void Clear();

  int Looks(const VoxelIndex& i) const { return entries_[i].looks; }
  const DenseGrid<std::uint8_t>& set_aside() const { return aside_; }

  /// Records an unobstructed look at a voxel from `p_W`. After the last look allowed, the voxel is set aside:
  /// as kNoDepth when most looks sensed nothing.
  void Look(const VoxelIndex& i, const Eigen::Vector3d& p_W, Sensed sensed, Time now);
  /// Counts a look that was planned for the voxel or its cluster, wherever the robot was.
  void CountLook(const VoxelIndex& i, AsideReason reason, Sensed sensed, Time now);
  /// Sets a voxel aside. One that is aside already keeps its reason, unless an operator ignores it.
  void SetAside(const VoxelIndex& i, AsideReason reason, Time now);

  /// Follows changes of the map: forgets voxels that became known, restores targets that became certain, and
  /// gives another chance to voxels with a new free neighbor, from which they can be seen.
  void Follow(std::span<const PlanningMap::StateChange> changes);
  /// Adjusts remembered times after the clock jumped back by `back`.
  void ShiftTimes(Duration back);
  /// Gives another chance to voxels set aside longer than `expiry` ago.
  void Expire(Time now);
  /// Gives another chance to the voxels of a box that are set aside in vain. @return How many had one left.
  std::size_t ReopenInVain(const VoxelBox& within);
  /// Makes all voxels set aside for this reason before that time targets again. @return Number of voxels.
  std::size_t Release(AsideReason reason, Time before = Time::max());
  /// Makes those of these voxels targets again that are set aside for this reason.
  void Release(AsideReason reason, std::span<const VoxelIndex> voxels);

  /// Number of voxels set aside for this reason.
  std::size_t Count(AsideReason reason) const;
  /// All voxels set aside, by reason.
  std::map<AsideReason, std::vector<VoxelIndex>> SetAsideVoxels() const;

 private:
  struct Entry {
    std::uint8_t looks = 0;
    std::uint8_t sensed_nothing = 0;  ///< How many of these looks sensed nothing.
    std::uint8_t chances = 0;
    Eigen::Vector3f last_W{0, 0, 0};
    Time set_aside;
  };
  void Reopen(const VoxelIndex& i);
  void BecomeDoubtful(const VoxelIndex& i);

  Options options_;
  DenseGrid<Entry> entries_;
  DenseGrid<std::uint8_t> aside_;  ///< Values of AsideReason.
};

}  // namespace thalweg::explorer
