#include "services/explorer/core/strategy/gaps.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "services/explorer/core/gaps/shadows.h"

namespace thalweg::explorer {
namespace {

constexpr double kLeastShadow = 0.1;  ///< [m^2] Smaller ones come from the cutting of walls into voxels.

VoxelIndex ColumnOf(const VoxelIndex& i) {
  return {i.x, i.y, 0};
}

/// The columns of what is explored: occupied where one voxel is, else free where one voxel is.
DenseGrid<VoxelState> ColumnsOf(const PlanningMap& map) {
  VoxelBox plane = map.box();
  plane.min.z = 0;
  plane.max.z = 1;
  DenseGrid<VoxelState> columns(plane, VoxelState::kUnknown);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    VoxelIndex i = columns.IndexAt(k);
    const int end = std::min(map.bounds().max.z, map.box().max.z);
    for (i.z = std::max(map.bounds().min.z, map.box().min.z); i.z < end; ++i.z) {
      if (map.State(i) == VoxelState::kOccupied) columns[k] = VoxelState::kOccupied;
      if (map.State(i) == VoxelState::kFree && columns[k] == VoxelState::kUnknown)
        columns[k] = VoxelState::kFree;
    }
  }
  return columns;
}

/// The columns of a candidate's unknown voxels, each as often as it has some; of one that is occupied
/// elsewhere, those beside it.
std::vector<VoxelIndex> ColumnsOf(const Candidate& candidate, const DenseGrid<VoxelState>& columns) {
  std::vector<VoxelIndex> its;
  const auto add = [&](const VoxelIndex& column) {
    if (columns.Get(column, VoxelState::kOccupied) == VoxelState::kOccupied) return false;
    its.push_back(column);
    return true;
  };
  for (const VoxelIndex& i : candidate.cluster.unknowns) {
    if (add(ColumnOf(i))) continue;
    for (const VoxelIndex& step : kStepsInPlane) {
      if (columns.Get(ColumnOf(i) + step, VoxelState::kUnknown) == VoxelState::kFree) add(ColumnOf(i) + step);
    }
  }
  return its;
}

/// What hides most of the columns; nothing if most are hidden by nothing.
std::optional<GapTracker::Node> LeafOf(const std::vector<VoxelIndex>& columns, const GapTracker& tree) {
  std::map<std::optional<GapTracker::Node>, std::size_t> counts;
  for (const VoxelIndex& column : columns) ++counts[tree.LeafAt(column)];
  if (2 * counts[std::nullopt] >= columns.size()) return std::nullopt;
  counts.erase(std::nullopt);
  return std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; })->first;
}

}  // namespace

Choice Gaps::Choose(const Situation& situation) {
  const std::vector<Leaf> leaves = FindLeaves(situation);
  const Leaf next = NextLeaf(leaves);
  std::optional<std::size_t> nearest;
  const auto effort = [&](std::size_t n) {
    return situation.candidates[n].length + situation.candidates[n].turn;
  };
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    if (leaves[n] == next && (!nearest || effort(n) < effort(*nearest))) nearest = n;
  }
  return StraightTo(situation, *nearest);
}

std::vector<Gaps::Leaf> Gaps::FindLeaves(const Situation& situation) {
  const PlanningMap& map = situation.map;
  const DenseGrid<VoxelState> columns = ColumnsOf(map);
  DenseGrid<PlaneCell> plane(columns.box(), PlaneCell::kWall);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] == VoxelState::kFree) plane[k] = PlaneCell::kFree;
  }
  std::vector<std::vector<VoxelIndex>> unseen;
  for (const Candidate& candidate : situation.candidates) {
    unseen.push_back(ColumnsOf(candidate, columns));
    for (const VoxelIndex& column : unseen.back()) {
      if (plane[column] == PlaneCell::kWall) plane[column] = PlaneCell::kUnseen;
    }
  }
  tree_.Update(FindShadows(plane, ColumnOf(map.IndexOf(situation.robot_W)),
                           VoxelsOfArea(kLeastShadow, map.voxel_size())));
  std::vector<Leaf> leaves;
  for (const std::vector<VoxelIndex>& its : unseen) leaves.push_back(LeafOf(its, tree_));
  return leaves;
}

Gaps::Leaf Gaps::NextLeaf(const std::vector<Leaf>& leaves) {
  const auto hides_some = [&](const Leaf& leaf) { return std::ranges::count(leaves, leaf) > 0; };
  if (hides_some(Leaf())) return std::nullopt;
  if (hides_some(chosen_)) return chosen_;
  chosen_ = std::ranges::min(leaves, {}, [&](const Leaf& leaf) {
    return std::tuple(tree_.Level(*leaf), -static_cast<std::ptrdiff_t>(*leaf));
  });
  return chosen_;
}

}  // namespace thalweg::explorer
