#include "services/explorer/core/path/coarse_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "common/base/check.h"
#include "common/base/parallel.h"
#include "services/explorer/core/path/step_cost.h"

namespace thalweg::explorer {
namespace {

constexpr std::uint8_t kOpen = 1U << 6U;  // the bit above those of the six face neighbors
constexpr std::uint32_t kFar = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kNeighborsCost = 200;
constexpr int kMostlyUnknown = CoarseMap::kEdge * CoarseMap::kEdge * CoarseMap::kEdge / 2 + 1;

// A cell and its neighbors are 27 bits, x fastest, so an offset between cells shifts the bits.
constexpr int kSelf = 13;
constexpr int BitOf(const VoxelIndex& d) {
  return kSelf + d.x + 3 * d.y + 9 * d.z;
}
constexpr VoxelIndex OffsetOf(int bit) {
  return {bit % 3 - 1, bit / 3 % 3 - 1, bit / 9 - 1};
}

/// For each of the 27 cells, the bits of the cells at most one cell away from it on each axis.
std::array<std::uint32_t, 27> MakeBeside() {
  std::array<std::uint32_t, 27> beside{};
  for (int a = 0; a < 27; ++a) {
    for (int b = 0; b < 27; ++b) {
      const VoxelIndex d = OffsetOf(b) - OffsetOf(a);
      if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= 1)
        beside[static_cast<std::size_t>(a)] |= 1U << static_cast<unsigned>(b);
    }
  }
  return beside;
}
const std::array<std::uint32_t, 27> kBeside = MakeBeside();

std::array<std::uint32_t, 27> MakeCosts() {
  std::array<std::uint32_t, 27> costs{};
  for (int bit = 0; bit < 27; ++bit) {
    const VoxelIndex d = OffsetOf(bit);
    costs[static_cast<std::size_t>(bit)] =
        kStepCost[static_cast<std::size_t>(std::abs(d.x) + std::abs(d.y) + std::abs(d.z))];
  }
  return costs;
}
const std::array<std::uint32_t, 27> kCosts = MakeCosts();

}  // namespace

CoarseMap::CoarseMap(const PlanningMap& map, const PathSearch& search)
    : search_(search), voxel_size_(map.voxel_size()), origin_(map.box().min) {
  // A margin of one cell on all sides lets neighbors be found by offsets alone.
  const VoxelBox& box = map.box();
  const auto cells = [](int voxels) { return (voxels + kEdge - 1) / kEdge + 1; };
  cells_box_ = {{-1, -1, -1}, {cells(box.size_x()), cells(box.size_y()), cells(box.size_z())}};
  exits_ = DenseGrid<std::uint8_t>(cells_box_, 0);
  unknown_ = DenseGrid<std::uint8_t>(cells_box_, 0);
  THALWEG_CHECK(search.costs().box() == box);
  const auto layers = static_cast<std::size_t>((box.size_z() + kEdge - 1) / kEdge);
  std::vector<std::size_t> known(layers, 0);
  ParallelFor(layers, 1, [&](std::size_t layer) { known[layer] = Describe(static_cast<int>(layer), map); });
  known_ = std::accumulate(known.begin(), known.end(), std::size_t{0});
  FindEdges();
  FindRegions();
}

std::size_t CoarseMap::Describe(int layer, const PlanningMap& map) {
  const VoxelBox& box = map.box();
  const DenseGrid<VoxelState>& states = map.states();
  const DenseGrid<std::uint32_t>& costs = search_.costs();
  const auto reached = [&costs](std::ptrdiff_t k) {
    return costs[static_cast<std::size_t>(k)] != PathSearch::kUnreached;
  };
  std::size_t known = 0;
  VoxelIndex i;
  for (int within_z = 0; within_z < kEdge; ++within_z) {
    i.z = box.min.z + layer * kEdge + within_z;
    if (i.z >= box.max.z) break;
    for (i.y = box.min.y; i.y < box.max.y; ++i.y) {
      const int within_y = (i.y - origin_.y) % kEdge;
      std::size_t k = states.Offset({box.min.x, i.y, i.z});
      std::size_t cell = CellOf({box.min.x, i.y, i.z});
      int within_x = 0;
      for (i.x = box.min.x; i.x < box.max.x; ++i.x, ++k, ++within_x) {
        if (within_x == kEdge) {
          within_x = 0;
          ++cell;
        }
        if (states[k] == VoxelState::kUnknown) {
          if (map.InBounds(i)) ++unknown_[cell];
          continue;
        }
        ++known;
        const auto at = static_cast<std::ptrdiff_t>(k);
        if (!reached(at)) continue;  // reached voxels are never on the box's faces
        unsigned exits = kOpen;
        const auto look = [&](int within, std::ptrdiff_t stride, unsigned face) {
          if (within == kEdge - 1 && reached(at + stride)) exits |= 1U << face;
          if (within == 0 && reached(at - stride)) exits |= 2U << face;
        };
        look(within_x, 1, 0);
        look(within_y, costs.stride_y(), 2);
        look(within_z, costs.stride_z(), 4);
        exits_[cell] = static_cast<std::uint8_t>(exits_[cell] | exits);
      }
    }
  }
  return known;
}

std::size_t CoarseMap::CellOf(const VoxelIndex& voxel) const {
  return exits_.Offset(
      {(voxel.x - origin_.x) / kEdge, (voxel.y - origin_.y) / kEdge, (voxel.z - origin_.z) / kEdge});
}

void CoarseMap::FindEdges() {
  std::array<std::ptrdiff_t, 6> jumps{};
  for (std::size_t face = 0; face < 6; ++face) {
    const VoxelIndex& d = kFaceNeighbors[face];
    jumps[face] = d.x + d.y * exits_.stride_y() + d.z * exits_.stride_z();
  }
  edges_ = DenseGrid<std::uint32_t>(cells_box_, 0);
  for (std::size_t cell = 0; cell < exits_.size(); ++cell) {
    if ((exits_[cell] & kOpen) == 0) continue;
    std::uint32_t edges = 0;
    // Steps over one face, over two faces around an edge, or over three around a corner; each axis at most
    // once.
    const auto go = [&](auto&& self, std::size_t from, int bit, unsigned axes, int steps) -> void {
      for (std::size_t face = 0; face < 6; ++face) {
        const unsigned axis = 1U << face / 2;
        if ((axes & axis) != 0 || (exits_[from] >> face & 1U) == 0) continue;
        const int to_bit = bit + BitOf(kFaceNeighbors[face]) - kSelf;
        edges |= 1U << static_cast<unsigned>(to_bit);
        if (steps == 2) continue;
        const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from) + jumps[face]);
        self(self, to, to_bit, axes | axis, steps + 1);
      }
    };
    go(go, cell, kSelf, 0, 0);
    edges_[cell] = edges;
  }
}

void CoarseMap::Flood(std::size_t start, std::span<const std::size_t> wanted, std::uint32_t limit,
                      FloodState& state) const {
  auto& [buckets, costs, touched] = state;
  std::array<std::int32_t, 27> jumps{};
  for (int bit = 0; bit < 27; ++bit) {
    const VoxelIndex d = OffsetOf(bit);
    jumps[static_cast<std::size_t>(bit)] =
        static_cast<std::int32_t>(d.x + d.y * exits_.stride_y() + d.z * exits_.stride_z());
  }
  costs.resize(exits_.size(), kFar);
  for (const std::uint32_t cell : touched) costs[cell] = kFar;
  touched.assign(1, static_cast<std::uint32_t>(start));
  costs[start] = 0;
  buckets[0].push_back({static_cast<std::uint32_t>(start), kSelf});
  std::size_t waiting = 1;
  std::size_t known = 0;  // among those wanted
  for (std::uint32_t cost = 0; waiting > 0 && known < wanted.size() && cost <= limit; ++cost) {
    std::vector<Step>& bucket = buckets[cost % kBuckets];
    for (std::size_t n = 0; n < bucket.size(); ++n) {
      const auto [at, by] = bucket[n];
      --waiting;
      if (costs[at] != cost) continue;
      std::uint32_t edges = edges_[at];
      if (by != kSelf) {
        // Cells to which the previous cell has an edge as well are reached from there at no greater cost.
        const int shift = static_cast<int>(by) - kSelf;
        const std::uint32_t before = edges_[at - static_cast<std::uint32_t>(jumps[by])] | 1U << kSelf;
        edges &= ~((shift > 0 ? before >> shift : before << -shift) & kBeside[26 - by]);
      }
      for (; edges != 0; edges &= edges - 1) {
        const auto bit = static_cast<std::uint32_t>(std::countr_zero(edges));
        const std::uint32_t to = at + static_cast<std::uint32_t>(jumps[bit]);
        const std::uint32_t next_cost = cost + kCosts[bit];
        if (next_cost >= costs[to]) continue;
        if (costs[to] == kFar) touched.push_back(to);
        costs[to] = next_cost;
        buckets[next_cost % kBuckets].push_back({to, bit});
        ++waiting;
      }
    }
    bucket.clear();
    while (known < wanted.size() && costs[wanted[known]] <= cost) ++known;
  }
  for (std::vector<Step>& bucket : buckets) bucket.clear();
}

std::vector<double> CoarseMap::DistancesFrom(const VoxelIndex& place, std::span<const VoxelIndex> others,
                                             double within, FloodState& state) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double edge = 0.01 * kEdge * voxel_size_;  // [m] of one unit of cost
  const std::uint32_t limit = within < kInfinity ? static_cast<std::uint32_t>(within / edge) : kFar;
  std::vector<std::size_t> wanted;
  wanted.reserve(others.size());
  for (const VoxelIndex& other : others) wanted.push_back(CellOf(other));
  Flood(CellOf(place), wanted, limit, state);
  const double to_robot = search_.Length(place);
  std::vector<double> distances;
  distances.reserve(others.size());
  for (std::size_t n = 0; n < others.size(); ++n) {
    const std::uint32_t cost = state.costs[wanted[n]];
    if (cost > limit) {
      distances.push_back(kInfinity);
      continue;
    }
    const double straight = Straight(place, others[n]);
    const double over_robot = to_robot + search_.Length(others[n]);
    // Between neighboring cells the coarse cost means nothing.
    const double over_cells = cost > kNeighborsCost ? cost * edge : straight;
    distances.push_back(cost == kFar ? over_robot : std::max(straight, std::min(over_cells, over_robot)));
  }
  return distances;
}

double CoarseMap::Straight(const VoxelIndex& a, const VoxelIndex& b) const {
  const VoxelIndex d = a - b;
  return std::sqrt(static_cast<double>(d.x * d.x + d.y * d.y + d.z * d.z)) * voxel_size_;
}

double CoarseMap::LeastDistance(const VoxelIndex& a, const VoxelIndex& b) const {
  return std::max(Straight(a, b), std::abs(search_.Length(a) - search_.Length(b)));
}

std::vector<std::vector<double>> CoarseMap::DistancesFromEach(std::span<const VoxelIndex> places,
                                                              std::span<const VoxelIndex> others) const {
  std::vector<std::vector<double>> distances(places.size());
  ParallelFor(places.size(), 1, [&](std::size_t n) {
    FloodState state;
    distances[n] = DistancesFrom(places[n], others, std::numeric_limits<double>::infinity(), state);
  });
  return distances;
}

std::vector<std::vector<double>> CoarseMap::Distances(const std::vector<VoxelIndex>& places) {
  std::vector<std::vector<double>> distances(places.size(), std::vector<double>(places.size(), 0.0));
  for (std::size_t a = 0; a + 1 < places.size(); ++a) {
    const std::vector<double> further = DistancesFrom(places[a], std::span(places).subspan(a + 1));
    for (std::size_t b = a + 1; b < places.size(); ++b) {
      distances[a][b] = further[b - a - 1];
      distances[b][a] = distances[a][b];  // edges are symmetric
    }
  }
  return distances;
}

void CoarseMap::FindRegions() {
  region_ = DenseGrid<std::int32_t>(cells_box_, -1);
  std::vector<std::size_t> queue;
  for (std::size_t seed = 0; seed < unknown_.size(); ++seed) {
    if (unknown_[seed] < kMostlyUnknown || region_[seed] >= 0) continue;
    const auto number = static_cast<std::int32_t>(region_volume_.size());
    std::size_t volume = 0;
    queue.assign(1, seed);
    region_[seed] = number;
    while (!queue.empty()) {
      const std::size_t at = queue.back();
      queue.pop_back();
      volume += unknown_[at];
      for (const VoxelIndex& d : kFaceNeighbors) {
        const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + d.x +
                                                 d.y * unknown_.stride_y() + d.z * unknown_.stride_z());
        if (unknown_[to] < kMostlyUnknown || region_[to] >= 0) continue;
        region_[to] = number;
        queue.push_back(to);
      }
    }
    region_volume_.push_back(volume);
  }
}

std::vector<double> CoarseMap::WorthBehind(const std::vector<const std::vector<VoxelIndex>*>& groups,
                                           const std::function<double(double)>& worth) const {
  std::vector<std::map<std::int32_t, std::size_t>> touched(groups.size());
  std::vector<std::size_t> touching(region_volume_.size(), 0);
  for (std::size_t n = 0; n < groups.size(); ++n) {
    for (const VoxelIndex& i : *groups[n]) {
      std::int32_t region = region_[CellOf(i)];
      for (std::size_t face = 0; region < 0 && face < 6; ++face)
        region = region_[CellOf(i + kFaceNeighbors[face])];
      if (region < 0) continue;
      ++touched[n][region];
      ++touching[static_cast<std::size_t>(region)];
    }
  }
  std::vector<double> worths(groups.size(), 0.0);
  for (std::size_t n = 0; n < groups.size(); ++n) {
    for (const auto& [region, count] : touched[n]) {
      const auto r = static_cast<std::size_t>(region);
      worths[n] += worth(static_cast<double>(region_volume_[r])) * static_cast<double>(count) /
                   static_cast<double>(touching[r]);
    }
  }
  return worths;
}

}  // namespace thalweg::explorer
