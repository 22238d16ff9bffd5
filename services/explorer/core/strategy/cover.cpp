#include "services/explorer/core/strategy/cover.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/base/check.h"
#include "common/voxel/ray.h"
#include "services/explorer/core/path/coarse_map.h"
#include "services/explorer/core/path/rough_distances.h"
#include "services/explorer/core/strategy/cover_tour.h"
#include "services/explorer/core/strategy/stops.h"

namespace thalweg::explorer {
namespace {

constexpr double kLeastLook = 0.1;  // [m^2] That a turn on the spot shows.
constexpr double kApart = 0.25;     // [m] A look from nearer than this to the last one is no other look.
constexpr double kPocket = 0.5;     // [m] Unknown voxels that near to an item do not block the sight of it.
constexpr double kSpacing = 0.4;    // [m] Edge of the lattice's cells.
constexpr std::size_t kLatticeRays = 100;
constexpr double kMostSamples = 4.0;   // Per cluster,
constexpr double kManyItems = 1500.0;  // fewer where there are more clusters than would fit in here.
constexpr int kMostSeers = 4;          // Positions kept per item among those that show most,
constexpr int kNearSeers = 2;          // and among those nearest to the robot.
constexpr double kIterations = 10.0;   // Made by the search for tours of up to kLongTour stops;
constexpr std::size_t kLongTour = 50;  // [stops] fewer for longer ones.

/// A sample of a cluster.
struct Item {
  VoxelIndex voxel;
  std::size_t candidate;
  double share;  ///< The part of its cluster that it stands for.
};

std::vector<Item> SampleItems(const Situation& situation) {
  const double fit = kManyItems / static_cast<double>(situation.candidates.size());
  const auto most = static_cast<std::size_t>(std::clamp(fit, 1.0, kMostSamples));
  std::vector<Item> items;
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    const std::vector<VoxelIndex> sample = SpreadSample(situation.candidates[n].cluster.unknowns, most);
    for (const VoxelIndex& i : sample) items.push_back({i, n, 1.0 / static_cast<double>(sample.size())});
  }
  return items;
}

/// A position from which items may be seen.
struct Place {
  VoxelIndex voxel;
  std::vector<std::size_t> items = {};
  std::uint16_t crossings = 0;  ///< Number of rays through the voxel.
};

/// Cubic cells of `edge` voxels that fill a box; each has an offset, which is the sum over the axes of a
/// value that the tables give for the distance from the box's corner.
struct CellOffsets {
  CellOffsets(const VoxelBox& box, int edge) {
    const auto fill = [edge](std::vector<std::size_t>& of, int voxels, std::size_t stride) {
      for (int n = 0; n < voxels; ++n) of.push_back(static_cast<std::size_t>(n / edge) * stride);
      return stride * static_cast<std::size_t>((voxels + edge - 1) / edge);
    };
    count = fill(z, box.size_z(), fill(y, box.size_y(), fill(x, box.size_x(), 1)));
  }
  std::size_t Of(const VoxelIndex& at) const {
    return x[static_cast<std::size_t>(at.x)] + y[static_cast<std::size_t>(at.y)] +
           z[static_cast<std::size_t>(at.z)];
  }

  std::size_t count = 0;
  std::vector<std::size_t> x = {};
  std::vector<std::size_t> y = {};
  std::vector<std::size_t> z = {};
};

/// In each cell of a lattice, the reached voxel that most rays from the items cross.
std::vector<Place> PlacesSeeing(const Situation& situation, const std::vector<Item>& items,
                                const std::vector<std::vector<RayStep>>& rays) {
  const PlanningMap& map = situation.map;
  const DenseGrid<VoxelState>& states = map.states();
  const DenseGrid<std::uint32_t>& costs = situation.search.costs();
  const VoxelBox& box = map.box();
  THALWEG_CHECK(costs.box() == box);
  const CellOffsets cells(box, std::max(1, static_cast<int>(std::lround(kSpacing / map.voxel_size()))));
  constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> place_in(cells.count, kNone);
  DenseGrid<std::uint16_t> crossings(box, 0);
  std::vector<Place> places;
  for (std::size_t item = 0; item < items.size(); ++item) {
    for (const std::vector<RayStep>& ray : rays) {
      for (const RayStep& step : ray) {
        const VoxelIndex eye = items[item].voxel + step.offset;
        if (!box.Contains(eye)) break;
        const VoxelState state = states[eye];
        if (state == VoxelState::kUnknown && step.distance <= kPocket) continue;
        if (state != VoxelState::kFree) break;
        const VoxelIndex body = map.BodyOf(eye);
        // Every other voxel, as on a chessboard, is enough to choose from.
        if (((body.x + body.y + body.z) & 1) != 0 || !box.Contains(body)) continue;
        const std::size_t offset = costs.Offset(body);
        if (costs[offset] == PathSearch::kUnreached) continue;
        std::int32_t& number = place_in[cells.Of(body - box.min)];
        if (number == kNone) {
          number = static_cast<std::int32_t>(places.size());
          places.push_back({.voxel = body});
        }
        Place& place = places[static_cast<std::size_t>(number)];
        std::uint16_t& count = crossings[offset];
        if (count < std::numeric_limits<std::uint16_t>::max()) ++count;
        if (count > place.crossings) {
          place.crossings = count;
          place.voxel = body;
        }
        if (place.items.empty() || place.items.back() != item) place.items.push_back(item);
      }
    }
  }
  return places;
}

/// Keeps some places for each item: those that see most items, and those nearest to the robot.
void KeepFew(const Situation& situation, std::size_t items, std::vector<Place>& places) {
  std::vector<bool> kept(places.size(), false);
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto keep = [&](int most) {
    std::vector<int> seers(items, 0);
    for (const std::size_t n : order) {
      const std::vector<std::size_t>& its = places[n].items;
      if (std::ranges::all_of(its, [&](std::size_t item) { return seers[item] >= most; })) continue;
      kept[n] = true;
      for (const std::size_t item : its) ++seers[item];
    }
  };
  std::ranges::stable_sort(order, std::greater<>{}, [&](std::size_t n) { return places[n].items.size(); });
  keep(kMostSeers);
  std::ranges::stable_sort(order, {}, [&](std::size_t n) { return situation.search.Cost(places[n].voxel); });
  keep(kNearSeers);
  std::vector<Place> few;
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (kept[n]) few.push_back(std::move(places[n]));
  }
  places = std::move(few);
}

/// [m] The path to a place, and what it costs to look from there at what it sees.
double PriceOfFirst(const Situation& situation, const std::vector<Item>& items, const Place& place) {
  const double length = situation.search.Length(place.voxel);
  if (!situation.time.turn) return length;
  Eigen::Vector3d sum_W = Eigen::Vector3d::Zero();
  for (const std::size_t item : place.items) sum_W += situation.map.CenterOf(items[item].voxel);
  return length + situation.time.turn(place.voxel, length, sum_W / static_cast<double>(place.items.size()));
}

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

/// The tour through the places nearest to where the previous one stopped.
Tour AsBefore(const std::vector<Eigen::Vector3d>& former_W, const PlanningMap& map,
              const std::vector<VoxelIndex>& places) {
  Tour tour;
  for (const Eigen::Vector3d& p_W : former_W) {
    std::size_t nearest = places.size();
    double least = kSameStop;
    for (std::size_t n = 0; n < places.size(); ++n) {
      const double distance = (map.CenterOf(places[n]) - p_W).norm();
      if (distance >= least) continue;
      least = distance;
      nearest = n;
    }
    if (nearest < places.size() && std::ranges::find(tour, nearest) == tour.end()) tour.push_back(nearest);
  }
  return tour;
}

}  // namespace

void Visit(OptionVisitor& visitor, Cover::Options& options) {
  visitor.Block("cover", [&](OptionVisitor& cover) {
    cover.Number("eagerness", options.eagerness);
    cover.Number("hysteresis", options.hysteresis);
    cover.Number("least_yield_m2_per_m", options.least_yield);
  });
}

Cover::Cover(const Options& options) : options_(options) {
  if (!(options.eagerness >= 0.0)) throw std::invalid_argument("eagerness must be >= 0");
  if (!(options.hysteresis >= 0.0)) throw std::invalid_argument("hysteresis must be >= 0");
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
  if (situation.time.turn) {
    const double price = situation.time.turn(situation.map.IndexOf(p_W), 0.0, p_W + view.R_WB.col(0));
    if (view.count < VoxelsOfArea(options_.least_yield * price, situation.map.voxel_size()))
      return std::nullopt;
  }
  Choice choice{.path_W = {p_W, p_W}};
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    if (!situation.views.Shows(view.R_WB, sightings[n])) continue;
    if (choice.target.empty()) choice.candidate = candidates[n];
    choice.target.push_back(sightings[n].voxel);
    looked_from_W_[sightings[n].voxel] = p_W;
  }
  return choice;
}

Choice Cover::GoTo(const Situation& situation, const VoxelIndex& place) const {
  Choice choice{.path_W = ShortestPath(situation, place)};
  std::size_t most = 0;
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    const std::size_t before = choice.target.size();
    std::ranges::copy_if(
        situation.candidates[n].cluster.unknowns, std::back_inserter(choice.target),
        [&](const VoxelIndex& i) { return MaySee(situation, situation.map.CenterOf(place), i); });
    if (choice.target.size() - before <= most) continue;
    most = choice.target.size() - before;
    choice.candidate = n;
  }
  return choice;
}

Choice Cover::Choose(const Situation& situation) {
  const PlanningMap& map = situation.map;
  std::erase_if(looked_from_W_, [&](const auto& looked) {
    return map.State(looked.first) != VoxelState::kUnknown && !map.Doubtful(looked.first);
  });
  if (std::optional<Choice> here = LookFromHere(situation)) return *std::move(here);

  const std::vector<Item> items = SampleItems(situation);
  if (rays_.empty()) rays_ = SpreadRays(kLatticeRays, situation.look_range, map.voxel_size());
  std::vector<Place> places = PlacesSeeing(situation, items, rays_);
  KeepFew(situation, items.size(), places);
  const std::size_t first_goal = places.size();
  for (const Candidate& candidate : situation.candidates)
    places.push_back({.voxel = candidate.goals.front()});
  for (std::size_t item = 0; item < items.size(); ++item)
    places[first_goal + items[item].candidate].items.push_back(item);

  CoarseMap coarse(map, situation.search);
  const Weights weights = WeightsOf(situation, coarse);
  CoverProblem problem{.from_start = {},
                       .delay_price = {},
                       .worth = {},
                       .seen = BitTable(places.size(), items.size()),
                       .sees = {},
                       .distances = {}};
  std::vector<VoxelIndex> voxels;
  for (std::size_t n = 0; n < places.size(); ++n) {
    voxels.push_back(places[n].voxel);
    problem.from_start.push_back(PriceOfFirst(situation, items, places[n]));
    for (const std::size_t item : places[n].items) problem.seen.Set(n, item);
  }
  const double face = map.voxel_size() * map.voxel_size();  // [m^2]
  for (const Item& item : items) {
    const double weight = item.share * weights.of[item.candidate];
    problem.delay_price.push_back(options_.eagerness * weight / weights.all);
    problem.worth.push_back(options_.least_yield > 0.0 ? face * weight / options_.least_yield
                                                       : std::numeric_limits<double>::infinity());
  }
  problem.sees = [&](std::size_t place, std::size_t item) {
    return MaySee(situation, map.CenterOf(voxels[place]), items[item].voxel);
  };
  RoughDistances distances(coarse, voxels);
  problem.distances = [&](std::size_t place) {
    std::vector<double> lengths = distances.From(place);
    for (double& length : lengths) length += situation.time.stop;
    return lengths;
  };

  CoverTourSearch search(std::move(problem));
  const Tour former = search.Completed(AsBefore(former_W_, map, voxels));
  const double length = static_cast<double>(std::max(former.size(), kLongTour)) / kLongTour;
  Tour tour = search.Improved(former, static_cast<int>(kIterations / (length * length * length)));
  if (search.Cost(former) <= (1.0 + options_.hysteresis) * search.Cost(tour)) tour = former;
  const bool sees_anything = !tour.empty();
  tour = search.WorthItsPath(std::move(tour));
  former_W_.clear();
  for (const std::size_t place : tour) former_W_.push_back(map.CenterOf(voxels[place]));
  if (sees_anything && tour.empty()) return {};
  if (sees_anything) {
    Choice choice = GoTo(situation, voxels[tour.front()]);
    if (!choice.target.empty()) return choice;
  }
  return StraightTo(situation, NearestCandidate(situation));
}

}  // namespace thalweg::explorer
