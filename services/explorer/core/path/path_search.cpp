#include "services/explorer/core/path/path_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/simd.h"
#include "common/geometry/polyline.h"
#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/path/step_cost.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;

struct Neighbor {
  VoxelIndex offset;
  std::uint32_t cost;
};

constexpr double kTolerance = 1e-6;  // [m]

std::array<Neighbor, 26> MakeNeighbors() {
  std::array<Neighbor, 26> all{};
  std::size_t n = 0;
  ForEachVoxel(CubeAround({0, 0, 0}, 1), [&](const VoxelIndex& step) {
    const auto axes = static_cast<std::size_t>(std::abs(step.x) + std::abs(step.y) + std::abs(step.z));
    if (axes > 0) all[n++] = {step, kStepCost[axes]};
  });
  return all;
}
const std::array<Neighbor, 26> kNeighbors = MakeNeighbors();

/// For a voxel reached by step n, the neighbors worth testing. Neighbors of the previous voxel are left out,
/// because they are reached from there at no greater cost. Entry 26: all neighbors.
std::array<std::vector<std::uint8_t>, 27> MakeFresh() {
  std::array<std::vector<std::uint8_t>, 27> fresh;
  for (std::size_t n = 0; n < fresh.size(); ++n) {
    for (std::uint8_t m = 0; m < kNeighbors.size(); ++m) {
      if (n < kNeighbors.size()) {
        const VoxelIndex before = kNeighbors[n].offset + kNeighbors[m].offset;
        if (std::max({std::abs(before.x), std::abs(before.y), std::abs(before.z)}) <= 1) continue;
      }
      fresh[n].push_back(m);
    }
  }
  return fresh;
}
const std::array<std::vector<std::uint8_t>, 27> kFresh = MakeFresh();

std::uint32_t OctileDistance(const VoxelIndex& a, const VoxelIndex& b) {
  std::array<std::uint32_t, 3> d = {static_cast<std::uint32_t>(std::abs(a.x - b.x)),
                                    static_cast<std::uint32_t>(std::abs(a.y - b.y)),
                                    static_cast<std::uint32_t>(std::abs(a.z - b.z))};
  std::sort(d.begin(), d.end());
  return kStepCost[3] * d[0] + kStepCost[2] * (d[1] - d[0]) + kStepCost[1] * (d[2] - d[1]);
}

}  // namespace

PathSearch::Start PathSearch::StartAt(const PlanningMap& map, const Eigen::Vector3d& p_W, double radius,
                                      const Exemption& exemption) {
  const VoxelIndex here = map.IndexOf(p_W);
  const auto straight_to = [&](const VoxelIndex& i, Obstacles obstacles) {
    const Eigen::Vector3d center = map.CenterOf(i);
    // The camera of a driving robot cannot see the space around the robot's feet; it looks over it.
    const bool in_sight =
        map.plane() ? map.InSight(map.EyeAt(p_W), map.EyeAt(center)) : map.InSight(p_W, center);
    return in_sight && map.ClearToLeave(p_W, center, obstacles, radius - kTolerance);
  };
  const bool goes_on = map.Traversable(here) && straight_to(here, Obstacles::kOccupied);
  if (goes_on && !exemption.from_pocket) return {{here, 0}};
  // From a traversable position, the whole body must stay out of unknown space.
  const Obstacles obstacles = goes_on ? Obstacles::kOccupiedAndUnknown : Obstacles::kOccupied;
  Start start;
  const int reach = static_cast<int>(std::ceil(exemption.reach / map.voxel_size()));
  ForEachVoxel(CubeAround(here, reach), [&](const VoxelIndex& i) {
    const double distance = (map.CenterOf(i) - p_W).norm();
    if (distance > exemption.reach || !map.Traversable(i) || !straight_to(i, obstacles)) return;
    start.push_back({i, static_cast<std::uint32_t>(std::lround(100.0 * distance / map.voxel_size()))});
  });
  return start;
}

std::vector<PathSearch::Start> PathSearch::Parts(const PlanningMap& map, const Start& start) {
  if (start.size() < 2) return {start};
  PathSearch search;
  std::vector<std::pair<std::size_t, Start>> parts;
  for (Start left = start; !left.empty();) {
    search.Flood(map, {left.front()});
    const auto others = std::stable_partition(
        left.begin(), left.end(), [&](const Entry& entry) { return search.Reached(entry.voxel); });
    parts.emplace_back(search.reached_count(), Start(left.begin(), others));
    left.erase(left.begin(), others);
  }
  std::ranges::stable_sort(parts, std::greater<>(), &std::pair<std::size_t, Start>::first);
  std::vector<Start> sorted;
  for (auto& [size, part] : parts) sorted.push_back(std::move(part));
  return sorted;
}

namespace {

/// Initializes the costs: traversable voxels are unreached; all others get cost 0, less than any path has.
THALWEG_SIMD_CLONES
void OpenTraversable(std::span<const std::uint16_t> blockers, std::uint32_t* costs) {
  for (std::size_t k = 0; k < blockers.size(); ++k) costs[k] = blockers[k] == 0 ? PathSearch::kUnreached : 0;
}

THALWEG_SIMD_CLONES
void CloseBlocked(std::span<const std::uint16_t> blockers, std::uint32_t* costs) {
  for (std::size_t k = 0; k < blockers.size(); ++k)
    costs[k] = blockers[k] == 0 ? costs[k] : PathSearch::kUnreached;
}

}  // namespace

void PathSearch::Flood(const PlanningMap& map, const Start& start, std::span<const VoxelIndex> wanted) {
  voxel_size_ = map.voxel_size();
  // Entries wait, sorted by cost, because their costs may lie farther apart than the buckets span.
  start_ = start;
  std::ranges::stable_sort(start_, {}, &Entry::cost);
  if (!(costs_.box() == map.box())) costs_ = DenseGrid<std::uint32_t>(map.box(), kUnreached);
  OpenTraversable(map.blockers(), costs_.data());
  reached_ = 0;

  // Traversable voxels never lie on the box's faces (PlanningMap::box), so neighbors are found by offsets
  // alone.
  struct Move {
    std::int32_t jump;
    std::uint32_t cost;
    std::uint32_t by;
  };
  std::array<std::vector<Move>, 27> moves;
  for (std::size_t by = 0; by < moves.size(); ++by) {
    for (const std::uint8_t m : kFresh[by]) {
      const VoxelIndex& o = kNeighbors[m].offset;
      const std::ptrdiff_t jump = o.x + o.y * costs_.stride_y() + o.z * costs_.stride_z();
      moves[by].push_back({static_cast<std::int32_t>(jump), kNeighbors[m].cost, m});
    }
  }
  auto entry = start_.begin();
  std::size_t waiting = 0;
  std::size_t known = 0;  // among those wanted
  for (std::uint32_t cost = 0; waiting > 0 || entry != start_.end(); ++cost) {
    std::vector<Step>& bucket = buckets_[cost % kBuckets];
    for (; entry != start_.end() && entry->cost == cost; ++entry) {
      if (costs_[entry->voxel] <= cost) continue;
      costs_[entry->voxel] = cost;
      bucket.push_back({static_cast<std::uint32_t>(costs_.Offset(entry->voxel)), 26});
      ++waiting;
    }
    for (std::size_t n = 0; n < bucket.size(); ++n) {
      const auto [at, by] = bucket[n];
      --waiting;
      if (costs_[at] != cost) continue;  // meanwhile reached at lower cost
      ++reached_;
      for (const Move& move : moves[by]) {
        const std::uint32_t to = at + static_cast<std::uint32_t>(move.jump);
        const std::uint32_t next_cost = cost + move.cost;
        if (next_cost >= costs_[to]) continue;
        costs_[to] = next_cost;
        buckets_[next_cost % kBuckets].push_back({to, move.by});
        ++waiting;
      }
    }
    bucket.clear();
    while (known < wanted.size() && costs_[wanted[known]] <= cost) ++known;
    if (!wanted.empty() && known == wanted.size()) break;
  }
  for (std::vector<Step>& bucket : buckets_) bucket.clear();
  CloseBlocked(map.blockers(), costs_.data());
}

std::vector<VoxelIndex> PathSearch::PathTo(const VoxelIndex& goal) const {
  THALWEG_CHECK(Reached(goal));
  std::vector<VoxelIndex> path = {goal};
  const auto at_entry = [&] {
    if (Cost(path.back()) == 0) return true;  // as only entries have
    const std::uint32_t cost = Cost(path.back());
    auto entry = std::ranges::lower_bound(start_, cost, {}, &Entry::cost);
    for (; entry != start_.end() && entry->cost == cost; ++entry) {
      if (entry->voxel == path.back()) return true;
    }
    return false;
  };
  while (!at_entry()) {
    const std::uint32_t cost = Cost(path.back());
    const auto before = std::find_if(kNeighbors.begin(), kNeighbors.end(), [&](const Neighbor& neighbor) {
      const std::uint32_t other = Cost(path.back() + neighbor.offset);
      return other != kUnreached && other + neighbor.cost == cost;
    });
    THALWEG_CHECK(before != kNeighbors.end());
    path.push_back(path.back() + before->offset);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<Eigen::Vector3d> PathSearch::PathFrom(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                                  const VoxelIndex& goal) const {
  std::vector<Eigen::Vector3d> path_W = {p_W};
  for (const VoxelIndex& voxel : PathTo(goal)) path_W.push_back(map.CenterOf(voxel));
  return path_W;
}

std::optional<std::vector<VoxelIndex>> PathSearch::FindPath(const PlanningMap& map, const Start& start,
                                                            const VoxelIndex& goal, std::uint32_t* cost) {
  struct Open {
    std::uint32_t estimate;
    std::uint32_t cost;
    VoxelIndex voxel;
    bool operator>(const Open& o) const { return estimate > o.estimate; }
  };
  struct Known {
    std::uint32_t cost;
    VoxelIndex from;  // itself: an entry
  };
  std::unordered_map<VoxelIndex, Known, VoxelIndexHash> known;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const auto reach = [&](const VoxelIndex& voxel, std::uint32_t its_cost, const VoxelIndex& from) {
    const auto [found, fresh] = known.try_emplace(voxel, Known{its_cost, from});
    if (!fresh) {
      if (found->second.cost <= its_cost) return;
      found->second = {its_cost, from};
    }
    open.push({its_cost + OctileDistance(voxel, goal), its_cost, voxel});
  };
  for (const Entry& entry : start) reach(entry.voxel, entry.cost, entry.voxel);
  while (!open.empty()) {
    const Open best = open.top();
    open.pop();
    if (known.at(best.voxel).cost != best.cost) continue;
    if (best.voxel == goal) {
      if (cost) *cost = best.cost;
      std::vector<VoxelIndex> path = {goal};
      while (!(known.at(path.back()).from == path.back())) path.push_back(known.at(path.back()).from);
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (const Neighbor& neighbor : kNeighbors) {
      const VoxelIndex next = best.voxel + neighbor.offset;
      if (map.Traversable(next)) reach(next, best.cost + neighbor.cost, best.voxel);
    }
  }
  return std::nullopt;
}

namespace {

constexpr auto kKeptFrom = PlanningMap::Obstacles::kOccupiedAndUnknown;

/// Removes every point that can be removed. @param clear  (from, to): whether the straight segment between
/// two points is acceptable.
template <class Clear>
std::vector<Eigen::Vector3d> Pull(const std::vector<Eigen::Vector3d>& path_W, Clear&& clear) {
  if (path_W.size() < 3) return path_W;
  std::vector<Eigen::Vector3d> pulled = {path_W.front()};
  for (std::size_t from = 0; from + 1 < path_W.size();) {
    // Gallop ahead while the segment is clear, then bisect back to the last acceptable point.
    std::size_t good = from + 1;
    std::size_t bad = path_W.size();
    for (std::size_t step = 2; from + step < path_W.size(); step *= 2) {
      if (!clear(from, from + step)) {
        bad = from + step;
        break;
      }
      good = from + step;
    }
    while (bad - good > 1) {
      const std::size_t middle = good + (bad - good) / 2;
      (clear(from, middle) ? good : bad) = middle;
    }
    pulled.push_back(path_W[good]);
    from = good;
  }
  return pulled;
}

}  // namespace

std::vector<Eigen::Vector3d> PullStraight(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                          double clearance) {
  return Pull(path_W, [&](std::size_t from, std::size_t to) {
    return map.SegmentClear(path_W[from], path_W[to], kKeptFrom, clearance);
  });
}

std::vector<Eigen::Vector3d> PullStraightWithin(const PlanningMap& map,
                                                const std::vector<Eigen::Vector3d>& path_W, double clearance,
                                                double comfort) {
  std::vector<double> arc = {0.0};
  std::vector<double> kept;
  for (std::size_t n = 0; n < path_W.size(); ++n) {
    if (n > 0) arc.push_back(arc.back() + (path_W[n] - path_W[n - 1]).norm());
    kept.push_back(map.ClearanceAt(path_W[n], kKeptFrom, comfort) - kTolerance);
  }
  // At each fraction of its length, the segment must keep the clearance that the path it replaces keeps
  // there.
  const auto keeps_comfort = [&](std::size_t from, std::size_t to) {
    const Eigen::Vector3d segment = path_W[to] - path_W[from];
    const int pieces = PiecesOf(segment.norm(), 0.5 * map.voxel_size());
    std::size_t n = from;
    for (int piece = 1; piece < pieces; ++piece) {
      const double share = static_cast<double>(piece) / pieces;
      while (arc[n + 1] < std::lerp(arc[from], arc[to], share)) ++n;
      if (map.ClearanceAt(path_W[from] + share * segment, kKeptFrom, comfort) <
          std::min(kept[n], kept[n + 1]))
        return false;
    }
    return true;
  };
  return Pull(path_W, [&](std::size_t from, std::size_t to) {
    return map.SegmentClear(path_W[from], path_W[to], kKeptFrom, clearance) && keeps_comfort(from, to);
  });
}

}  // namespace thalweg::explorer
