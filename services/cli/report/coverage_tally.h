#pragma once

#include <bitset>
#include <cstddef>
#include <deque>
#include <functional>
#include <unordered_map>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Records the order in which voxels became known, so that it can be decided later which of them count:
/// computing the true map takes longer than starting a run.
///
/// Memory: at most kMostVoxels * 12 B and 100 B per block; voxels beyond that are not counted.
class CoverageTally {
 public:
  /// 32 000 m^3 in voxels of 0.1 m.
  static constexpr std::size_t kMostVoxels = 1U << 25U;
  static constexpr std::size_t kMostBlocks = 1U << 18U;

  explicit CoverageTally(std::size_t most_voxels = kMostVoxels, std::size_t most_blocks = kMostBlocks)
      : most_voxels_(most_voxels), most_blocks_(most_blocks) {}

  void Add(const VoxelIndex& voxel);
  void Add(const OccupancyGrid& grid);  ///< Adds all known voxels.

  std::size_t known() const { return order_.size(); }  ///< Number of voxels ever known.
  bool full() const { return full_; }                  ///< Whether there were more than it counts.
  /// In the order in which they became known.
  const std::deque<VoxelIndex>& order() const { return order_; }

  /// Records the current state of the run. `explored` is filled in, `coverage` later.
  void Sample(const ProgressSample& now, double voxel_volume);

  const std::vector<ProgressSample>& samples() const { return samples_; }
  /// Calls visit(voxel, time) for each voxel in the order in which they became known, with the time of the
  /// first sample that counts it. Voxels later than the last sample are left out.
  template <class Visitor>
  void ForEachKnown(Visitor&& visit) const {
    std::size_t next = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      for (; next < known_at_[i]; ++next) visit(order_[next], samples_[i].time);
    }
  }
  /// The samples with their coverage.
  /// @param observable  Whether a voxel counts.
  /// @param count       Number of voxels that count.
  std::vector<ProgressSample> SamplesWith(const std::function<bool(const VoxelIndex&)>& observable,
                                          std::size_t count) const;

 private:
  using Known = std::bitset<OccupancyGrid::kBlockVoxels>;
  std::unordered_map<VoxelIndex, Known, VoxelIndexHash> known_;
  std::deque<VoxelIndex> order_;  ///< Grows without a second copy.
  std::size_t most_voxels_;
  std::size_t most_blocks_;
  bool full_ = false;
  std::vector<ProgressSample> samples_;
  std::vector<std::size_t> known_at_;  ///< Length of order_ at each sample.
};

}  // namespace thalweg::cli
