#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// A group of adjacent unknown voxels that border on free space and are worth seeing. Doubtful voxels
/// (DoubtOptions) form clusters of their own.
struct Cluster {
  std::vector<VoxelIndex> unknowns;  ///< Frontier voxels: each has a free face neighbor.
  Eigen::Vector3d center_W;          ///< [m] Mean of the centers of `unknowns`.
  bool doubtful = false;             ///< Its voxels are known, but not with confidence.
  double weight = 1.0;               ///< Value of one of its voxels relative to an unknown one.
};

struct Frontiers {
  std::vector<Cluster> clusters;   ///< In an order that depends on the map only.
  std::size_t small_clusters = 0;  ///< Dropped components of unknown voxels, smaller than the minimum.
  std::size_t small_voxels = 0;
  std::size_t small_doubtful_clusters = 0;
  std::size_t small_doubtful_voxels = 0;
};

struct FrontierOptions {
  double min_area = 0.10;  ///< [m^2] Smaller components are discretization noise.
  double extent = 0.8;     ///< [m] Larger components are split along their longest axis.
};

/// Number of voxels that cover `area` [m^2] side by side; at least one.
std::size_t VoxelsOfArea(double area, double voxel_size);

/// Whether a voxel is a target: within the bounds, unknown or doubtful, and next to free space [Yamauchi: A
/// frontier-based approach for autonomous exploration, CIRA 1997].
bool IsTarget(const PlanningMap& map, const VoxelIndex& i);

/// Groups the target voxels that are not set aside into 26-connected clusters, doubtful ones last.
/// @param set_aside  Over the map's box; nonzero = excluded.
Frontiers FindFrontiers(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside,
                        const FrontierOptions& options);

/// At most `count` of the voxels, at even distances in their order.
std::vector<VoxelIndex> SpreadSample(const std::vector<VoxelIndex>& voxels, std::size_t count);

/// 26-connected components of the given voxels, each in the order in which it was found.
std::vector<std::vector<VoxelIndex>> ConnectedComponents(const std::vector<VoxelIndex>& voxels);

}  // namespace thalweg::explorer
