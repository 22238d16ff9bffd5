#pragma once

#include <cstdint>
#include <vector>

#include "services/explorer/core/map/planning_map.h"
#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {

/// Estimates how much of interest a sensor would see from each of many positions.
///
/// From the center of each position's voxel, kRays rays, spread evenly over the sphere, run to the first
/// voxel that is not free or to the sensor's range. A ray that ends in a voxel of interest has seen it. Where
/// rays are farther apart than voxels, a ray represents the voxels around its end as well: its weight is
/// max(1, r^2 4 pi / kRays) with r in voxels. A voxel in which several rays end counts once. The gain of a
/// view is the sum over the rays within its image. A doubtful voxel counts by its own weight, whether a ray
/// ends in it or passes it.
///
/// The ends of rays are kept between calls: a ray is extended where its end has become free, and cut off
/// where a voxel that it crosses no longer is free. A ray that has reached a surface or the sensor's range is
/// not examined again until that changes. The cost therefore grows with what has changed and what is unknown,
/// and not with positions times rays times length; only doubtful voxels require going through every ray. The
/// result equals casting all rays again.
/// Threading: one thread.
class SensorGain {
 public:
  static constexpr std::size_t kRays = 600;

  SensorGain(const ViewPlanner& views, double voxel_size, double range);

  enum class Interest : std::uint8_t { kNone, kSome };
  /// Adopts the state of the map.
  /// @param targets   Unknown voxels that are worth seeing.
  /// @param doubtful  Known voxels, each worth the weight in the map's DoubtOptions.
  void Follow(const PlanningMap& map, const std::vector<VoxelIndex>& targets,
              const std::vector<VoxelIndex>& doubtful = {});

  /// An upper bound on the gain of any view from a free voxel. Remembers the position from then on.
  double UpperBound(const VoxelIndex& place);

  struct Gain {
    double value = 0.0;  ///< [voxels] Gain of the best view.
    std::size_t view = 0;
    std::vector<VoxelIndex> seen;  ///< The voxels of interest in it, each once.
  };
  Gain BestView(const VoxelIndex& place);

 private:
  enum class Cell : std::uint8_t { kFree, kDark, kSurface, kInteresting };
  struct Place {
    VoxelIndex voxel;
    std::vector<std::uint16_t> ends;  ///< For each ray, the step at which it ends.
    std::vector<std::uint16_t> open;  ///< Rays, in order, whose end may still change.
  };
  Place& PlaceAt(const VoxelIndex& voxel);
  /// Extends rays where the map has become free. Calls visit(ray, voxel, weight) for each end of interest.
  template <class Visitor>
  void Walk(Place& place, Visitor&& visit) const;
  /// After Walk: the same for each doubtful voxel along a ray, including its end.
  template <class Visitor>
  void VisitDoubtful(const Place& place, Visitor&& visit) const;
  /// Cuts rays off at voxels that are no longer free, and reopens those that ended at a former surface.
  void FollowChanges(const std::vector<VoxelIndex>& blocked, const std::vector<VoxelIndex>& opened);

  // Ray r crosses the voxels first_[r] to first_[r + 1] - 1 of these, starting next to the position's own
  // voxel.
  std::vector<std::uint32_t> first_;
  std::vector<VoxelIndex> offsets_;
  std::vector<std::int32_t> jumps_;     ///< The same as offsets in the grid.
  std::vector<std::uint32_t> weights_;  ///< What a ray that ends there counts, in sixteenths of a voxel.
  std::vector<std::vector<std::uint16_t>> views_;  ///< For each ray, the views that have it in their image.
  std::size_t view_count_;
  DenseGrid<Cell> cells_;
  std::vector<VoxelIndex> targets_;
  DenseGrid<std::uint8_t> doubtful_;             ///< Empty when there are none.
  std::vector<std::uint32_t> doubtful_weights_;  ///< As weights_, for a doubtful voxel.
  DenseGrid<std::int32_t> numbers_;              ///< Index in places_; -1 = none.
  DenseGrid<std::uint8_t> is_place_;  ///< Whether numbers_ has an index; small enough to stay in a cache.
  std::vector<Place> places_;
  std::vector<std::uint32_t> counted_;  ///< Scratch: for each voxel, the count_ at which it was last counted.
  std::uint32_t count_ = 0;
};

}  // namespace thalweg::explorer
