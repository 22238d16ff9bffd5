#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/base/time.h"
#include "common/dds/topics.h"
#include "common/geometry/scan_view.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::dds {

/// Groups changed voxels into the blocks of an update. If a voxel occurs twice, its last value counts. O(n).
std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(std::span<const VoxelChange> changes);
/// The blocks of all known voxels of a grid.
std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(const OccupancyGrid& grid);

/// The mapper's side of map transmission: numbers the updates and encodes them. Values are absolute, not
/// differences, so that later updates still fit a full copy that is newer than its number says.
///
/// Threading: one thread.
class MapLog {
 public:
  /// @param session  Differs after each start of the mapper, never 0; see MakeSession().
  MapLog(std::uint64_t session, double voxel_size);
  /// A session ID from the machine's clock, in nanoseconds.
  static std::uint64_t MakeSession();

  /// Adds the changes of one cloud; an update may contain several clouds.
  void Add(Time stamp, const ScanView& scan, std::span<const VoxelChange> changes);
  /// Adds changes whose clouds are not known.
  void Add(Time stamp, std::span<const VoxelChange> changes);
  bool has_news() const { return !scans_.empty() || !changes_.empty(); }

  /// Returns all changes since the previous update, under the next number.
  thalweg_msgs::msg::MapUpdate TakeUpdate();
  /// Returns the whole map, under the number of the last update.
  thalweg_msgs::msg::MapUpdate FullCopy(const OccupancyGrid& grid) const;

  std::uint64_t session() const { return session_; }
  std::uint64_t number() const { return number_; }

 private:
  thalweg_msgs::msg::MapUpdate MakeUpdate(bool full) const;

  std::uint64_t session_;
  double voxel_size_;
  std::uint64_t number_ = 0;
  Time stamp_;  ///< Stamp of the newest cloud.
  std::vector<thalweg_msgs::msg::ScanView> scans_;
  std::vector<VoxelChange> changes_;
};

}  // namespace thalweg::dds
