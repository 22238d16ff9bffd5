#pragma once

#include <cstdint>
#include <vector>

#include "services/explorer/core/planning_map.h"
#include "services/explorer/core/view.h"

namespace thalweg::explorer {

/// How much of what is worth seeing a sensor would see from each of many places.
///
/// From the centre of each place kRays rays, spread evenly over the sphere, run to the first voxel that is
/// not free, or to the sensor's range. One that ends in a voxel of interest has seen it, and where rays are
/// further apart than voxels it stands for the voxels about it: its weight is max(1, r^2 4 pi / kRays) with r
/// in voxels, a voxel that several rays end in counting once. The gain of a view is the sum over the rays
/// within its image.
///
/// Ends are kept from call to call: a ray is walked on where its end has become free and cut off where a
/// voxel that it crossed no longer is, so that the cost follows what has changed, not places times rays times
/// length. Equal to casting all anew.
/// Threading: one thread.
class SensorGain {
 public:
  static constexpr std::size_t kRays = 600;

  SensorGain(const ViewPlanner& views, double voxel_size, double range);

  enum class Interest : std::uint8_t { kNone, kSome };
  /// Takes over the map. @param targets  Unknown voxels that are worth seeing.
  void Follow(const PlanningMap& map, const std::vector<VoxelIndex>& targets);

  /// Of a free voxel, as large as the gain of any view from there or larger. Keeps the place from then on.
  double UpperBound(const VoxelIndex& place);

  struct Gain {
    double value = 0.0;  ///< [voxels] of the best view
    std::size_t view = 0;
    std::vector<VoxelIndex> seen;  ///< The voxels of interest in it, each once.
  };
  Gain BestView(const VoxelIndex& place);

 private:
  enum class Cell : std::uint8_t { kFree, kBlocked, kInteresting };
  using Ends = std::vector<std::uint16_t>;  ///< Of each ray, the step that it ends at.
  Ends& EndsOf(const VoxelIndex& place);
  /// Walks on where the map has become free. visit(ray, voxel, weight) for each end of interest.
  template <class Visitor>
  void Walk(std::size_t at, Ends& ends, Visitor&& visit) const;
  void CutOff(const std::vector<VoxelIndex>& blocked);

  // Ray r crosses the voxels first_[r] to first_[r + 1] - 1 of these, its place's own left out.
  std::vector<std::uint32_t> first_;
  std::vector<VoxelIndex> offsets_;
  std::vector<std::int32_t> jumps_;                ///< The same in the grid.
  std::vector<std::uint32_t> weights_;             ///< Of an end there, in sixteenths of a voxel.
  std::vector<std::vector<std::uint16_t>> views_;  ///< Of each ray, that have it in their image.
  std::size_t view_count_;
  DenseGrid<Cell> cells_;
  std::vector<VoxelIndex> targets_;
  DenseGrid<std::int32_t> numbers_;  ///< Of places, -1 = none.
  std::vector<VoxelIndex> places_;
  std::vector<Ends> ends_;              ///< Of each place.
  std::vector<std::uint32_t> counted_;  ///< Scratch: of each voxel, when it was counted.
  std::uint32_t count_ = 0;
};

}  // namespace thalweg::explorer
