#include "services/explorer/core/shut_ways.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <unordered_map>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/moved_grid.h"

namespace thalweg::explorer {
namespace {

constexpr double kSameWay = 1.0;  // [m] Bars nearer to each other than this are of one way.

bool AreOfOneWay(const VoxelIndex& a, const VoxelIndex& b, double voxel_size) {
  const VoxelIndex d = a - b;
  return std::hypot(d.x, d.y, d.z) * voxel_size < kSameWay;
}

/// What is set aside, but for what was out of sight.
DenseGrid<std::uint8_t> AllButOutOfSight(const DenseGrid<std::uint8_t>& set_aside) {
  DenseGrid<std::uint8_t> mask(set_aside.box(), 0);
  for (std::size_t k = 0; k < set_aside.size(); ++k) {
    const VoxelIndex i = set_aside.IndexAt(k);
    const bool counts =
        set_aside[i] == 0 || set_aside[i] == static_cast<std::uint8_t>(AsideReason::kOutOfSight);
    mask[i] = counts ? 0 : 1;
  }
  return mask;
}

/// The occupied voxel nearest to a place where the body would touch it.
std::optional<VoxelIndex> BlockerOf(const VoxelIndex& place, const PlanningMap& map) {
  const double reach = std::max(map.options().clearance, map.options().half_height) + map.voxel_size();
  const int cells = static_cast<int>(std::ceil(reach / map.voxel_size()));
  std::optional<VoxelIndex> nearest;
  int least = std::numeric_limits<int>::max();
  ForEachVoxel(CubeAround(place, cells), [&](const VoxelIndex& i) {
    if (map.State(i) != VoxelState::kOccupied) return;
    const VoxelIndex d = i - place;
    const int square = d.x * d.x + d.y * d.y + d.z * d.z;
    if (square >= least) return;
    least = square;
    nearest = i;
  });
  return nearest;
}

/// Goes from what the robot can reach through what it once could, nearest first.
class Crossing {
 public:
  Crossing(const DenseGrid<std::uint8_t>& reached, const PlanningMap& map, const PathSearch& search)
      : reached_(reached), map_(map), search_(search), state_(reached.box(), kUnseen) {
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const VoxelIndex i = reached.IndexAt(k);
      if (IsShut(i) && TouchesReach(i)) Enter(i, i);
    }
  }

  /// Space that is cut off.
  struct Beyond {
    VoxelIndex first_shut;  ///< The nearest voxel of the way to it in which the body no longer fits.
    VoxelIndex place;       ///< A voxel of it.
  };
  /// The next piece of it that is not among those already met. @param found  Calls Meet for its voxels.
  std::optional<Beyond> Next() {
    while (!queue_.empty()) {
      const VoxelIndex at = queue_.front();
      queue_.pop_front();
      std::optional<Beyond> beyond;
      ForEachVoxel(CubeAround(at, 1), [&](const VoxelIndex& to) {
        if (reached_.Get(to, 0) == 0 || state_[to] != kUnseen || search_.Reached(to)) return;
        if (!map_.Traversable(to)) {
          Enter(to, first_.at(at));
        } else if (!beyond) {
          beyond = Beyond{first_.at(at), to};
        }
      });
      if (!beyond) continue;
      queue_.push_front(at);  // its other neighbors may lead elsewhere
      return beyond;
    }
    return std::nullopt;
  }
  void Meet(const VoxelIndex& i) {
    if (state_.Contains(i)) state_[i] = kMet;
  }

 private:
  static constexpr std::uint8_t kUnseen = 0;
  static constexpr std::uint8_t kMet = 1;

  bool IsShut(const VoxelIndex& i) const { return reached_[i] != 0 && !map_.Traversable(i); }
  bool TouchesReach(const VoxelIndex& i) const {
    return !ForEachVoxel(CubeAround(i, 1), [&](const VoxelIndex& to) { return !search_.Reached(to); });
  }
  void Enter(const VoxelIndex& i, const VoxelIndex& first) {
    state_[i] = kMet;
    first_.emplace(i, first);
    queue_.push_back(i);
  }

  const DenseGrid<std::uint8_t>& reached_;
  const PlanningMap& map_;
  const PathSearch& search_;
  DenseGrid<std::uint8_t> state_;
  std::unordered_map<VoxelIndex, VoxelIndex, VoxelIndexHash> first_;
  std::deque<VoxelIndex> queue_;
};

}  // namespace

ShutWays::ShutWays(const Options& options)
    : options_(options), goal_finder_(options.look_range, options.voxel_size) {}

void ShutWays::Clear() {
  reached_ = {};
  watched_.reset();
  not_got_to_.clear();
  given_up_.clear();
}

void ShutWays::Note(const PathSearch& search) {
  if (options_.patience <= Duration::zero()) return;
  const DenseGrid<std::uint32_t>& costs = search.costs();
  if (!(reached_.box() == costs.box())) reached_ = MovedTo(reached_, costs.box(), std::uint8_t{0});
  const std::uint32_t* const cost = costs.data();
  std::uint8_t* const reached = reached_.data();
  for (std::size_t k = 0; k < costs.size(); ++k)
    reached[k] |= static_cast<std::uint8_t>(cost[k] != PathSearch::kUnreached);
}

std::vector<ShutWays::Way> ShutWays::Find(const Knowledge& knowledge, const PathSearch& search) const {
  const PlanningMap& map = knowledge.map();
  if (options_.patience <= Duration::zero() || !(reached_.box() == map.box())) return {};
  Crossing crossing(reached_, map, search);
  std::vector<Way> ways;
  std::optional<Frontiers> frontiers;
  while (const auto beyond = crossing.Next()) {
    PathSearch there;
    there.Flood(map, {{beyond->place, 0}});
    for (std::size_t k = 0; k < there.costs().size(); ++k) {
      if (there.costs()[k] != PathSearch::kUnreached) crossing.Meet(there.costs().IndexAt(k));
    }
    if (!frontiers)
      frontiers = FindFrontiers(map, AllButOutOfSight(knowledge.memory().set_aside()), options_.frontier);
    std::size_t unknowns = 0;
    for (const Cluster& cluster : frontiers->clusters) {
      if (cluster.doubtful || goal_finder_.GoalsOf(cluster, map, there, knowledge.views()).empty()) continue;
      if (goal_finder_.GoalsOf(cluster, map, search, knowledge.views()).empty())
        unknowns += cluster.unknowns.size();
    }
    const std::optional<VoxelIndex> bar = BlockerOf(beyond->first_shut, map);
    if (unknowns > 0 && bar) ways.push_back({*bar, unknowns});
  }
  return ways;
}

bool ShutWays::Holds(const std::vector<VoxelIndex>& bars, const VoxelIndex& of) const {
  return std::ranges::any_of(
      bars, [&](const VoxelIndex& bar) { return AreOfOneWay(bar, of, options_.voxel_size); });
}

bool ShutWays::MayWatch(const Way& way) const {
  return !Holds(given_up_, way.bar);
}

void ShutWays::Watch(const Way& way, Time now) {
  if (!watched_ || !AreOfOneWay(watched_->bar, way.bar, options_.voxel_size))
    watched_ = Watched{way.bar, now};
  if (now - watched_->since > options_.patience) GiveUp(way);
}

void ShutWays::GiveUp(const Way& way) {
  given_up_.push_back(way.bar);
  watched_.reset();
}

void ShutWays::DidNotGetTo(const VoxelIndex& bar) {
  if (Holds(not_got_to_, bar)) {
    GiveUp({.bar = bar, .unknowns = 0});
  } else {
    not_got_to_.push_back(bar);
  }
}

void ShutWays::ShiftTimes(Duration back) {
  if (watched_) watched_->since -= back;
}

}  // namespace thalweg::explorer
