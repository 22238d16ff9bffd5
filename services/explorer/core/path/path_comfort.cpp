#include "services/explorer/core/path/path_comfort.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <unordered_map>

#include "common/geometry/polyline.h"
#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;

constexpr double kComfortSampling = 0.5;  // [voxels]

struct TubeVoxel {
  double clearance = 0.0;  ///< [m] to occupied and unknown voxels, as far as it matters
  double cost = std::numeric_limits<double>::infinity();
  VoxelIndex from;
};
using Tube = std::unordered_map<VoxelIndex, TubeVoxel, VoxelIndexHash>;

/// The traversable voxels with centers within `reach` of the path.
Tube TubeAround(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W, double reach,
                double limit) {
  Tube tube;
  const int voxels = static_cast<int>(std::ceil(reach / map.voxel_size()));
  const auto add_about = [&](const Eigen::Vector3d& p_W) {
    ForEachVoxel(CubeAround(map.IndexOf(p_W), voxels), [&](const VoxelIndex& i) {
      const Eigen::Vector3d center_W = map.CenterOf(i);
      if (!map.Traversable(i) || (center_W - p_W).norm() > reach) return;
      const auto [entry, fresh] = tube.try_emplace(i);
      if (fresh) entry->second.clearance = map.ClearanceAt(center_W, Obstacles::kOccupiedAndUnknown, limit);
    });
  };
  add_about(path_W.front());
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    ForEachPointAlong(path_W[n - 1], path_W[n], kComfortSampling * map.voxel_size(),
                      [&](const Eigen::Vector3d& p_W) {
                        add_about(p_W);
                        return true;
                      });
  }
  return tube;
}

/// Dijkstra's algorithm. Returns an empty path when the tube does not connect the two.
std::vector<Eigen::Vector3d> ShortestThrough(const PlanningMap& map, Tube& tube, const VoxelIndex& start,
                                             const VoxelIndex& goal, const PathComfort& options) {
  struct Open {
    double cost;
    VoxelIndex voxel;
    bool operator>(const Open& o) const { return cost > o.cost; }
  };
  const double limit = map.options().clearance + options.distance;
  const auto weight = [&](const TubeVoxel& voxel) {
    return 1.0 + options.price * std::clamp((limit - voxel.clearance) / options.distance, 0.0, 1.0);
  };
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  tube[start].cost = 0.0;
  tube[start].from = start;
  open.push({0.0, start});
  while (!open.empty()) {
    const Open best = open.top();
    open.pop();
    const TubeVoxel here = tube[best.voxel];
    if (best.cost > here.cost) continue;
    if (best.voxel == goal) break;
    ForEachVoxel(CubeAround(best.voxel, 1), [&](const VoxelIndex& next) {
      const auto found = tube.find(next);
      if (found == tube.end()) return;
      const VoxelIndex step = next - best.voxel;
      const double length = map.voxel_size() * std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
      const double cost = here.cost + 0.5 * length * (weight(here) + weight(found->second));
      if (cost >= found->second.cost) return;
      found->second.cost = cost;
      found->second.from = best.voxel;
      open.push({cost, next});
    });
  }
  std::vector<Eigen::Vector3d> path_W;
  if (!std::isfinite(tube[goal].cost)) return path_W;
  for (VoxelIndex at = goal;; at = tube[at].from) {
    path_W.push_back(map.CenterOf(at));
    if (at == start) break;
  }
  std::reverse(path_W.begin(), path_W.end());
  return path_W;
}

}  // namespace

std::vector<Eigen::Vector3d> MakeComfortable(const PlanningMap& map,
                                             const std::vector<Eigen::Vector3d>& path_W,
                                             const PathComfort& options) {
  if (path_W.size() < 2 || !(options.distance > 0.0)) return path_W;
  // A robot that stands too near to an obstacle leaves by the given path; only the rest can be improved.
  const auto first = std::find_if(path_W.begin(), path_W.end(), [&](const Eigen::Vector3d& p_W) {
    return map.Traversable(map.IndexOf(p_W));
  });
  if (path_W.end() - first < 2) return path_W;
  const std::vector<Eigen::Vector3d> rest_W(first, path_W.end());
  const VoxelIndex goal = map.IndexOf(rest_W.back());
  if (!map.Traversable(goal)) return path_W;
  const double limit = map.options().clearance + options.distance;
  Tube tube = TubeAround(map, rest_W, options.reach, limit);
  std::vector<Eigen::Vector3d> new_path_W =
      ShortestThrough(map, tube, map.IndexOf(rest_W.front()), goal, options);
  if (new_path_W.empty()) return path_W;
  new_path_W.front() = rest_W.front();
  new_path_W.back() = rest_W.back();
  if (new_path_W.size() == 1) new_path_W = {rest_W.front(), rest_W.back()};
  new_path_W = PullStraightWithin(map, new_path_W, map.options().clearance, limit);
  new_path_W.insert(new_path_W.begin(), path_W.begin(), first);
  return new_path_W;
}

}  // namespace thalweg::explorer
