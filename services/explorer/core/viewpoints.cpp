#include "services/explorer/core/viewpoints.h"

#include <algorithm>

namespace thalweg::explorer {
namespace {

constexpr int kEdge = 3;
constexpr std::size_t kRays = 150;
constexpr std::size_t kSamples = 6;
constexpr std::size_t kTries = 40;  ///< Places looked at closely.

std::vector<VoxelIndex> SamplesOf(const std::vector<VoxelIndex>& unknowns) {
  std::vector<VoxelIndex> samples;
  const std::size_t count = std::min(kSamples, unknowns.size());
  for (std::size_t n = 0; n < count; ++n) samples.push_back(unknowns[n * unknowns.size() / count]);
  return samples;
}

}  // namespace

Viewpoints::Viewpoints(const Situation& situation)
    : situation_(situation), rays_(SpreadRays(kRays, situation.look_range, situation.map.voxel_size())) {
  const VoxelBox& box = situation.map.box();
  const auto cells = [](int voxels) { return (voxels + kEdge - 1) / kEdge; };
  cells_ = DenseGrid<Cell>({{0, 0, 0}, {cells(box.size_x()), cells(box.size_y()), cells(box.size_z())}}, {});
}

bool Viewpoints::Sees(const VoxelIndex& from, const VoxelIndex& unknown) const {
  const Eigen::Vector3d p_W = situation_.map.EyeAt(situation_.map.CenterOf(from));
  const Eigen::Vector3d q_W = situation_.map.CenterOf(unknown);
  return (q_W - p_W).norm() <= situation_.look_range && situation_.views.CanShow(q_W - p_W) &&
         situation_.map.InSight(p_W, q_W);
}

VoxelIndex Viewpoints::Nearest(const Candidate& candidate) {
  const PlanningMap& map = situation_.map;
  const PathSearch& search = situation_.search;
  const VoxelIndex& goal = candidate.goals.front();
  const std::vector<VoxelIndex> samples = SamplesOf(candidate.cluster.unknowns);
  std::vector<VoxelIndex> wanted;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(wanted),
               [&](const VoxelIndex& i) { return Sees(goal, i); });
  if (wanted.empty()) return goal;
  const auto sees_enough = [&](const VoxelIndex& from) {
    const auto seen = static_cast<std::size_t>(
        std::count_if(wanted.begin(), wanted.end(), [&](const VoxelIndex& i) { return Sees(from, i); }));
    return 4 * seen >= 3 * wanted.size();
  };

  ++round_;
  const std::uint32_t cost_of_goal = search.Cost(goal);
  std::vector<std::size_t> crossed;
  for (const VoxelIndex& unknown : wanted) {
    for (const std::vector<RayStep>& ray : rays_) {
      for (const RayStep& step : ray) {
        const VoxelIndex eye = unknown + step.offset;
        if (map.State(eye) != VoxelState::kFree) break;
        const VoxelIndex i = map.BodyOf(eye);
        const std::uint32_t cost = search.Cost(i);
        if (cost >= cost_of_goal) continue;  // or out of reach
        const VoxelIndex at = i - map.box().min;
        const std::size_t k = cells_.Offset({at.x / kEdge, at.y / kEdge, at.z / kEdge});
        Cell& cell = cells_[k];
        if (cell.round != round_) crossed.push_back(k);
        if (cell.round != round_ || cost < cell.cost) cell = {.round = round_, .cost = cost, .place = i};
      }
    }
  }
  const std::size_t tries = std::min(kTries, crossed.size());
  std::partial_sort(crossed.begin(), crossed.begin() + static_cast<std::ptrdiff_t>(tries), crossed.end(),
                    [&](std::size_t a, std::size_t b) {
                      return cells_[a].cost != cells_[b].cost ? cells_[a].cost < cells_[b].cost : a < b;
                    });
  VoxelIndex best = goal;
  for (std::size_t n = 0; n < tries; ++n) {
    if (!sees_enough(cells_[crossed[n]].place)) continue;
    best = cells_[crossed[n]].place;
    break;
  }
  const std::vector<VoxelIndex> way = search.PathTo(goal);
  for (std::size_t n = way.size(); n-- > 0 && sees_enough(way[n]);) {
    if (search.Cost(way[n]) < search.Cost(best)) best = way[n];
  }
  return best;
}

}  // namespace thalweg::explorer
