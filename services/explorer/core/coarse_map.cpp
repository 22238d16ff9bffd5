#include "services/explorer/core/coarse_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace thalweg::explorer {
namespace {

constexpr std::uint8_t kOpen = 1U << 6U;  // beside a bit a face neighbour
constexpr std::uint32_t kFar = std::numeric_limits<std::uint32_t>::max();
constexpr std::array<std::uint32_t, 4> kStepCost = {0, 100, 141, 173};
constexpr std::size_t kBuckets = 174;
constexpr std::uint32_t kNeighbours = 200;
constexpr int kMostlyUnknown = CoarseMap::kEdge * CoarseMap::kEdge * CoarseMap::kEdge / 2 + 1;

}  // namespace

CoarseMap::CoarseMap(const PlanningMap& map, const PathSearch& search)
    : search_(search), voxel_size_(map.voxel_size()), origin_(map.box().min) {
  // One cell of margin all around, so that neighbours are found by offsets alone.
  const VoxelBox& box = map.box();
  const auto cells = [](int voxels) { return (voxels + kEdge - 1) / kEdge + 1; };
  cells_box_ = {{-1, -1, -1}, {cells(box.size_x()), cells(box.size_y()), cells(box.size_z())}};
  exits_ = DenseGrid<std::uint8_t>(cells_box_, 0);
  unknown_ = DenseGrid<std::uint8_t>(cells_box_, 0);
  const DenseGrid<VoxelState>& states = map.states();
  VoxelIndex i;
  for (i.z = box.min.z; i.z < box.max.z; ++i.z) {
    for (i.y = box.min.y; i.y < box.max.y; ++i.y) {
      std::size_t k = states.Offset({box.min.x, i.y, i.z});
      for (i.x = box.min.x; i.x < box.max.x; ++i.x, ++k) {
        if (states[k] == VoxelState::kUnknown) {
          if (map.InBounds(i)) ++unknown_[CellOf(i)];
          continue;
        }
        ++known_;
        if (!search.Reached(i)) continue;
        std::uint8_t& exits = exits_[CellOf(i)];
        exits |= kOpen;
        const int within[3] = {(i.x - origin_.x) % kEdge, (i.y - origin_.y) % kEdge,
                               (i.z - origin_.z) % kEdge};
        for (unsigned face = 0; face < 6; ++face) {
          const VoxelIndex& d = kFaceNeighbours[face];
          const int at = d.x != 0 ? within[0] : d.y != 0 ? within[1] : within[2];
          if (at == (d.x + d.y + d.z > 0 ? kEdge - 1 : 0) && search.Reached(i + d)) {
            exits = static_cast<std::uint8_t>(exits | 1U << face);
          }
        }
      }
    }
  }
  FindEdges();
  FindRegions();
}

std::size_t CoarseMap::CellOf(const VoxelIndex& voxel) const {
  return exits_.Offset(
      {(voxel.x - origin_.x) / kEdge, (voxel.y - origin_.y) / kEdge, (voxel.z - origin_.z) / kEdge});
}

void CoarseMap::FindEdges() {
  std::array<std::ptrdiff_t, 6> jumps{};
  for (std::size_t face = 0; face < 6; ++face) {
    const VoxelIndex& d = kFaceNeighbours[face];
    jumps[face] = d.x + d.y * exits_.stride_y() + d.z * exits_.stride_z();
  }
  const auto axis_of = [](std::size_t face) { return static_cast<unsigned>(face / 2); };
  first_edge_.reserve(exits_.size() + 1);
  for (std::size_t cell = 0; cell < exits_.size(); ++cell) {
    first_edge_.push_back(static_cast<std::uint32_t>(edges_.size()));
    if ((exits_[cell] & kOpen) == 0) continue;
    const auto first = static_cast<std::ptrdiff_t>(edges_.size());
    // Over one face, over two about an edge, over three about a corner: each axis at most once.
    const auto go = [&](auto&& self, std::size_t from, unsigned axes, unsigned steps) -> void {
      for (std::size_t face = 0; face < 6; ++face) {
        const unsigned axis = 1U << axis_of(face);
        if ((axes & axis) != 0 || (exits_[from] >> face & 1U) == 0) continue;
        const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from) + jumps[face]);
        const bool fresh = std::none_of(edges_.begin() + first, edges_.end(),
                                        [&](const Edge& edge) { return edge.to == to; });
        if (fresh) edges_.push_back({static_cast<std::uint32_t>(to), kStepCost[steps + 1]});
        if (steps < 2) self(self, to, axes | axis, steps + 1);
      }
    };
    go(go, cell, 0, 0);
  }
  first_edge_.push_back(static_cast<std::uint32_t>(edges_.size()));
}

void CoarseMap::Flood(std::size_t start, std::vector<std::uint8_t>& wanted, std::size_t left,
                      std::vector<std::uint32_t>& costs) const {
  costs.assign(exits_.size(), kFar);
  std::array<std::vector<std::uint32_t>, kBuckets> buckets;
  buckets[0].push_back(static_cast<std::uint32_t>(start));
  costs[start] = 0;
  std::size_t waiting = 1;
  for (std::uint32_t cost = 0; waiting > 0 && left > 0; ++cost) {
    std::vector<std::uint32_t>& bucket = buckets[cost % kBuckets];
    for (std::size_t n = 0; n < bucket.size(); ++n) {
      const std::uint32_t at = bucket[n];
      --waiting;
      if (costs[at] != cost) continue;
      if (wanted[at] != 0) {
        wanted[at] = 0;
        --left;
      }
      for (std::uint32_t k = first_edge_[at]; k < first_edge_[at + 1]; ++k) {
        const std::uint32_t next_cost = cost + edges_[k].cost;
        if (next_cost >= costs[edges_[k].to]) continue;
        costs[edges_[k].to] = next_cost;
        buckets[next_cost % kBuckets].push_back(edges_[k].to);
        ++waiting;
      }
    }
    bucket.clear();
  }
}

std::vector<double> CoarseMap::DistancesFrom(const VoxelIndex& place,
                                             std::span<const VoxelIndex> others) const {
  std::vector<std::uint8_t> wanted(exits_.size(), 0);
  std::size_t left = 0;
  for (const VoxelIndex& other : others) {
    std::uint8_t& is_wanted = wanted[CellOf(other)];
    left += is_wanted == 0 ? 1 : 0;
    is_wanted = 1;
  }
  std::vector<std::uint32_t> costs;
  Flood(CellOf(place), wanted, left, costs);
  std::vector<double> distances;
  distances.reserve(others.size());
  for (const VoxelIndex& other : others) {
    const std::uint32_t cost = costs[CellOf(other)];
    const VoxelIndex d = place - other;
    const double straight = std::sqrt(static_cast<double>(d.x * d.x + d.y * d.y + d.z * d.z)) * voxel_size_;
    const double over_robot = search_.Length(place) + search_.Length(other);
    // Between neighbours cells say nothing.
    const double over_cells = cost > kNeighbours ? cost * 0.01 * kEdge * voxel_size_ : straight;
    distances.push_back(cost == kFar ? over_robot : std::max(straight, std::min(over_cells, over_robot)));
  }
  return distances;
}

std::vector<std::vector<double>> CoarseMap::Distances(const std::vector<VoxelIndex>& places) const {
  std::vector<std::vector<double>> distances(places.size(), std::vector<double>(places.size(), 0.0));
  for (std::size_t a = 0; a + 1 < places.size(); ++a) {
    const std::vector<double> further = DistancesFrom(places[a], std::span(places).subspan(a + 1));
    for (std::size_t b = a + 1; b < places.size(); ++b) {
      distances[a][b] = further[b - a - 1];
      distances[b][a] = distances[a][b];  // what opens to one side opens to the other
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
      for (const VoxelIndex& d : kFaceNeighbours) {
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
        region = region_[CellOf(i + kFaceNeighbours[face])];
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
