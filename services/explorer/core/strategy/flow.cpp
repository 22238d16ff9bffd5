#include "services/explorer/core/strategy/flow.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "services/explorer/core/strategy/stops.h"
#include "services/explorer/core/strategy/viewpoints.h"

namespace thalweg::explorer {
namespace {

// A stop takes the candidates within a radius of its first one. The radius grows with the path length.
constexpr double kStopRadius = 0.3;  // [m] At least.
constexpr double kStopShare = 0.2;   // Share of the path length; larger while there are more than kMostStops.
constexpr std::size_t kMostStops = 40;  // Limits the cost of planning the tour.

}  // namespace

void Visit(OptionVisitor& visitor, Flow::Options& options) {
  visitor.Block("flow", [&](OptionVisitor& flow) {
    flow.Number("eagerness", options.eagerness);
    flow.Number("hysteresis", options.hysteresis);
    flow.Number("sight_worth_m_per_m2", options.sight_worth);
  });
}

std::vector<Flow::Stop> Flow::MakeStops(const Situation& situation) const {
  std::vector<std::size_t> order(situation.candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return situation.candidates[a].length < situation.candidates[b].length;
  });
  for (double share = kStopShare;; share *= 1.5) {
    std::vector<Stop> stops;
    for (const std::size_t n : order) {
      const VoxelIndex& place = situation.candidates[n].goals.front();
      const double radius = std::max(kStopRadius, share * situation.search.Length(place));
      const auto near = std::find_if(stops.begin(), stops.end(), [&](const Stop& stop) {
        const Eigen::Vector3d p_W = situation.map.CenterOf(place);
        const Eigen::Vector3d q_W = situation.map.CenterOf(stop.place);
        return (p_W - q_W).norm() <= radius && situation.map.InSight(p_W, q_W);
      });
      if (near == stops.end()) {
        stops.push_back({.candidates = {n}, .place = place});
      } else {
        near->candidates.push_back(n);
      }
    }
    if (stops.size() <= kMostStops || share > 4.0) return stops;
  }
}

Tour Flow::AsBefore(const Situation& situation, const std::vector<Stop>& stops,
                    const TourProblem& problem) const {
  std::vector<std::size_t> when(stops.size(), former_W_.size());
  for (std::size_t n = 0; n < stops.size(); ++n) {
    const Eigen::Vector3d p_W = situation.map.CenterOf(stops[n].place);
    double nearest = kSameStop;
    for (std::size_t m = 0; m < former_W_.size(); ++m) {
      const double distance = (former_W_[m] - p_W).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      when[n] = m;
    }
  }
  Tour known;
  Tour fresh;
  for (std::size_t n = 0; n < stops.size(); ++n) (when[n] < former_W_.size() ? known : fresh).push_back(n);
  std::stable_sort(known.begin(), known.end(),
                   [&](std::size_t a, std::size_t b) { return when[a] < when[b]; });
  for (const std::size_t n : fresh) {
    Tour best;
    for (std::size_t at = 0; at <= known.size(); ++at) {
      Tour with = known;
      with.insert(with.begin() + static_cast<std::ptrdiff_t>(at), n);
      if (best.empty() || TourCost(problem, with) < TourCost(problem, best)) best = std::move(with);
    }
    known = std::move(best);
  }
  return known;
}

Choice Flow::SeeMost(const Situation& situation, CoarseMap& coarse, const std::vector<Stop>& stops,
                     const TourProblem& problem, const Tour& tour) {
  const std::size_t first = stops[tour.front()].candidates.front();
  Viewpoints viewpoints(situation);
  const std::vector<VoxelIndex> crossed = viewpoints.PlacesBefore(first);
  if (tour.size() > 1) {
    std::vector<VoxelIndex> wanted = crossed;
    wanted.push_back(situation.candidates[first].goals.front());
    onward_.Flood(situation.map, {{stops[tour[1]].place, 0}}, wanted);
  }
  const std::vector<VoxelIndex> places = viewpoints.PlacesFor(first, crossed, [&](const VoxelIndex& place) {
    const std::uint32_t cost = situation.search.Cost(place);
    if (tour.size() == 1) return cost;
    return onward_.Reached(place) ? cost + onward_.Cost(place) : PathSearch::kUnreached;
  });
  std::vector<std::vector<double>> distances(stops.size());  // [m] From a stop to all places, once needed.
  const auto distance = [&](std::size_t place, std::size_t stop) {
    if (tour.size() > 1 && stop == tour[1]) return onward_.Length(places[place]);
    if (distances[stop].empty()) distances[stop] = coarse.DistancesFrom(stops[stop].place, places);
    return distances[stop][place];
  };

  const double face = situation.map.voxel_size() * situation.map.voxel_size();  // [m^2]
  const auto worth_of = [&](std::size_t candidate) {
    return options_.sight_worth * face * WeightOf(situation.candidates[candidate].cluster);
  };

  TourProblem then = problem;  // Its from_start applies to the rest of the tour.
  double least_cost = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  std::vector<std::size_t> seen_from_best;
  for (std::size_t place = 0; place < places.size(); ++place) {
    const double length = situation.search.Length(places[place]);
    double cost = 0.0;
    std::vector<std::size_t> seen;
    Tour rest;
    for (const std::size_t stop : tour) {
      const std::vector<std::size_t>& candidates = stops[stop].candidates;
      const std::size_t before = seen.size();
      std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(seen),
                   [&](std::size_t n) { return viewpoints.SeesEnough(places[place], n); });
      if (seen.size() - before == candidates.size()) {
        cost += problem.delay_price[stop] * length;
      } else {
        rest.push_back(stop);
        for (std::size_t n = before; n < seen.size(); ++n) cost -= worth_of(seen[n]);
      }
    }
    if (!rest.empty()) then.from_start[rest.front()] = length + distance(place, rest.front());
    cost += rest.empty() ? length : TourCost(then, rest);
    if (cost >= least_cost) continue;
    least_cost = cost;
    best = place;
    seen_from_best = std::move(seen);
  }

  Choice choice{.candidate = first, .path_W = ShortestPath(situation, places[best])};
  for (const std::size_t n : seen_from_best) {
    const std::vector<VoxelIndex>& unknowns = situation.candidates[n].cluster.unknowns;
    choice.target.insert(choice.target.end(), unknowns.begin(), unknowns.end());
  }
  return choice;
}

Choice Flow::Choose(const Situation& situation) {
  std::vector<Stop> stops = MakeStops(situation);
  CoarseMap coarse(situation.map, situation.search);
  const std::vector<double> behind = WorthBehind(situation, coarse);

  double all = static_cast<double>(coarse.known_voxels());
  for (Stop& stop : stops) {
    for (const std::size_t n : stop.candidates) {
      stop.weight += WeightOf(situation.candidates[n].cluster) + behind[n];
    }
    all += stop.weight;
  }
  TourProblem problem;
  std::vector<VoxelIndex> places;
  for (const Stop& stop : stops) {
    places.push_back(stop.place);
    problem.from_start.push_back(situation.search.Length(stop.place));
    problem.delay_price.push_back(options_.eagerness * stop.weight / all);
  }
  problem.distance = coarse.Distances(places);
  Tour tour = ImprovedTour(problem, NearestNeighborTour(problem));
  if (!former_W_.empty()) {
    Tour as_before = AsBefore(situation, stops, problem);
    if (TourCost(problem, as_before) <= (1.0 + options_.hysteresis) * TourCost(problem, tour))
      tour = as_before;
  }
  former_W_.clear();
  for (const std::size_t n : tour) former_W_.push_back(situation.map.CenterOf(stops[n].place));
  return SeeMost(situation, coarse, stops, problem, tour);
}

}  // namespace thalweg::explorer
