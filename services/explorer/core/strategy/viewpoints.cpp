#include "services/explorer/core/strategy/viewpoints.h"

#include <algorithm>

namespace thalweg::explorer {
namespace {

constexpr int kEdge = 3;  // [voxels] Edge of a cell.
constexpr std::size_t kViewpointRays = 150;
constexpr std::size_t kSamples = 6;
constexpr std::size_t kTries = 60;  // Positions whose view is examined.

struct Cell {
  std::uint32_t cost = PathSearch::kUnreached;  ///< The cheapest position's in it.
  VoxelIndex place;
};

}  // namespace

Viewpoints::Viewpoints(const Situation& situation)
    : situation_(situation),
      wanted_(situation.candidates.size()),
      rays_(SpreadRays(kViewpointRays, situation.look_range, situation.map.voxel_size())) {}

bool Viewpoints::Sees(const VoxelIndex& from, const VoxelIndex& unknown) const {
  const Eigen::Vector3d p_W = situation_.map.EyeAt(situation_.map.CenterOf(from));
  const Eigen::Vector3d q_W = situation_.map.CenterOf(unknown);
  return situation_.views.CanSee(situation_.map, p_W, q_W, situation_.look_range);
}

const std::vector<VoxelIndex>& Viewpoints::WantedOf(std::size_t candidate) {
  std::optional<std::vector<VoxelIndex>>& wanted = wanted_[candidate];
  if (!wanted) {
    const Candidate& its = situation_.candidates[candidate];
    wanted.emplace();
    for (const VoxelIndex& i : SpreadSample(its.cluster.unknowns, kSamples)) {
      if (Sees(its.goals.front(), i)) wanted->push_back(i);
    }
  }
  return *wanted;
}

bool Viewpoints::SeesEnough(const VoxelIndex& from, std::size_t candidate) {
  const std::vector<VoxelIndex>& wanted = WantedOf(candidate);
  if (wanted.empty()) return from == situation_.candidates[candidate].goals.front();
  std::size_t missing = 0;
  return std::all_of(wanted.begin(), wanted.end(), [&](const VoxelIndex& i) {
    missing += Sees(from, i) ? 0 : 1;
    return 4 * missing <= wanted.size();
  });
}

std::vector<VoxelIndex> Viewpoints::PlacesBefore(std::size_t candidate) {
  const PlanningMap& map = situation_.map;
  std::vector<VoxelIndex> places;
  for (const VoxelIndex& unknown : WantedOf(candidate)) {
    for (const std::vector<RayStep>& ray : rays_) {
      for (const RayStep& step : ray) {
        const VoxelIndex eye = unknown + step.offset;
        if (map.State(eye) != VoxelState::kFree) break;
        if (situation_.search.Reached(map.BodyOf(eye))) places.push_back(map.BodyOf(eye));
      }
    }
  }
  return places;
}

std::vector<VoxelIndex> Viewpoints::PlacesFor(std::size_t candidate, const std::vector<VoxelIndex>& before,
                                              const Cost& cost_of) {
  const VoxelBox& box = situation_.map.box();
  const auto count = [](int voxels) { return (voxels + kEdge - 1) / kEdge; };
  DenseGrid<Cell> cells({{0, 0, 0}, {count(box.size_x()), count(box.size_y()), count(box.size_z())}}, {});
  std::vector<std::size_t> crossed;
  for (const VoxelIndex& place : before) {
    const std::uint32_t cost = cost_of(place);
    if (cost == PathSearch::kUnreached) continue;
    const VoxelIndex at = place - box.min;
    const std::size_t k = cells.Offset({at.x / kEdge, at.y / kEdge, at.z / kEdge});
    if (cells[k].cost == PathSearch::kUnreached) crossed.push_back(k);
    if (cost < cells[k].cost) cells[k] = {.cost = cost, .place = place};
  }
  const std::size_t tries = std::min(kTries, crossed.size());
  std::partial_sort(crossed.begin(), crossed.begin() + static_cast<std::ptrdiff_t>(tries), crossed.end(),
                    [&](std::size_t a, std::size_t b) {
                      return cells[a].cost != cells[b].cost ? cells[a].cost < cells[b].cost : a < b;
                    });
  std::vector<VoxelIndex> places = {situation_.candidates[candidate].goals.front()};
  for (std::size_t n = 0; n < tries; ++n) {
    const VoxelIndex& place = cells[crossed[n]].place;
    if (SeesEnough(place, candidate)) places.push_back(place);
  }
  return places;
}

}  // namespace thalweg::explorer
