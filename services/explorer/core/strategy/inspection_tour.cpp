#include "services/explorer/core/strategy/inspection_tour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/voxel/grid_order.h"
#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/path/coarse_map.h"
#include "services/explorer/core/path/rough_distances.h"
#include "services/explorer/core/strategy/cover_tour.h"
#include "services/explorer/core/strategy/stops.h"

namespace thalweg::explorer {
namespace {

constexpr int kPatchBits = 2;  // A patch lies in a cube of 4 voxels.
constexpr double kFrontierPrice =
    0.5;  // [m/m] Path that a frontier is worth for each meter it is seen earlier.
constexpr double kTourHysteresis = 0.02;
constexpr double kTourIterations = 4.0;  // Made by the search for tours of up to kManyStops stops;
constexpr std::size_t kManyStops = 50;   // fewer for longer ones.

/// Facets of one side that lie together.
struct Patch {
  Facet middle;
  std::size_t facets = 0;
};

std::vector<Patch> PatchesOf(const std::vector<Facet>& open, const PlanningMap& map) {
  using Sides = std::array<std::vector<Facet>, kFacetSides>;
  std::map<VoxelIndex, Sides, GridOrder> cubes;
  for (const Facet& facet : open) {
    const VoxelIndex& i = facet.voxel;
    cubes[{i.x >> kPatchBits, i.y >> kPatchBits, i.z >> kPatchBits}][facet.side].push_back(facet);
  }
  std::vector<Patch> patches;
  for (const auto& [cube, sides] : cubes) {
    for (const std::vector<Facet>& facets : sides) {
      if (facets.empty()) continue;
      Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();
      for (const Facet& facet : facets) mean_W += CenterOf(map, facet);
      mean_W /= static_cast<double>(facets.size());
      const Facet middle = *std::ranges::min_element(
          facets, {}, [&](const Facet& facet) { return (CenterOf(map, facet) - mean_W).squaredNorm(); });
      patches.push_back({middle, facets.size()});
    }
  }
  return patches;
}

/// Where the tour may stop, and the items that are covered there.
struct TourStops {
  std::vector<VoxelIndex> places;
  std::vector<std::vector<std::size_t>> items;
};

/// @param robot  Where it stands, which is no stop: what a turn there does not repay stays.
TourStops StopsInspecting(const std::vector<Patch>& patches, const InspectionViews& views,
                          const PathSearch& search, const VoxelIndex& robot) {
  NearIndex near(views.reach());
  for (std::size_t n = 0; n < patches.size(); ++n) near.Add(patches[n].middle.voxel, n);
  TourStops stops;
  for (const VoxelIndex& place : PlacesToLook(search)) {
    if (place == robot) continue;
    std::vector<std::size_t> items;
    for (const std::size_t n : near.Near(views.map().EyeOf(place))) {
      if (views.CanInspect(place, patches[n].middle)) items.push_back(n);
    }
    if (items.empty()) continue;
    stops.places.push_back(place);
    stops.items.push_back(std::move(items));
  }
  return stops;
}

}  // namespace

InspectionTour::InspectionTour(const InspectionOptions& options) : options_(options) {
  if (!(options.min_area >= 0.0)) throw std::invalid_argument("surface.min_area must be >= 0");
  if (!(options.least_strip >= 0.0)) throw std::invalid_argument("surface.least_strip must be >= 0");
  if (!(options.eagerness >= 0.0)) throw std::invalid_argument("surface.eagerness must be >= 0");
  if (!(options.stop_cost > 0.0)) throw std::invalid_argument("surface.stop_cost must be > 0");
}

std::optional<InspectionView> InspectionTour::Next(const InspectionViews& views, const PathSearch& search,
                                                   const RigidTransform& T_WB,
                                                   const std::optional<VoxelIndex>& frontier) {
  const PlanningMap& map = views.map();
  const VoxelIndex robot = map.IndexOf(T_WB.translation());
  if (search.Reached(robot)) {
    const std::size_t enough = std::max<std::size_t>(1, VoxelsOfArea(options_.min_area, map.voxel_size()));
    if (auto here = views.Best(robot, T_WB.linear(), enough)) return here;
  }
  const std::vector<Patch> patches = PatchesOf(views.open(), map);
  TourStops stops = StopsInspecting(patches, views, search, robot);
  if (stops.places.empty()) return std::nullopt;
  std::size_t frontier_stop = stops.places.size();  // none
  if (frontier && search.Reached(*frontier)) {
    stops.places.push_back(*frontier);
    stops.items.push_back({patches.size()});
  }

  CoverProblem problem{.from_start = {},
                       .delay_price = {},
                       .worth = {},
                       .seen = BitTable(stops.places.size(), patches.size() + 1),
                       .sees = [](std::size_t, std::size_t) { return true; },
                       .distances = {}};
  for (std::size_t n = 0; n < stops.places.size(); ++n) {
    problem.from_start.push_back(search.Length(stops.places[n]) + options_.stop_cost);
    for (const std::size_t item : stops.items[n]) problem.seen.Set(n, item);
  }
  const double face = map.voxel_size() * map.voxel_size();                  // [m^2]
  const double strip = options_.least_strip * options_.criterion.distance;  // [m]
  const double per_facet = options_.eagerness / static_cast<double>(views.open().size());
  constexpr double kAny = std::numeric_limits<double>::infinity();
  for (const Patch& patch : patches) {
    const auto facets = static_cast<double>(patch.facets);
    problem.delay_price.push_back(per_facet * facets);
    problem.worth.push_back(strip > 0.0 ? facets * face / strip : kAny);
  }
  problem.delay_price.push_back(kFrontierPrice);
  problem.worth.push_back(kAny);
  CoarseMap coarse(map, search);
  RoughDistances distances(coarse, stops.places);
  problem.distances = [&](std::size_t stop) {
    std::vector<double> lengths = distances.From(stop);
    for (double& length : lengths) length += options_.stop_cost;
    return lengths;
  };

  CoverTourSearch tours(std::move(problem));
  const Tour former = tours.Completed(
      TourAsBefore(formers_W_, stops.places.size(), [&](const Eigen::Vector3d& p_W, std::size_t stop) {
        return (map.CenterOf(stops.places[stop]) - p_W).norm();
      }));
  const double length = static_cast<double>(std::max(former.size(), kManyStops)) / kManyStops;
  Tour tour = tours.Improved(former, static_cast<int>(std::ceil(kTourIterations / (length * length))));
  if (tours.Cost(former) <= (1.0 + kTourHysteresis) * tours.Cost(tour)) tour = former;
  tour = tours.WorthItsPath(std::move(tour));
  formers_W_.clear();
  for (const std::size_t stop : tour) formers_W_.push_back(map.CenterOf(stops.places[stop]));
  if (tour.empty() || tour.front() == frontier_stop) return std::nullopt;
  const VoxelIndex& place = stops.places[tour.front()];
  std::optional<InspectionView> view = views.Best(place, T_WB.linear(), 1);
  if (view) view->length = search.Length(place);
  return view;
}

}  // namespace thalweg::explorer
