#include "services/explorer/core/path/way_back.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/path/shut_in.h"

namespace thalweg::explorer {
namespace {

constexpr double kTrackStep = 0.5;     // [voxels] Between places of a track.
constexpr double kMostAside = 0.5;     // [voxels] That a way leads beside it,
constexpr double kAsideStep = 0.05;    // [voxels] and by how much at least.
constexpr double kSpare = 0.05;        // [voxels]
constexpr double kJustTouches = 1e-6;  // [m]
constexpr std::ptrdiff_t kBeyond = 6;  // places of a track: three voxels

/// The place nearest to one on the track at which the body fits with a little to spare for what lies between;
/// that one if there is none.
Eigen::Vector3d Fitting(const PlanningMap& map, const Eigen::Vector3d& p_W, double radius) {
  const double wanted = radius + kSpare * map.voxel_size();
  const auto fits = [&](const Eigen::Vector3d& at_W) {
    return map.ClearanceAt(at_W, PlanningMap::Obstacles::kOccupiedAndUnknown, wanted) >= wanted;
  };
  if (fits(p_W)) return p_W;
  const int up = map.plane() ? 0 : 1;
  for (double aside = kAsideStep; aside <= kMostAside; aside += kAsideStep) {
    std::optional<Eigen::Vector3d> found_W;
    ForEachVoxel({{-1, -1, -up}, {2, 2, up + 1}}, [&](const VoxelIndex& i) {
      const Eigen::Vector3d direction(i.x, i.y, i.z);
      if (direction.isZero()) return true;
      const Eigen::Vector3d at_W = p_W + aside * map.voxel_size() * direction.normalized();
      if (!fits(at_W)) return true;
      found_W = at_W;
      return false;
    });
    if (found_W) return *found_W;
  }
  return p_W;
}

/// Whether the body touches nothing on the path that it does not touch where that begins.
bool Fits(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W, double radius) {
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    if (!map.ClearToLeave(path_W[n - 1], path_W[n], PlanningMap::Obstacles::kOccupiedAndUnknown,
                          radius - kJustTouches))
      return false;
  }
  return true;
}

using Place = std::vector<Eigen::Vector3d>::const_iterator;

/// Paths from where a robot stands, and the place furthest back on its track that one leads to.
struct Reach {
  PathSearch search;
  Place furthest;
};

/// Looks no further back than `last`. The robot must fit where it stands.
Reach ReachOn(const PlanningMap& map, const std::vector<Eigen::Vector3d>& track_W, Place last) {
  Reach reach{.search = {}, .furthest = last};
  reach.search.Flood(map, {{map.IndexOf(track_W.front()), 0}});
  while (!reach.search.Reached(map.IndexOf(*reach.furthest))) --reach.furthest;
  return reach;
}

std::vector<Eigen::Vector3d> PathTo(const Reach& reach, const PlanningMap& map,
                                    const std::vector<Eigen::Vector3d>& track_W) {
  return reach.search.PathFrom(map, track_W.front(), map.IndexOf(*reach.furthest));
}

/// The way from the beginning of a track to a place on it: the shortest path to the last place before it that
/// one leads to, and from there along the track.
std::vector<Eigen::Vector3d> ToTrack(const PlanningMap& map, const std::vector<Eigen::Vector3d>& track_W,
                                     Place place) {
  if (!map.Traversable(map.IndexOf(track_W.front()))) return {track_W.begin(), place + 1};
  const Reach reach = ReachOn(map, track_W, place);
  if (reach.furthest == track_W.begin()) return {track_W.begin(), place + 1};
  std::vector<Eigen::Vector3d> way_W = PathTo(reach, map, track_W);
  way_W.insert(way_W.end(), reach.furthest, place + 1);
  return way_W;
}

}  // namespace

std::vector<Eigen::Vector3d> TrackBack(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                       std::span<const RigidTransform> came) {
  std::vector<Eigen::Vector3d> track_W = {p_W};
  for (const RigidTransform& T_WB : came) {
    Eigen::Vector3d to_W = T_WB.translation();
    if (map.plane()) to_W.z() = *map.plane();
    const Eigen::Vector3d from_W = track_W.back();
    const int steps = static_cast<int>(std::ceil((to_W - from_W).norm() / (kTrackStep * map.voxel_size())));
    for (int n = 1; n <= steps; ++n) track_W.push_back(from_W + (to_W - from_W) * n / steps);
  }
  return track_W;
}

std::optional<ShutTrack> FindShut(const PlanningMap& map, const std::vector<Eigen::Vector3d>& track_W) {
  if (!map.Traversable(map.IndexOf(track_W.front()))) return std::nullopt;
  const Reach reach = ReachOn(map, track_W, track_W.end() - 1);
  const auto further = std::min(track_W.end() - 1 - reach.furthest, kBeyond);
  if (further == 0) return std::nullopt;
  return ShutTrack{PathTo(reach, map, track_W), *(reach.furthest + further)};
}

std::optional<PathSearch> MostOfSpaceOn(const std::vector<Eigen::Vector3d>& track_W, const PlanningMap& map) {
  DenseGrid<std::uint8_t> met(map.box(), 0);
  PathSearch search;
  for (const Eigen::Vector3d& p_W : track_W) {
    const VoxelIndex here = map.IndexOf(p_W);
    if (!map.Traversable(here) || met[here] != 0) continue;
    search.Flood(map, {{here, 0}});
    if (!IsShutIn(map, search)) return search;
    const DenseGrid<std::uint32_t>& costs = search.costs();
    for (std::size_t k = 0; k < costs.size(); ++k) {
      if (costs.data()[k] != PathSearch::kUnreached) met.data()[k] = 1;
    }
  }
  return std::nullopt;
}

std::vector<Eigen::Vector3d> WayBack(const PlanningMap& map, const std::vector<Eigen::Vector3d>& track_W,
                                     double radius, const std::function<bool(const VoxelIndex&)>& leads_on) {
  const auto place = std::ranges::find_if(track_W, [&](const Eigen::Vector3d& p_W) {
    const VoxelIndex i = map.IndexOf(p_W);
    return map.Traversable(i) && leads_on(i);
  });
  if (place == track_W.end()) return {};
  std::vector<Eigen::Vector3d> way_W = ToTrack(map, track_W, place);
  way_W.push_back(map.CenterOf(map.IndexOf(*place)));
  if (!Fits(map, way_W, radius)) {
    for (std::size_t n = 1; n < way_W.size(); ++n) way_W[n] = Fitting(map, way_W[n], radius);
    if (!Fits(map, way_W, radius)) return {};
  }
  return PullStraight(map, way_W, map.options().clearance);
}

}  // namespace thalweg::explorer
