#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/geometry/inspection_criterion.h"
#include "common/geometry/pinhole_camera.h"
#include "common/geometry/scan_view.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// A side of an occupied voxel that borders on a free one: a piece of surface.
struct Facet {
  VoxelIndex voxel;
  std::uint8_t side = 0;  ///< Index into kFaceNeighbors.

  bool operator==(const Facet&) const = default;
  VoxelIndex before() const { return voxel + kFaceNeighbors[side]; }  ///< The free voxel.
};
inline constexpr std::uint8_t kFacetSides = 6;

/// Remembers which surface was inspected, as facets of the map's occupied voxels.
///
/// A facet's normal is the mean direction of the facets around it that border on the same free space and do
/// not face the other way, so that a staircase of voxels has the normal of the slope that it stands for, and
/// a thin board has two.
///
/// Threading: one thread owns it.
class InspectedSurface {
 public:
  /// Throws std::invalid_argument naming the invalid option.
  /// @param min_measured_share  A facet counts only where at least this share of the image around it has a
  /// depth (MeasuredShares).
  InspectedSurface(const InspectionCriterion& criterion, const PinholeCamera& camera,
                   double min_measured_share);

  void Clear();
  /// Extends the memory to the map's box, and forgets what is no longer occupied.
  void Follow(const PlanningMap& map, std::span<const PlanningMap::StateChange> changes);
  /// Records what a scan inspects.
  void See(const PlanningMap& map, const ScanView& scan);

  /// Whether a camera at `eye_W` could inspect a facet, if it looked there.
  bool InspectableFrom(const PlanningMap& map, const Eigen::Vector3d& eye_W, const Facet& facet);
  /// Whether a facet is still to be inspected: it exists, was not inspected, and is not settled.
  bool Open(const PlanningMap& map, const Facet& facet) const;
  /// All facets that are open and within the map's bounds.
  std::vector<Facet> OpenFacets(const PlanningMap& map) const;
  /// Counts the changes of the map that may matter to a view; what is inspected is none.
  std::uint64_t revision() const { return revision_; }
  /// The blocks (OccupancyGrid::BlockOf) in which the map has changed since a revision.
  std::vector<VoxelIndex> BlocksChangedSince(std::uint64_t revision) const;
  /// [voxels] A change of a voxel changes normals so far away on each axis.
  static constexpr int kChangeReach = 3;
  /// Records that a view was taken to inspect a facet. The second one in vain settles it: it is not open
  /// again.
  void CountTry(const Facet& facet);

  /// Area [m^2] of the surface that borders on free space.
  struct Area {
    double all = 0.0;
    double inspected = 0.0;
  };
  Area MeasureArea(const PlanningMap& map) const;

 private:
  using Normal = Eigen::Vector3f;
  static constexpr int kNormalReach = kChangeReach - 1;  ///< [voxels] A normal is the mean over so many.
  const Normal& NormalOf(const PlanningMap& map, const Facet& facet);
  static std::uint8_t Bit(const Facet& facet) { return static_cast<std::uint8_t>(1U << facet.side); }

  InspectionCriterion criterion_;
  double least_cosine_;
  PinholeCamera camera_;
  double min_measured_share_;
  DenseGrid<std::uint8_t> inspected_;  ///< A bit for each side.
  DenseGrid<std::uint8_t> settled_;    ///< Likewise: open no more, inspected or not.
  DenseGrid<std::uint8_t> tried_;      ///< Likewise: one view was taken for it.
  std::uint64_t revision_ = 0;
  std::unordered_map<VoxelIndex, std::uint64_t, VoxelIndexHash> changed_at_;  ///< Revisions, by block.
  /// Normals of a voxel's sides, once computed; zero = not yet.
  std::unordered_map<VoxelIndex, std::array<Normal, kFacetSides>, VoxelIndexHash> normals_;
};

/// The middle of a facet [m].
Eigen::Vector3d CenterOf(const PlanningMap& map, const Facet& facet);

}  // namespace thalweg::explorer
