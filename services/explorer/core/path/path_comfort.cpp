#include "services/explorer/core/path/path_comfort.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <unordered_map>
#include <unordered_set>

#include "common/geometry/polyline.h"
#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;

constexpr double kComfortSampling = 0.5;  // [voxels]
constexpr double kJustAsWide = 1e-9;      // [m]

/// Points in a cubic lattice.
struct Lattice {
  double spacing = 0.0;  ///< [m]
  double offset = 0.0;   ///< [spacings] Distance of the first point from the origin, on each axis.

  Eigen::Vector3d PointAt(const VoxelIndex& i) const {
    return spacing * (Eigen::Vector3d(i.x, i.y, i.z).array() + offset).matrix();
  }
  VoxelIndex NearestTo(const Eigen::Vector3d& p_W) const {
    return VoxelAt(p_W + Eigen::Vector3d::Constant((0.5 - offset) * spacing), spacing);
  }
};
Lattice CentersOf(const PlanningMap& map) {
  return {map.voxel_size(), 0.5};
}
Lattice HalvesOf(const PlanningMap& map) {
  return {0.5 * map.voxel_size(), 0.0};
}

struct TubePoint {
  double clearance = 0.0;  ///< [m] to occupied and unknown voxels, as far as it matters
  double cost = std::numeric_limits<double>::infinity();
  VoxelIndex from;
};
/// Points of a lattice near a path where the body may be.
using Tube = std::unordered_map<VoxelIndex, TubePoint, VoxelIndexHash>;

/// The points within `reach` of the path. @param clearance  [m] double(index of a point, point), negative
/// where the body must not be.
template <class Clearance>
Tube TubeAround(const PlanningMap& map, const Lattice& lattice, const std::vector<Eigen::Vector3d>& path_W,
                double reach, Clearance&& clearance) {
  Tube tube;
  std::unordered_set<VoxelIndex, VoxelIndexHash> tried;
  const int around = static_cast<int>(std::ceil(reach / lattice.spacing));
  const auto add_about = [&](const Eigen::Vector3d& p_W) {
    const VoxelIndex middle = lattice.NearestTo(p_W);
    ForEachVoxel(CubeAround(middle, around), [&](const VoxelIndex& i) {
      if (map.plane() && i.z != middle.z) return;
      const Eigen::Vector3d point_W = lattice.PointAt(i);
      if ((point_W - p_W).norm() > reach || !tried.insert(i).second) return;
      const double its = clearance(i, point_W);
      if (its >= 0.0) tube[i].clearance = its;
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
/// @param limit  [m] Clearance beyond which more is of no use.
std::vector<Eigen::Vector3d> ShortestThrough(const Lattice& lattice, Tube& tube, const VoxelIndex& start,
                                             const VoxelIndex& goal, double limit,
                                             const PathComfort& options) {
  struct Open {
    double cost;
    VoxelIndex at;
    bool operator>(const Open& o) const { return cost > o.cost; }
  };
  const auto weight = [&](const TubePoint& point) {
    if (options.distance == 0.0) return 1.0;
    return 1.0 + options.price * std::clamp((limit - point.clearance) / options.distance, 0.0, 1.0);
  };
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  tube[start].cost = 0.0;
  tube[start].from = start;
  open.push({0.0, start});
  while (!open.empty()) {
    const Open best = open.top();
    open.pop();
    const TubePoint here = tube[best.at];
    if (best.cost > here.cost) continue;
    if (best.at == goal) break;
    ForEachVoxel(CubeAround(best.at, 1), [&](const VoxelIndex& next) {
      const auto found = tube.find(next);
      if (found == tube.end()) return;
      const VoxelIndex step = next - best.at;
      const double length = lattice.spacing * std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
      const double cost = here.cost + 0.5 * length * (weight(here) + weight(found->second));
      if (cost >= found->second.cost) return;
      found->second.cost = cost;
      found->second.from = best.at;
      open.push({cost, next});
    });
  }
  std::vector<Eigen::Vector3d> path_W;
  if (!std::isfinite(tube[goal].cost)) return path_W;
  for (VoxelIndex at = goal;; at = tube[at].from) {
    path_W.push_back(lattice.PointAt(at));
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
  Tube tube = TubeAround(
      map, CentersOf(map), rest_W, options.reach, [&](const VoxelIndex& i, const Eigen::Vector3d& center_W) {
        return map.Traversable(i) ? map.ClearanceAt(center_W, Obstacles::kOccupiedAndUnknown, limit) : -1.0;
      });
  std::vector<Eigen::Vector3d> new_path_W =
      ShortestThrough(CentersOf(map), tube, map.IndexOf(rest_W.front()), goal, limit, options);
  if (new_path_W.empty()) return path_W;
  new_path_W.front() = rest_W.front();
  new_path_W.back() = rest_W.back();
  if (new_path_W.size() == 1) new_path_W = {rest_W.front(), rest_W.back()};
  new_path_W = PullStraightWithin(map, new_path_W, map.options().clearance, limit);
  new_path_W.insert(new_path_W.begin(), path_W.begin(), first);
  return new_path_W;
}

std::vector<Eigen::Vector3d> FindWiderPath(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                           double clearance, const PathComfort& options) {
  const auto first = std::find_if(path_W.begin(), path_W.end(), [&](const Eigen::Vector3d& p_W) {
    return map.Traversable(map.IndexOf(p_W));
  });
  if (first == path_W.end()) return {};
  const std::vector<Eigen::Vector3d> rest_W(first, path_W.end());
  const Lattice lattice = HalvesOf(map);
  const double limit = clearance + options.distance;
  Tube tube =
      TubeAround(map, lattice, rest_W, options.reach, [&](const VoxelIndex&, const Eigen::Vector3d& p_W) {
        if (!map.bounds().Contains(map.IndexOf(p_W))) return -1.0;
        const double its = map.ClearanceAt(p_W, Obstacles::kOccupiedAndUnknown, limit);
        return its < clearance - kJustAsWide ? -1.0 : its;
      });
  const VoxelIndex start = lattice.NearestTo(map.CenterOf(map.IndexOf(rest_W.front())));
  const VoxelIndex wanted = lattice.NearestTo(rest_W.back());
  std::optional<VoxelIndex> goal;
  ForEachVoxel(CubeAround(wanted, 1), [&](const VoxelIndex& i) {
    if (tube.contains(i) && (!goal || i == wanted)) goal = i;
  });
  if (!goal) return {};
  std::vector<Eigen::Vector3d> new_path_W = ShortestThrough(lattice, tube, start, *goal, limit, options);
  if (new_path_W.empty()) return {};
  new_path_W.insert(new_path_W.begin(), path_W.begin(), first + 1);
  return PullStraightWithin(map, new_path_W, clearance, limit);
}

}  // namespace thalweg::explorer
