#include "services/explorer/core/potential.h"

#include <algorithm>

#include "common/voxel/ray.h"
#include "services/explorer/core/field/streamline.h"

namespace thalweg::explorer {
namespace {

/// Keeps a candidate that is at hand from having infinite flux per metre.
constexpr double kLeastLength = 0.1;

DenseGrid<std::int32_t> GroupsOf(const Situation& situation, const DenseGrid<FieldCell>& cells) {
  DenseGrid<std::int32_t> groups(cells.box(), -1);
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    for (const VoxelIndex& goal : situation.candidates[n].goals) {
      if (cells[goal] == FieldCell::kSink) groups[goal] = static_cast<std::int32_t>(n);
    }
  }
  return groups;
}

/// The centres of the voxels that a streamline crosses. The line may run along the very faces of free space,
/// where walls are nearer than the clearance; between the centres of face neighbours they never are.
std::vector<Eigen::Vector3d> CentersAlong(const std::vector<Eigen::Vector3d>& line_W,
                                          const PlanningMap& map) {
  std::vector<Eigen::Vector3d> centers_W = {map.CenterOf(map.IndexOf(line_W.front()))};
  for (std::size_t n = 1; n < line_W.size(); ++n) {
    TraverseVoxels(line_W[n - 1], line_W[n], map.voxel_size(), [&](const VoxelIndex& i) {
      const Eigen::Vector3d center_W = map.CenterOf(i);
      if (center_W != centers_W.back()) centers_W.push_back(center_W);
      return true;
    });
  }
  return centers_W;
}

}  // namespace

DenseGrid<FieldCell> Potential::MakeCells(const Situation& situation) const {
  const PlanningMap& map = situation.map;
  DenseGrid<FieldCell> cells(map.box(), FieldCell::kWall);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const VoxelIndex i = cells.IndexAt(k);
    if (!situation.search.Reached(i)) continue;
    const bool source = (map.CenterOf(i) - situation.robot_W).norm() <= options_.source_radius;
    cells[k] = source ? FieldCell::kSource : FieldCell::kFree;
  }
  for (const PathSearch::Entry& entry : situation.search.start()) cells[entry.voxel] = FieldCell::kSource;
  for (const Candidate& candidate : situation.candidates) {
    for (const VoxelIndex& goal : candidate.goals) {
      if (cells[goal] == FieldCell::kFree) cells[goal] = FieldCell::kSink;
    }
  }
  return cells;
}

Choice Potential::Choose(const Situation& situation) {
  // What lies within the source needs no field: it is at hand.
  const auto at_hand =
      std::min_element(situation.candidates.begin(), situation.candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.length < b.length; });
  if (at_hand->length <= options_.source_radius) {
    return {.candidate = static_cast<std::size_t>(at_hand - situation.candidates.begin()),
            .path_W = ShortestPath(situation, *at_hand)};
  }

  const DenseGrid<FieldCell> cells = MakeCells(situation);
  HarmonicField::Options options;
  options.relative_residual = options_.relative_residual;
  options.screening_length_cells = options_.screening_length / situation.map.voxel_size();
  const DenseGrid<float>& phi = field_.Solve(cells, options);
  const std::vector<double> flux =
      HarmonicField::InflowOf(cells, phi, GroupsOf(situation, cells), situation.candidates.size());

  std::size_t best = 0;
  double best_score = -1.0;
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    const double score = flux[n] / (situation.candidates[n].length + kLeastLength);
    if (score > best_score) {
      best = n;
      best_score = score;
    }
  }
  const FieldStatistics& statistics = field_.statistics();
  return {.candidate = best,
          .path_W = TraceBack(situation, cells, situation.candidates[best]),
          .field_ms = statistics.setup_ms + statistics.solve_ms};
}

std::vector<Eigen::Vector3d> Potential::TraceBack(const Situation& situation,
                                                  const DenseGrid<FieldCell>& cells,
                                                  const Candidate& candidate) const {
  const PlanningMap& map = situation.map;
  const Streamline line =
      TraceStreamline(cells, field_.phi(), map.voxel_size(), map.CenterOf(candidate.goals.front()),
                      /*upwards=*/true, {});
  if (line.end != StreamlineEnd::kArrived) return ShortestPath(situation, candidate);
  // From the source's rim to the robot itself on the shortest path.
  std::vector<Eigen::Vector3d> path_W = {situation.robot_W};
  for (const VoxelIndex& voxel : situation.search.PathTo(map.IndexOf(line.points_W.back()))) {
    path_W.push_back(map.CenterOf(voxel));
  }
  const std::vector<Eigen::Vector3d> centers_W = CentersAlong(line.points_W, map);
  path_W.insert(path_W.end(), centers_W.rbegin() + 1, centers_W.rend());
  return PullStraight(map, path_W, situation.clearance);
}

}  // namespace thalweg::explorer
