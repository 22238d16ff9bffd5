#pragma once

#include <cstdint>
#include <vector>

#include "services/explorer/core/map/planning_map.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// How much of what is worth seeing a sensor would see from each of many places.
///
/// From the centre of each place kRays rays, spread evenly over the sphere, run to the first voxel that is
/// not free, or to the sensor's range. One that ends in a voxel of interest has seen it, and where rays are
/// further apart than voxels it stands for the voxels about it: its weight is max(1, r^2 4 pi / kRays) with r
/// in voxels, a voxel that several rays end in counting once. The gain of a view is the sum over the rays
/// within its image. A doubtful voxel counts by its weight, whether the ray ends in it or passes it.
///
/// Ends are kept from call to call: a ray is walked on where its end has become free and cut off where a
/// voxel that it crossed no longer is. One that has come to a surface, or to the sensor's range, is not asked
/// again before that changes. So the cost follows what has changed and what is unknown, not places times rays
/// times length, but for doubtful voxels, for which every ray is looked through. Equal to casting all anew.
/// Threading: one thread.
class SensorGain {
 public:
  static constexpr std::size_t kRays = 600;

  SensorGain(const ViewPlanner& views, double voxel_size, double range);

  enum class Interest : std::uint8_t { kNone, kSome };
  /// Takes over the map.
  /// @param targets   Unknown voxels that are worth seeing.
  /// @param doubtful  Known ones that are worth the weight of the map's DoubtOptions.
  void Follow(const PlanningMap& map, const std::vector<VoxelIndex>& targets,
              const std::vector<VoxelIndex>& doubtful = {});

  /// Of a free voxel, as large as the gain of any view from there or larger. Keeps the place from then on.
  double UpperBound(const VoxelIndex& place);

  struct Gain {
    double value = 0.0;  ///< [voxels] of the best view
    std::size_t view = 0;
    std::vector<VoxelIndex> seen;  ///< The voxels of interest in it, each once.
  };
  Gain BestView(const VoxelIndex& place);

 private:
  enum class Cell : std::uint8_t { kFree, kDark, kSurface, kInteresting };
  struct Place {
    VoxelIndex voxel;
    std::vector<std::uint16_t> ends;  ///< Of each ray, the step that it ends at.
    std::vector<std::uint16_t> open;  ///< Rays, in their order, of which that may change.
  };
  Place& PlaceAt(const VoxelIndex& voxel);
  /// Walks on where the map has become free. visit(ray, voxel, weight) for each end of interest.
  template <class Visitor>
  void Walk(Place& place, Visitor&& visit) const;
  /// The same for each doubtful voxel on the way of a ray, its end included, after Walk.
  template <class Visitor>
  void VisitDoubtful(const Place& place, Visitor&& visit) const;
  /// Ends rays at what is no longer free, and opens those that ended at what is no longer a surface.
  void FollowChanges(const std::vector<VoxelIndex>& blocked, const std::vector<VoxelIndex>& opened);

  // Ray r crosses the voxels first_[r] to first_[r + 1] - 1 of these, its place's own left out.
  std::vector<std::uint32_t> first_;
  std::vector<VoxelIndex> offsets_;
  std::vector<std::int32_t> jumps_;                ///< The same in the grid.
  std::vector<std::uint32_t> weights_;             ///< Of an end there, in sixteenths of a voxel.
  std::vector<std::vector<std::uint16_t>> views_;  ///< Of each ray, that have it in their image.
  std::size_t view_count_;
  DenseGrid<Cell> cells_;
  std::vector<VoxelIndex> targets_;
  DenseGrid<std::uint8_t> doubtful_;             ///< Without cells where there are none.
  std::vector<std::uint32_t> doubtful_weights_;  ///< As weights_, of a doubtful voxel.
  DenseGrid<std::int32_t> numbers_;              ///< In places_, -1 = none.
  DenseGrid<std::uint8_t> is_place_;             ///< The same as yes or no, small enough to stay in a cache.
  std::vector<Place> places_;
  std::vector<std::uint32_t> counted_;  ///< Scratch: of each voxel, when it was counted.
  std::uint32_t count_ = 0;
};

}  // namespace thalweg::explorer
