#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <unordered_map>
#include <vector>

#include "common/geometry/polyline.h"
#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/map/planning_map.h"
#include "tests/services/explorer/support/random_numbers.h"

/// Seeded random planning maps, and brute-force versions of what the planner computes with them.
namespace thalweg::explorer::test {

/// What most maps and robots in tests have.
inline constexpr double kSize = 0.1;        // [m] edge of a voxel
inline constexpr double kClearance = 0.15;  // [m]
inline constexpr double kLookRange = 3.0;   // [m]

inline constexpr float kFreeLogOdds = -1.0F;
inline constexpr float kOccupiedLogOdds = 1.0F;

inline float LogOddsOf(VoxelState state) {
  return state == VoxelState::kFree       ? kFreeLogOdds
         : state == VoxelState::kOccupied ? kOccupiedLogOdds
                                          : OccupancyGrid::kUnknown;
}

inline VoxelIndex RandomVoxel(std::mt19937& random, const VoxelBox& box) {
  return {RandomInt(random, box.min.x, box.max.x - 1), RandomInt(random, box.min.y, box.max.y - 1),
          RandomInt(random, box.min.z, box.max.z - 1)};
}

inline Eigen::Vector3d RandomPoint(std::mt19937& random, const Eigen::AlignedBox3d& box) {
  return {RandomDouble(random, box.min().x(), box.max().x()),
          RandomDouble(random, box.min().y(), box.max().y()),
          RandomDouble(random, box.min().z(), box.max().z())};
}

using thalweg::ForEachVoxel;

/// Appends the voxels of `box` in `state`; of two changes of a voxel the later one applies.
inline void Fill(std::vector<VoxelChange>& changes, const VoxelBox& box, VoxelState state) {
  ForEachVoxel(box, [&](const VoxelIndex& i) { changes.push_back({i, LogOddsOf(state)}); });
}

inline std::vector<VoxelChange> BoxOf(const VoxelBox& box, VoxelState state) {
  std::vector<VoxelChange> changes;
  Fill(changes, box, state);
  return changes;
}

/// Free space within `box`, with `count` boxes of random edge lengths, half of them occupied and half
/// unknown.
inline std::vector<VoxelChange> RandomScene(std::mt19937& random, const VoxelBox& box, int count,
                                            int max_edge) {
  DenseGrid<VoxelState> states(box, VoxelState::kFree);
  for (int n = 0; n < count; ++n) {
    const VoxelIndex low = RandomVoxel(random, box);
    const VoxelIndex size{RandomInt(random, 1, max_edge), RandomInt(random, 1, max_edge),
                          RandomInt(random, 1, max_edge)};
    const VoxelState state = n % 2 == 0 ? VoxelState::kOccupied : VoxelState::kUnknown;
    ForEachVoxel({low, low + size}, [&](const VoxelIndex& i) {
      if (states.Contains(i)) states[i] = state;
    });
  }
  std::vector<VoxelChange> changes;
  for (std::size_t k = 0; k < states.size(); ++k) {
    if (states[k] != VoxelState::kUnknown) changes.push_back({states.IndexAt(k), LogOddsOf(states[k])});
  }
  return changes;
}

inline std::vector<VoxelIndex> TraversableVoxels(const PlanningMap& map) {
  std::vector<VoxelIndex> voxels;
  ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
    if (map.Traversable(i)) voxels.push_back(i);
  });
  return voxels;
}

/// [m] Distance from a point to the cube of a voxel.
inline double DistanceToVoxel(const Eigen::Vector3d& p_W, const VoxelIndex& i, double size) {
  const Eigen::Vector3d low = Eigen::Vector3d(i.x, i.y, i.z) * size;
  return Eigen::AlignedBox3d(low, low + Eigen::Vector3d::Constant(size)).exteriorDistance(p_W);
}

/// [m] The largest radius that the body may have at p beside an obstacle voxel: the distance to its cube for
/// a sphere, and the definition of PlanningMap::ClearanceAt for a cylinder and on a plane.
inline double RadiusBeside(const PlanningMap& map, const Eigen::Vector3d& p_W, const VoxelIndex& i) {
  const double size = map.voxel_size();
  const double half_height = map.options().half_height;
  if (half_height == 0.0) return DistanceToVoxel(p_W, i, size);
  const double z = map.plane().value_or(p_W.z());
  const double above = std::max({0.0, i.z * size - z, z - (i.z + 1) * size});
  const double aside = DistanceToVoxel({p_W.x(), p_W.y(), (i.z + 0.5) * size}, i, size);
  if (map.plane()) return above < half_height - 1e-9 ? aside : std::numeric_limits<double>::infinity();
  return std::max(aside, above - half_height + map.options().clearance);
}

/// ClearanceAt by testing every voxel around the point.
inline double BruteClearance(const PlanningMap& map, const Eigen::Vector3d& p_W,
                             PlanningMap::Obstacles obstacles, double limit) {
  const double farthest = limit + map.options().half_height;
  const int reach = static_cast<int>(std::ceil(farthest / map.voxel_size())) + 1;
  const VoxelIndex here = map.IndexOf({p_W.x(), p_W.y(), map.plane().value_or(p_W.z())});
  const VoxelIndex by{reach, reach, reach};
  double least = limit;
  ForEachVoxel({here - by, here + by + VoxelIndex{1, 1, 1}}, [&](const VoxelIndex& i) {
    const VoxelState state = map.State(i);
    if (state == VoxelState::kFree) return;
    if (state == VoxelState::kUnknown && obstacles == PlanningMap::Obstacles::kOccupied) return;
    least = std::min(least, RadiusBeside(map, p_W, i));
  });
  return least;
}

/// Least clearance along a path, sampled every 2 mm: too large by at most 1 mm.
inline double SampledClearance(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                               PlanningMap::Obstacles obstacles, double limit) {
  double least = limit;
  for (std::size_t n = 0; n < path_W.size(); ++n) {
    const Eigen::Vector3d& a = path_W[n > 0 ? n - 1 : 0];
    const int pieces = static_cast<int>(std::ceil((path_W[n] - a).norm() / 0.002));
    for (int piece = 0; piece <= pieces; ++piece) {
      const double share = pieces > 0 ? static_cast<double>(piece) / pieces : 0.0;
      least = std::min(least, map.ClearanceAt(a + share * (path_W[n] - a), obstacles, least));
    }
  }
  return least;
}

}  // namespace thalweg::explorer::test
