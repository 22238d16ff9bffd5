#pragma once

#include <deque>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "services/link/core/map_codec.h"

namespace thalweg::link {

/// Sends a map by blocks of 8^3 voxels, the newest state of each that has changed, as the link takes them:
/// however slow that is, a block waits once, and only voxels that the other side has otherwise cross.
///
/// Threading: one thread.
class MapFeed {
 public:
  static constexpr std::size_t kBlocks = 64;      ///< In one message.
  static constexpr std::size_t kMostScans = 256;  ///< Most scans that wait; the oldest are dropped.

  explicit MapFeed(double voxel_size) : sent_(voxel_size) {}

  /// Notes which voxels have changed, and from where they were seen.
  void Note(Time stamp, std::span<const VoxelChange> changes, std::span<const ScanView> scans);
  /// The other side has nothing, or another map: all of this one must cross.
  void Restart(Time stamp, const OccupancyGrid& grid);

  /// The next change to be sent; nothing if the other side has everything.
  /// @param grid  As it is now, with the voxel size of this feed.
  std::optional<MapChange> Next(const OccupancyGrid& grid);

  std::size_t waiting() const { return queue_.size(); }  ///< Blocks.
  std::uint64_t dropped_scans() const { return dropped_scans_; }

 private:
  void Queue(const VoxelIndex& block);
  bool AddBlock(const OccupancyGrid& grid, const VoxelIndex& index, MapChange& change);

  OccupancyGrid sent_;
  Time stamp_{};
  bool reset_ = true;
  std::deque<VoxelIndex> queue_;  ///< In the order of their first change since they were sent.
  std::unordered_set<VoxelIndex, VoxelIndexHash> queued_;
  std::deque<ScanView> scans_;
  std::uint64_t dropped_scans_ = 0;
};

}  // namespace thalweg::link
