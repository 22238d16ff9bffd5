#include "services/explorer/core/view/inspection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/map/frontier.h"

namespace thalweg::explorer {
namespace {

constexpr int kCellBits = 2;
constexpr int kCell = 1 << kCellBits;  ///< [voxels] One place is tried in each cube of this side.

VoxelIndex CellOf(const VoxelIndex& i) {
  return {i.x >> kCellBits, i.y >> kCellBits, i.z >> kCellBits};
}

struct Place {
  VoxelIndex voxel;
  double length = 0.0;  ///< [m]
};

/// One reached voxel in each cell, and the robot's own.
std::vector<Place> PlacesToTry(const PathSearch& search, const VoxelIndex& robot, double max_length) {
  struct Nearest {
    VoxelIndex voxel;
    int off = std::numeric_limits<int>::max();  ///< Squared distance from the cell's middle, in half voxels.
  };
  std::unordered_map<VoxelIndex, Nearest, VoxelIndexHash> cells;
  ForEachVoxel(search.costs().box(), [&](const VoxelIndex& i) {
    if (search.costs()[i] == PathSearch::kUnreached) return;
    const VoxelIndex cell = CellOf(i);
    const auto off_on = [](int v, int of) { return 2 * (v - of * kCell) + 1 - kCell; };
    const VoxelIndex off{off_on(i.x, cell.x), off_on(i.y, cell.y), off_on(i.z, cell.z)};
    Nearest& nearest = cells[cell];
    const int squared = off.x * off.x + off.y * off.y + off.z * off.z;
    if (squared < nearest.off) nearest = {i, squared};
  });
  std::vector<Place> places;
  places.reserve(cells.size() + 1);
  if (search.Reached(robot)) places.push_back({robot, 0.0});
  for (const auto& [cell, nearest] : cells) {
    const double length = search.Length(nearest.voxel);
    if (length <= max_length) places.push_back({nearest.voxel, length});
  }
  return places;
}

/// Facets sorted by blocks, so that those near a place are found soon.
class FacetBlocks {
 public:
  /// @param reach  [voxels] What counts as near.
  FacetBlocks(const std::vector<Facet>& facets, int reach) : reach_(reach) {
    for (const Facet& facet : facets) blocks_[OccupancyGrid::BlockOf(facet.voxel)].push_back(facet);
  }
  /// Calls visit(facets) for each block that has a voxel near a voxel.
  template <class Visitor>
  void ForEachNear(const VoxelIndex& i, Visitor&& visit) const {
    const VoxelIndex reach{reach_, reach_, reach_};
    const VoxelBox near{OccupancyGrid::BlockOf(i - reach),
                        OccupancyGrid::BlockOf(i + reach) + VoxelIndex{1, 1, 1}};
    ForEachVoxel(near, [&](const VoxelIndex& block) {
      const auto found = blocks_.find(block);
      if (found != blocks_.end()) visit(found->second);
    });
  }
  /// No fewer than the facets near a voxel.
  std::size_t CountNear(const VoxelIndex& i) const {
    std::size_t count = 0;
    ForEachNear(i, [&](const std::vector<Facet>& facets) { count += facets.size(); });
    return count;
  }

 private:
  int reach_;
  std::unordered_map<VoxelIndex, std::vector<Facet>, VoxelIndexHash> blocks_;
};

}  // namespace

void InspectionPlanner::ForgetChanged(const PlanningMap& map, const InspectedSurface& surface) {
  const std::vector<VoxelIndex> changed =
      surface.BlocksChangedSince(std::exchange(revision_, surface.revision()));
  if (changed.empty()) return;
  const int reach = static_cast<int>(std::ceil(options_.criterion.distance / map.voxel_size())) +
                    InspectedSurface::kChangeReach;
  std::unordered_set<VoxelIndex, VoxelIndexHash> near;  // blocks that hold places within reach
  const int blocks = reach / OccupancyGrid::kBlockEdge + 1;
  for (const VoxelIndex& block : changed) {
    ForEachVoxel(CubeAround(block, blocks), [&](const VoxelIndex& other) { near.insert(other); });
  }
  std::erase_if(bounds_,
                [&](const auto& known) { return near.contains(OccupancyGrid::BlockOf(known.first)); });
}

std::optional<InspectionView> InspectionPlanner::Best(const PlanningMap& map, const PathSearch& search,
                                                      const ViewPlanner& views, const RigidTransform& T_WB,
                                                      double max_length, InspectedSurface& surface) {
  ForgetChanged(map, surface);
  const double voxel = map.voxel_size();
  const FacetBlocks open(surface.OpenFacets(map),
                         static_cast<int>(std::ceil(options_.criterion.distance / voxel)));
  const std::size_t enough = VoxelsOfArea(options_.min_area, voxel);
  struct Bounded {
    Place place;
    VoxelIndex eye;
    double worth;  // at most
  };
  const auto worth_of = [&](std::size_t facets, const Place& place) {
    return facets < enough ? 0.0 : static_cast<double>(facets) / (place.length + options_.stop_cost);
  };
  std::vector<Bounded> places;
  for (const Place& place : PlacesToTry(search, map.IndexOf(T_WB.translation()), max_length)) {
    const VoxelIndex eye = map.EyeOf(place.voxel);
    const auto known = bounds_.find(eye);
    const std::size_t bound = known != bounds_.end() ? known->second : open.CountNear(eye);
    if (const double worth = worth_of(bound, place); worth > 0.0) places.push_back({place, eye, worth});
  }
  // The robot's own place first, then by worth.
  std::ranges::sort(places, [](const Bounded& a, const Bounded& b) {
    if ((a.place.length == 0.0) != (b.place.length == 0.0)) return a.place.length == 0.0;
    return std::tuple(-a.worth, a.eye.z, a.eye.y, a.eye.x) < std::tuple(-b.worth, b.eye.z, b.eye.y, b.eye.x);
  });
  std::optional<InspectionView> best;
  double best_worth = 0.0;
  for (const Bounded& tried : places) {
    if (tried.worth <= best_worth) break;
    const Eigen::Vector3d eye_W = map.CenterOf(tried.eye);
    std::vector<Facet> facets;
    std::vector<Sighting> sightings;
    open.ForEachNear(tried.eye, [&](const std::vector<Facet>& near) {
      for (const Facet& facet : near) {
        if (!surface.InspectableFrom(map, eye_W, facet)) continue;
        const Sighting sighting{facet.voxel, CenterOf(map, facet) - eye_W};
        if (!views.CanShow(sighting.offset_W)) continue;
        facets.push_back(facet);
        sightings.push_back(sighting);
      }
    });
    std::size_t& bound = bounds_[tried.eye];
    bound = facets.size();
    if (worth_of(bound, tried.place) <= best_worth) continue;
    const View view = views.Best(sightings, std::vector<bool>(sightings.size(), true), {}, T_WB.linear());
    if (view.count < enough) {
      bound = 0;
      continue;
    }
    best_worth = worth_of(bound, tried.place);
    best = InspectionView{
        .place = tried.place.voxel, .R_WB = view.R_WB, .facets = {}, .length = tried.place.length};
    for (std::size_t n = 0; n < facets.size(); ++n) {
      if (views.Shows(view.R_WB, sightings[n])) best->facets.push_back(facets[n]);
    }
    if (tried.place.length == 0.0) break;  // what can be inspected from here costs no path
  }
  return best;
}

}  // namespace thalweg::explorer
