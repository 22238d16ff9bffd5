#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Unknown voxels that belong together and border on free space: something to go and see. Doubtful ones
/// (DoubtOptions) make clusters of their own.
struct Cluster {
  std::vector<VoxelIndex> unknowns;  ///< Each has a free face neighbour: a frontier voxel.
  Eigen::Vector3d center_W;          ///< [m] mean of the unknowns' centres
  bool doubtful = false;             ///< Its voxels are known, but not for sure.
  double weight = 1.0;               ///< Of one of them, beside an unknown one.
};

struct Frontiers {
  std::vector<Cluster> clusters;   ///< In a fixed order for a given map.
  std::size_t small_clusters = 0;  ///< Dropped: whole components below the minimum, of unknown voxels.
  std::size_t small_voxels = 0;
  std::size_t small_doubtful_clusters = 0;
  std::size_t small_doubtful_voxels = 0;
};

struct FrontierOptions {
  double min_area = 0.10;  ///< [m^2] Smaller components are noise of the discretisation.
  double extent = 0.8;     ///< [m] Larger components are split along their longest axis.
};

/// So many voxels side by side cover `area` [m^2]; at least one.
std::size_t VoxelsOfArea(double area, double voxel_size);

/// Whether an unknown or doubtful voxel within the bounds borders on free space [Yamauchi: A frontier-based
/// approach for autonomous exploration, CIRA 1997].
bool IsTarget(const PlanningMap& map, const VoxelIndex& i);

/// The target voxels that are not set aside, in 26-connected clusters, the doubtful ones last.
/// @param set_aside  Over the map's box; not 0 = leave out.
Frontiers FindFrontiers(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside,
                        const FrontierOptions& options);

/// At most `count` of the voxels, at even distances in their order.
std::vector<VoxelIndex> SpreadSample(const std::vector<VoxelIndex>& voxels, std::size_t count);

/// 26-connected components of the given voxels, each in the order in which it was found.
std::vector<std::vector<VoxelIndex>> ConnectedComponents(const std::vector<VoxelIndex>& voxels);

}  // namespace thalweg::explorer
