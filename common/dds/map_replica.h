#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/dds/topics.h"
#include "common/geometry/rigid_transform.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::dds {

/// The blocks of an update out of changed voxels, each voxel once. O(n).
std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(std::span<const VoxelChange> changes);
/// All known voxels of a grid.
std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(const OccupancyGrid& grid);

/// A reader's copy of the mapper's map, kept exact from numbered updates.
/// Threading: one thread.
class MapReplica {
 public:
  /// What one update did.
  struct Applied {
    bool replaced = false;             ///< A full copy came: everything may have changed; `changes` is empty.
    std::vector<VoxelChange> changes;  ///< What changed otherwise.
    std::vector<RigidTransform> scans;  ///< T_WC of the clouds inside.
  };

  /// Takes one update. Nothing when it was not wanted (an old number, a full copy that was not needed) or
  /// leaves a gap: then request() tells what to ask for. Error, and nothing taken, when the message lies.
  Result<std::optional<Applied>> Apply(const thalweg_msgs::msg::MapUpdate& update);

  /// Why a full copy is needed, when it is. The reader repeats the request until it has come.
  const std::optional<std::string>& missing() const { return missing_; }
  thalweg_msgs::msg::MapRequest MakeRequest(Time now, std::string_view reader) const;

  bool has_map() const { return grid_.has_value(); }
  const OccupancyGrid& grid() const { return *grid_; }
  std::uint64_t session() const { return session_; }
  std::uint64_t number() const { return number_; }

 private:
  std::optional<OccupancyGrid> grid_;
  std::uint64_t session_ = 0;
  std::uint64_t number_ = 0;
  std::optional<std::string> missing_ = "no map yet";
};

}  // namespace thalweg::dds
