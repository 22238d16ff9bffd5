#include "services/explorer/core/path_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <unordered_map>
#include <unordered_set>

namespace thalweg::explorer {
namespace {

struct Neighbour {
  VoxelIndex offset;
  std::uint32_t cost;
};

constexpr std::array<std::uint32_t, 4> kStepCost = {0, 100, 141, 173};
constexpr std::size_t kBuckets = 174;  // one more than the dearest step

std::array<Neighbour, 26> MakeNeighbours() {
  std::array<Neighbour, 26> all{};
  std::size_t n = 0;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const auto axes = static_cast<std::size_t>(std::abs(x) + std::abs(y) + std::abs(z));
        if (axes > 0) all[n++] = {{x, y, z}, kStepCost[axes]};
      }
    }
  }
  return all;
}
const std::array<Neighbour, 26> kNeighbours = MakeNeighbours();

std::uint32_t OctileDistance(const VoxelIndex& a, const VoxelIndex& b) {
  std::array<std::uint32_t, 3> d = {static_cast<std::uint32_t>(std::abs(a.x - b.x)),
                                    static_cast<std::uint32_t>(std::abs(a.y - b.y)),
                                    static_cast<std::uint32_t>(std::abs(a.z - b.z))};
  std::sort(d.begin(), d.end());
  return kStepCost[3] * d[0] + kStepCost[2] * (d[1] - d[0]) + kStepCost[1] * (d[2] - d[1]);
}

}  // namespace

PathSearch::Start PathSearch::StartAt(const PlanningMap& map, const Eigen::Vector3d& p_W, double radius,
                                      double exemption) {
  Start start{map.IndexOf(p_W), {}};
  if (map.Traversable(start.voxel)) return start;
  using Obstacles = PlanningMap::Obstacles;
  const double here = map.ClearanceAt(p_W, Obstacles::kOccupied, radius);
  const int reach = static_cast<int>(std::ceil(exemption / map.voxel_size()));
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const VoxelIndex i = start.voxel + VoxelIndex{x, y, z};
        if (map.Traversable(i)) continue;
        if (i == start.voxel) {
          start.exempt.push_back(i);
          continue;
        }
        const Eigen::Vector3d center = map.CenterOf(i);
        if ((center - p_W).norm() > exemption || map.State(i) != VoxelState::kFree) continue;
        if (map.ClearanceAt(center, Obstacles::kOccupied, radius) >= here - 1e-9) start.exempt.push_back(i);
      }
    }
  }
  return start;
}

void PathSearch::Flood(const PlanningMap& map, const Start& start) {
  voxel_size_ = map.voxel_size();
  if (costs_.box() == map.box()) {
    costs_.Fill(kUnreached);
  } else {
    costs_ = DenseGrid<std::uint32_t>(map.box(), kUnreached);
  }
  reached_ = 0;
  // Traversable voxels are off the box's faces (PlanningMap::box), so neighbours are found by offsets alone.
  std::unordered_set<std::size_t> exempt;
  const VoxelBox inside = {map.box().min + VoxelIndex{1, 1, 1}, map.box().max - VoxelIndex{1, 1, 1}};
  if (!inside.Contains(start.voxel)) return;
  for (const VoxelIndex& i : start.exempt) {
    if (inside.Contains(i)) exempt.insert(costs_.Offset(i));
  }
  std::array<std::ptrdiff_t, 26> jumps{};
  for (std::size_t n = 0; n < kNeighbours.size(); ++n) {
    const VoxelIndex& o = kNeighbours[n].offset;
    jumps[n] = o.x + o.y * costs_.stride_y() + o.z * costs_.stride_z();
  }
  std::array<std::vector<std::size_t>, kBuckets> buckets;
  costs_[start.voxel] = 0;
  buckets[0].push_back(costs_.Offset(start.voxel));
  std::size_t waiting = 1;
  for (std::uint32_t cost = 0; waiting > 0; ++cost) {
    std::vector<std::size_t>& bucket = buckets[cost % kBuckets];
    for (std::size_t n = 0; n < bucket.size(); ++n) {
      const std::size_t at = bucket[n];
      --waiting;
      if (costs_[at] != cost) continue;  // reached on a shorter way meanwhile
      ++reached_;
      for (std::size_t m = 0; m < jumps.size(); ++m) {
        const auto k = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + jumps[m]);
        const std::uint32_t next_cost = cost + kNeighbours[m].cost;
        if (next_cost >= costs_[k]) continue;
        if (!map.Traversable(k) && (exempt.empty() || !exempt.contains(k))) continue;
        costs_[k] = next_cost;
        buckets[next_cost % kBuckets].push_back(k);
        ++waiting;
      }
    }
    bucket.clear();
  }
}

std::vector<VoxelIndex> PathSearch::PathTo(const VoxelIndex& goal) const {
  THALWEG_CHECK(Reached(goal));
  std::vector<VoxelIndex> path = {goal};
  for (std::uint32_t cost = Cost(goal); cost > 0;) {
    for (const Neighbour& neighbour : kNeighbours) {
      const VoxelIndex before = path.back() + neighbour.offset;
      const std::uint32_t before_cost = Cost(before);
      if (before_cost == kUnreached || before_cost + neighbour.cost != cost) continue;
      path.push_back(before);
      cost = before_cost;
      break;
    }
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::optional<std::vector<VoxelIndex>> PathSearch::FindPath(const PlanningMap& map, const Start& start,
                                                            const VoxelIndex& goal, std::uint32_t* cost) {
  struct Entry {
    std::uint32_t estimate;
    std::uint32_t cost;
    VoxelIndex voxel;
    bool operator>(const Entry& o) const { return estimate > o.estimate; }
  };
  struct Known {
    std::uint32_t cost;
    VoxelIndex from;
  };
  const std::unordered_set<VoxelIndex, VoxelIndexHash> exempt(start.exempt.begin(), start.exempt.end());
  std::unordered_map<VoxelIndex, Known, VoxelIndexHash> known;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  known[start.voxel] = {0, start.voxel};
  open.push({OctileDistance(start.voxel, goal), 0, start.voxel});
  while (!open.empty()) {
    const Entry entry = open.top();
    open.pop();
    if (known[entry.voxel].cost != entry.cost) continue;
    if (entry.voxel == goal) {
      if (cost) *cost = entry.cost;
      std::vector<VoxelIndex> path = {goal};
      while (!(path.back() == start.voxel)) path.push_back(known[path.back()].from);
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (const Neighbour& neighbour : kNeighbours) {
      const VoxelIndex next = entry.voxel + neighbour.offset;
      if (!map.Traversable(next) && !exempt.contains(next)) continue;
      const std::uint32_t next_cost = entry.cost + neighbour.cost;
      const auto [found, fresh] = known.try_emplace(next, Known{next_cost, entry.voxel});
      if (!fresh) {
        if (found->second.cost <= next_cost) continue;
        found->second = {next_cost, entry.voxel};
      }
      open.push({next_cost + OctileDistance(next, goal), next_cost, next});
    }
  }
  return std::nullopt;
}

std::vector<Eigen::Vector3d> PullStraight(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                          double clearance) {
  if (path_W.size() < 3) return path_W;
  const auto clear = [&](std::size_t from, std::size_t to) {
    return map.SegmentClear(path_W[from], path_W[to], PlanningMap::Obstacles::kOccupiedAndUnknown, clearance);
  };
  std::vector<Eigen::Vector3d> pulled = {path_W.front()};
  for (std::size_t from = 0; from + 1 < path_W.size();) {
    // Gallop ahead while the way is clear, then halve back to the last point in reach.
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

double PathLength(const std::vector<Eigen::Vector3d>& path_W) {
  double length = 0.0;
  for (std::size_t n = 1; n < path_W.size(); ++n) length += (path_W[n] - path_W[n - 1]).norm();
  return length;
}

}  // namespace thalweg::explorer
