#include "services/explorer/core/tight_ways.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_set>
#include <utility>

#include "services/explorer/core/path/path_comfort.h"
#include "services/explorer/core/unseen.h"

namespace thalweg::explorer {
namespace {

constexpr double kOneTightWay = 1.0;  // [m] Places nearer to each other than this are of one way.
constexpr double kBefore = 1.0;       // [m] This much of the path before a gap is planned with it.
constexpr double kToTheMiddle = 1.0;  // [voxels] A path through it is wider by this, where it can be.
constexpr double kAside = 2.0;        // [voxels] Off the path from voxel to voxel.
constexpr double kOut = 1.0;          // [m] As far as a robot that is shut in may go straight.
constexpr double kSlimmest = 0.01;    // [voxels] Bodies below this block nothing.
constexpr int kTries = 4;             // Paths searched for by one way, to different clusters.

/// The path to something unseen, on which the body keeps `clearance`; empty if there is none.
std::vector<Eigen::Vector3d> WiderPathTo(const Unseen& unseen, const PathSearch& search,
                                         const Eigen::Vector3d& robot_W, const PlanningMap& map,
                                         double clearance) {
  std::vector<Eigen::Vector3d> path_W = search.PathFrom(map, robot_W, unseen.path.front());
  // What follows is planned again.
  const auto again = std::min(std::ssize(path_W) - 1, std::lround(kBefore / map.voxel_size()));
  std::vector<Eigen::Vector3d> fine_W(path_W.end() - again, path_W.end());
  path_W.resize(path_W.size() - fine_W.size());
  for (std::size_t n = 1; n < unseen.path.size(); ++n) fine_W.push_back(map.CenterOf(unseen.path[n]));
  const std::vector<Eigen::Vector3d> wider_W =
      FindWiderPath(map, fine_W, clearance,
                    {.distance = kToTheMiddle * map.voxel_size(), .reach = kAside * map.voxel_size()});
  if (wider_W.empty()) return {};
  path_W.push_back(wider_W.front());
  path_W = PullStraight(map, path_W, map.options().clearance);
  path_W.insert(path_W.end(), wider_W.begin() + 1, wider_W.end());
  return path_W;
}

}  // namespace

std::vector<TightWay> FindTightWays(const Knowledge& knowledge, const PathSearch& search,
                                    const Eigen::Vector3d& robot_W, double radius, const GoalFinder& goals,
                                    double extent) {
  const PlanningMap& map = knowledge.map();
  struct Way {
    TightWay way;
    bool fits = false;  ///< The body without its margin.
    int tries = 0;      ///< Paths that were searched for.
  };
  std::vector<Way> ways;
  const auto way_at = [&](const Eigen::Vector3d& place_W) -> Way& {
    const auto near = [&](const Way& its) { return (its.way.place_W - place_W).norm() < kOneTightWay; };
    const auto found = std::ranges::find_if(ways, near);
    return found != ways.end() ? *found : ways.emplace_back(Way{.way = {.place_W = place_W}});
  };
  const auto try_by = [&](const Unseen& unseen, Way& its) {
    const auto path = [&](double clearance) { return WiderPathTo(unseen, search, robot_W, map, clearance); };
    ++its.tries;
    std::vector<Eigen::Vector3d> path_W = path(map.options().clearance);
    its.fits = its.fits || !path_W.empty() || !path(radius).empty();
    // From where it ends the robot must be able to go on.
    if (path_W.empty() || PathSearch::StartAt(map, path_W.back(), radius, {kOut}).empty()) return;
    its.way.path_W = std::move(path_W);
    its.way.nearest = unseen.cluster;
  };
  std::unordered_set<VoxelIndex, VoxelIndexHash> counted;
  // A body that fits somewhere has less space at the center of the voxel that is nearest.
  for (const double assumed : {radius, radius - 0.5 * map.voxel_size()}) {
    if (assumed < kSlimmest * map.voxel_size() || assumed >= map.options().clearance) continue;
    if (std::ranges::any_of(ways, [](const Way& its) { return !its.way.path_W.empty(); })) break;
    const PlanningMap other = map.WithClearance(assumed);
    for (const Unseen& unseen : FindUnseen(other, knowledge, search, goals, extent)) {
      const std::optional<VoxelIndex> bar = unseen.Bar();
      if (!bar) continue;
      Way& its = way_at(map.CenterOf(*bar));
      if (its.way.path_W.empty() && its.tries < kTries) try_by(unseen, its);
      for (const VoxelIndex& i : unseen.cluster.unknowns) {
        if (counted.insert(i).second) its.way.area += map.voxel_size() * map.voxel_size();
      }
    }
  }
  std::vector<TightWay> found;
  for (Way& way : ways) {
    if (way.fits) found.push_back(std::move(way.way));
  }
  return found;
}

}  // namespace thalweg::explorer
