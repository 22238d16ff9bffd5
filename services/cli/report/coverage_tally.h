#pragma once

#include <bitset>
#include <functional>
#include <unordered_map>
#include <vector>

#include "common/voxel/occupancy_grid.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Remembers the order in which voxels became known, so that what part of them matters can be decided later:
/// the true map takes longer to compute than the run takes to begin.
class CoverageTally {
 public:
  void Add(const VoxelIndex& voxel);
  void Add(const OccupancyGrid& grid);  ///< All that is known in it.

  std::size_t known() const { return order_.size(); }              ///< Voxels, ever.
  const std::vector<VoxelIndex>& order() const { return order_; }  ///< As they became known.

  /// Notes where the run stands now; `coverage` stays open.
  void Sample(double time, double distance, double voxel_volume);

  const std::vector<ProgressSample>& samples() const { return samples_; }
  /// With the coverage of each sample. @param observable  Whether a voxel counts. @param count  Of those.
  std::vector<ProgressSample> SamplesWith(const std::function<bool(const VoxelIndex&)>& observable,
                                          std::size_t count) const;

 private:
  using Known = std::bitset<OccupancyGrid::kBlockVoxels>;
  std::unordered_map<VoxelIndex, Known, VoxelIndexHash> known_;
  std::vector<VoxelIndex> order_;
  std::vector<ProgressSample> samples_;
  std::vector<std::size_t> known_at_;  ///< Length of order_ at each sample.
};

}  // namespace thalweg::cli
