#include "services/explorer/core/strategy/cover.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/voxel/ray.h"
#include "services/explorer/core/path/coarse_map.h"
#include "services/explorer/core/path/rough_distances.h"
#include "services/explorer/core/strategy/cover_tour.h"
#include "services/explorer/core/strategy/stop_prices.h"
#include "services/explorer/core/strategy/stops.h"

namespace thalweg::explorer {
namespace {

constexpr double kLeastLook = 0.1;  // [m^2] That a turn on the spot shows.
constexpr double kApart = 0.25;     // [m] A look from nearer than this to the last one is no other look.
constexpr double kHalfTurn = 1.0;   // [m] A view turned by 180 degrees counts as moved by this.
constexpr std::size_t kLatticeRays = 100;
constexpr double kIterations = 10.0;   // Made by the search for tours of up to kLongTour stops;
constexpr std::size_t kLongTour = 50;  // [stops] fewer for longer ones.

/// [voxels] The weight of each cluster, and of the unknown region behind it; and the sum with what is known.
struct Weights {
  std::vector<double> of;
  double all = 0.0;
};

Weights WeightsOf(const Situation& situation, const CoarseMap& coarse) {
  Weights weights{.of = WorthBehind(situation, coarse), .all = static_cast<double>(coarse.known_voxels())};
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    weights.of[n] += WeightOf(situation.candidates[n].cluster);
    weights.all += weights.of[n];
  }
  return weights;
}

/// [m] How far a stop is from one of the previous tour, by its position and its view.
double Distance(const CoverStop& stop, const Cover::FormerStop& former, const Situation& situation) {
  const double moved = (PositionOf(stop, situation) - former.p_W).norm();
  if (!stop.R_WB || !former.R_WB) return moved;
  return moved + 0.5 * kHalfTurn * (stop.R_WB->col(0) - former.R_WB->col(0)).norm();
}

/// Path lengths between the places of stops, of which several may be at one place.
class Places {
 public:
  Places(CoarseMap& coarse, const std::vector<CoverStop>& stops) : distances_(coarse, Number(stops)) {
    from_.resize(count_);
  }
  /// [m] From a stop to each.
  std::vector<double> From(std::size_t stop) {
    std::vector<double>& from = from_[place_of_[stop]];
    if (from.empty()) from = distances_.From(place_of_[stop]);
    std::vector<double> lengths;
    lengths.reserve(place_of_.size());
    for (const std::size_t place : place_of_) lengths.push_back(from[place]);
    return lengths;
  }

 private:
  std::vector<VoxelIndex> Number(const std::vector<CoverStop>& stops) {
    std::map<VoxelIndex, std::size_t, GridOrder> numbers;
    std::vector<VoxelIndex> voxels;
    for (const CoverStop& stop : stops) {
      const auto [number, is_new] = numbers.try_emplace(stop.place, voxels.size());
      if (is_new) voxels.push_back(stop.place);
      place_of_.push_back(number->second);
    }
    count_ = voxels.size();
    return voxels;
  }

  std::vector<std::size_t> place_of_;  ///< For each stop.
  std::size_t count_ = 0;
  RoughDistances distances_;
  std::vector<std::vector<double>> from_;  ///< [m] From each place to all, once asked for.
};

}  // namespace

void Visit(OptionVisitor& visitor, Cover::Options& options) {
  visitor.Block("cover", [&](OptionVisitor& cover) {
    cover.Number("eagerness", options.eagerness);
    cover.Number("least_yield_m2_per_m", options.least_yield);
  });
}

Cover::Cover(const Options& options) : options_(options) {
  if (!(options.eagerness >= 0.0)) throw std::invalid_argument("eagerness must be >= 0");
  if (!(options.least_yield >= 0.0)) throw std::invalid_argument("least_yield must be >= 0");
}

bool Cover::LookedAt(const VoxelIndex& unknown, const Eigen::Vector3d& p_W) const {
  const auto looked = looked_from_W_.find(unknown);
  return looked != looked_from_W_.end() && (looked->second - p_W).norm() < kApart;
}

bool Cover::MaySee(const Situation& situation, const Eigen::Vector3d& p_W, const VoxelIndex& unknown) const {
  const PlanningMap& map = situation.map;
  const DenseGrid<VoxelState>& states = map.states();
  const Eigen::Vector3d eye_W = map.EyeAt(p_W);
  const Eigen::Vector3d center_W = map.CenterOf(unknown);
  const VoxelIndex eye = map.IndexOf(eye_W);
  if ((center_W - eye_W).squaredNorm() > situation.look_range * situation.look_range ||
      !states.Contains(eye) || !situation.views.CanShow(center_W - eye_W) || LookedAt(unknown, p_W))
    return false;
  // Both ends are in the map's box, and so is what lies between them.
  const double pocket = kPocket / map.voxel_size();  // [voxels]
  return TraverseVoxels(center_W, eye_W, map.voxel_size(), [&](const VoxelIndex& i) {
    const VoxelState state = states[i];
    if (state == VoxelState::kFree || i == unknown || i == eye) return true;
    const VoxelIndex d = i - unknown;
    return state == VoxelState::kUnknown && d.x * d.x + d.y * d.y + d.z * d.z <= pocket * pocket;
  });
}

std::optional<Choice> Cover::LookFromHere(const Situation& situation) {
  const Eigen::Vector3d& p_W = situation.robot_W;
  const Eigen::Vector3d eye_W = situation.map.EyeAt(p_W);
  std::vector<Sighting> sightings;
  std::vector<std::size_t> candidates;  // of each sighting
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    for (const VoxelIndex& i : situation.candidates[n].cluster.unknowns) {
      const Eigen::Vector3d center_W = situation.map.CenterOf(i);
      if (LookedAt(i, p_W) || !situation.views.CanSee(situation.map, eye_W, center_W, situation.look_range))
        continue;
      sightings.push_back({i, center_W - eye_W});
      candidates.push_back(n);
    }
  }
  const std::size_t enough = VoxelsOfArea(kLeastLook, situation.map.voxel_size());
  if (sightings.size() < enough) return std::nullopt;
  const View view = situation.views.Best(sightings, std::vector<bool>(sightings.size(), true), {},
                                         Eigen::Matrix3d::Identity());
  if (view.count < enough) return std::nullopt;
  Choice choice{.path_W = {p_W, p_W}};
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    if (!situation.views.Shows(view.R_WB, sightings[n])) continue;
    if (choice.target.empty()) choice.candidate = candidates[n];
    choice.target.push_back(sightings[n].voxel);
    looked_from_W_[sightings[n].voxel] = p_W;
  }
  return choice;
}

bool Cover::Shows(const Situation& situation, const CoverStop& stop, const VoxelIndex& unknown) const {
  const PlanningMap& map = situation.map;
  const Eigen::Vector3d p_W = PositionOf(stop, situation);
  const Eigen::Vector3d eye_W = map.EyeAt(p_W);
  const Eigen::Vector3d center_W = map.CenterOf(unknown);
  if (stop.R_WB && !situation.views.Shows(*stop.R_WB, {unknown, center_W - eye_W})) return false;
  if (!stop.is_here) return MaySee(situation, p_W, unknown);
  return !LookedAt(unknown, p_W) && situation.views.CanSee(map, eye_W, center_W, situation.look_range);
}

Choice Cover::GoTo(const Situation& situation, const CoverStop& stop) {
  const Eigen::Vector3d& p_W = situation.robot_W;
  Choice choice;
  choice.R_WB = stop.R_WB;
  choice.path_W = stop.is_here ? std::vector{p_W, p_W} : ShortestPath(situation, stop.place);
  std::size_t most = 0;
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    const std::size_t before = choice.target.size();
    std::ranges::copy_if(situation.candidates[n].cluster.unknowns, std::back_inserter(choice.target),
                         [&](const VoxelIndex& i) { return Shows(situation, stop, i); });
    if (choice.target.size() - before <= most) continue;
    most = choice.target.size() - before;
    choice.candidate = n;
  }
  if (stop.is_here) {
    for (const VoxelIndex& i : choice.target) looked_from_W_[i] = p_W;
  }
  return choice;
}

std::vector<CoverStop> Cover::FindStops(const Situation& situation, const std::vector<CoverItem>& items) {
  const PlanningMap& map = situation.map;
  if (rays_.empty()) rays_ = SpreadRays(kLatticeRays, situation.look_range, map.voxel_size());
  std::vector<CoverStop> stops = StopsSeeing(situation, items, rays_);
  std::vector<CoverStop> always;  // the first goals of what is near, and where the robot is
  for (std::size_t n = 0; n < items.size(); ++n) {
    const Candidate& candidate = situation.candidates[items[n].candidate];
    if (items[n].is_far) continue;
    if (n == 0 || items[n].candidate != items[n - 1].candidate)
      always.push_back({.place = candidate.goals.front()});
    always.back().items.push_back(n);
  }
  if (situation.time) {
    CoverStop here{.place = map.IndexOf(situation.robot_W), .is_here = true};
    if (situation.search.Reached(here.place)) {
      for (std::size_t n = 0; n < items.size(); ++n) {
        if (Shows(situation, here, items[n].voxel)) here.items.push_back(n);
      }
      always.push_back(std::move(here));
    }
    for (std::vector<CoverStop>* const its : {&stops, &always}) {
      std::vector<CoverStop> views;
      for (const CoverStop& stop : *its)
        std::ranges::move(ViewsFrom(stop, situation, items), std::back_inserter(views));
      *its = std::move(views);
    }
  }
  KeepFew(situation, items.size(), stops);
  std::ranges::move(always, std::back_inserter(stops));
  std::ranges::move(ZoneStops(situation, items), std::back_inserter(stops));
  return stops;
}

Choice Cover::Choose(const Situation& situation) {
  const PlanningMap& map = situation.map;
  std::erase_if(looked_from_W_, [&](const auto& looked) {
    return map.State(looked.first) != VoxelState::kUnknown && !map.Doubtful(looked.first);
  });
  if (!situation.time) {
    if (std::optional<Choice> here = LookFromHere(situation)) return *std::move(here);
  }
  const std::vector<FormerStop> formers = formers_;
  Choice choice = ChooseByTour(situation, kFarPath);
  const bool some_far = std::ranges::any_of(
      situation.candidates, [](const Candidate& candidate) { return candidate.length > kFarPath; });
  if (choice.path_W.empty() && some_far) {
    // An end is not decided on by what zones are thought to cost.
    formers_ = formers;
    choice = ChooseByTour(situation, std::numeric_limits<double>::infinity());
  }
  return choice;
}

Choice Cover::ChooseByTour(const Situation& situation, double far) {
  const PlanningMap& map = situation.map;
  const std::vector<CoverItem> items = SampleItems(situation, far);
  const std::vector<CoverStop> stops = FindStops(situation, items);
  const StopPrices prices(situation, stops);
  CoarseMap coarse(map, situation.search);
  const Weights weights = WeightsOf(situation, coarse);
  CoverProblem problem{.from_start = {},
                       .delay_price = {},
                       .worth = {},
                       .seen = BitTable(stops.size(), items.size()),
                       .sees = {},
                       .distances = {}};
  for (std::size_t n = 0; n < stops.size(); ++n) {
    problem.from_start.push_back(prices.FromRobot(n));
    for (const std::size_t item : stops[n].items) problem.seen.Set(n, item);
  }
  const double face = map.voxel_size() * map.voxel_size();  // [m^2]
  for (const CoverItem& item : items) {
    const double weight = item.share * weights.of[item.candidate];
    problem.delay_price.push_back(options_.eagerness * weight / weights.all);
    problem.worth.push_back(options_.least_yield > 0.0 ? face * weight / options_.least_yield
                                                       : std::numeric_limits<double>::infinity());
  }
  problem.sees = [&](std::size_t stop, std::size_t item) {
    return stops[stop].is_zone || Shows(situation, stops[stop], items[item].voxel);
  };
  Places places(coarse, stops);
  problem.distances = [&](std::size_t stop) {
    std::vector<double> lengths = places.From(stop);
    for (std::size_t n = 0; n < stops.size(); ++n) lengths[n] = prices.Between(stop, n, lengths[n]);
    return lengths;
  };

  CoverTourSearch search(std::move(problem));
  const Tour former =
      search.Completed(TourAsBefore(formers_, stops.size(), [&](const FormerStop& stop, std::size_t n) {
        return Distance(stops[n], stop, situation);
      }));
  const double length = static_cast<double>(std::max(former.size(), kLongTour)) / kLongTour;
  Tour tour = search.Improved(former, static_cast<int>(kIterations / (length * length * length)));
  const bool sees_anything = !tour.empty();
  tour = search.WorthItsPath(std::move(tour));
  formers_.clear();
  for (const std::size_t n : tour) formers_.push_back({PositionOf(stops[n], situation), stops[n].R_WB});
  if (sees_anything && tour.empty()) return {};
  if (sees_anything) {
    Choice choice = GoTo(situation, stops[tour.front()]);
    if (!choice.target.empty()) return choice;
  }
  return StraightTo(situation, NearestCandidate(situation));
}

}  // namespace thalweg::explorer
