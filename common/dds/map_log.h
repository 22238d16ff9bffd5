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

/// The blocks of an update out of changed voxels; of a voxel that is there twice the last value. O(n).
std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(std::span<const VoxelChange> changes);
/// All known voxels of a grid.
std::vector<thalweg_msgs::msg::MapBlock> BlocksOf(const OccupancyGrid& grid);

/// The mapper's side of the map on the wire: numbers its updates and makes the messages. Values are absolute,
/// not differences, so that a full copy may be newer than its number says and the updates after it still fit.
/// Threading: one thread.
class MapLog {
 public:
  /// @param session  Another one each time the mapper starts, never 0; see MakeSession().
  MapLog(std::uint64_t session, double voxel_size);
  /// By the machine's clock in nanoseconds.
  static std::uint64_t MakeSession();

  /// Takes in what one cloud changed; an update may hold several clouds.
  void Add(Time stamp, const ScanView& scan, std::span<const VoxelChange> changes);
  bool has_news() const { return !scans_.empty(); }

  /// All news since the update before, under the next number.
  thalweg_msgs::msg::MapUpdate TakeUpdate();
  /// The whole map, under the number of the update taken last.
  thalweg_msgs::msg::MapUpdate FullCopy(const OccupancyGrid& grid) const;

  std::uint64_t session() const { return session_; }
  std::uint64_t number() const { return number_; }

 private:
  thalweg_msgs::msg::MapUpdate MakeUpdate(bool full) const;

  std::uint64_t session_;
  double voxel_size_;
  std::uint64_t number_ = 0;
  Time stamp_;  ///< Of the newest cloud.
  std::vector<thalweg_msgs::msg::ScanView> scans_;
  std::vector<VoxelChange> changes_;
};

}  // namespace thalweg::dds
