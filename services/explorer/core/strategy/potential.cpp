#include "services/explorer/core/strategy/potential.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"
#include "services/explorer/core/field/streamline.h"

namespace thalweg::explorer {
namespace {

/// [m] Added to path lengths, so that the flux per meter stays finite for a candidate beside the robot.
constexpr double kLeastLength = 0.1;

FieldCell SinkOf(const Candidate& candidate) {
  return candidate.cluster.doubtful ? FieldCell::kWeakSink : FieldCell::kSink;
}

DenseGrid<std::int32_t> GroupsOf(const Situation& situation, const DenseGrid<FieldCell>& cells) {
  DenseGrid<std::int32_t> groups(cells.box(), -1);
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    for (const VoxelIndex& goal : situation.candidates[n].goals) {
      if (cells[goal] == SinkOf(situation.candidates[n])) groups[goal] = static_cast<std::int32_t>(n);
    }
  }
  return groups;
}

/// The centers of the voxels that a streamline crosses [m]. The streamline itself may run along the faces of
/// traversable voxels, where walls can be nearer than the clearance; on a line between the centers of face
/// neighbors they cannot.
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

Potential::Options Potential::Options::FluxPerLength() const {
  Options options = *this;
  options.source_radius = 0.3;
  options.cluster = Cluster::kFluxPerLength;
  options.path = Path::kTraceBack;
  options.seal = true;
  return options;
}

void Visit(OptionVisitor& visitor, Potential::Options& options) {
  using Sink = Potential::Options::Cluster;
  using Path = Potential::Options::Path;
  visitor.Block("potential", [&](OptionVisitor& potential) {
    potential.Number("source_radius_m", options.source_radius);
    potential.Number("screening_length_m", options.screening_length);
    potential.Number("relative_residual", options.relative_residual);
    potential.Choice("cluster", options.cluster,
                     {{"STREAMLINE_END", Sink::kStreamline},
                      {"FLUX", Sink::kFlux},
                      {"FLUX_PER_LENGTH", Sink::kFluxPerLength}});
    potential.Choice(
        "path", options.path,
        {{"STREAMLINE", Path::kStreamline}, {"SHORTEST", Path::kShortest}, {"TRACE_BACK", Path::kTraceBack}});
    potential.Switch("seal", options.seal);
    using Solver = HarmonicField::Solver;
    potential.Choice("solver", options.solver,
                     {{"AUTOMATIC", Solver::kAutomatic}, {"CPU", Solver::kCpu}, {"GPU", Solver::kGpu}});
    potential.Whole("threads", options.threads);
  });
}

Potential::Potential(const Options& options)
    : options_(options), field_(options.seal ? SealedField::Options{} : SealedField::Options::Never()) {
  if (!(options.source_radius >= 0.0)) throw std::invalid_argument("source_radius must be >= 0");
  if (options.solver == HarmonicField::Solver::kGpu) HarmonicField::RequireGpu();
  if (!(options.screening_length >= 0.0)) throw std::invalid_argument("screening_length must be >= 0");
  if (options.path == Options::Path::kStreamline && options.cluster != Options::Cluster::kStreamline) {
    throw std::invalid_argument(
        "path STREAMLINE leads where the streamline ends: with another choice of the cluster, path must be "
        "SHORTEST or TRACE_BACK");
  }
}

std::vector<VoxelIndex> Potential::sealed() const {
  if (!has_field_) return {};
  std::vector<VoxelIndex> cells = field_.sealed();
  // What was found sealed in this field still has a value in it.
  std::erase_if(cells, [&](const VoxelIndex& cell) { return !std::isnan(field_.phi()[cell]); });
  return cells;
}

DenseGrid<FieldCell> Potential::MakeCells(const Situation& situation) const {
  const PlanningMap& map = situation.map;
  DenseGrid<FieldCell> cells(map.box(), FieldCell::kWall);
  const DenseGrid<std::uint32_t>& costs = situation.search.costs();
  THALWEG_CHECK(costs.box() == cells.box());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    cells[k] = costs[k] == PathSearch::kUnreached ? FieldCell::kWall : FieldCell::kFree;
  }
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(options_.source_radius);
  const VoxelBox around{map.IndexOf(situation.robot_W - reach),
                        map.IndexOf(situation.robot_W + reach) + VoxelIndex{1, 1, 1}};
  ForEachVoxel(around, [&](const VoxelIndex& i) {
    if (cells.Get(i, FieldCell::kWall) != FieldCell::kFree) return;
    if ((map.CenterOf(i) - situation.robot_W).norm() <= options_.source_radius) cells[i] = FieldCell::kSource;
  });
  for (const PathSearch::Entry& entry : situation.search.start()) cells[entry.voxel] = FieldCell::kSource;
  for (const Candidate& candidate : situation.candidates) {
    for (const VoxelIndex& goal : candidate.goals) {
      FieldCell& cell = cells[goal];
      if (cell == FieldCell::kFree || cell == FieldCell::kWeakSink) cell = SinkOf(candidate);
    }
  }
  return cells;
}

Choice Potential::Choose(const Situation& situation) {
  // A candidate within the source is beside the robot and needs no field.
  const std::size_t at_hand = NearestCandidate(situation);
  has_field_ = situation.candidates[at_hand].length > options_.source_radius;
  if (!has_field_) return StraightTo(situation, at_hand);

  DenseGrid<FieldCell> cells = MakeCells(situation);
  Solve(situation, cells);
  const DenseGrid<std::int32_t> groups = GroupsOf(situation, cells);
  Choice choice = options_.cluster == Options::Cluster::kStreamline
                      ? FollowStreamline(situation, cells, groups)
                      : ByFlux(situation, cells, groups);
  const Candidate& candidate = situation.candidates[choice.candidate];
  if (options_.path == Options::Path::kShortest) {
    choice.path_W = ShortestPath(situation, candidate.goals.front());
  } else if (options_.path == Options::Path::kTraceBack) {
    choice.path_W = TraceBack(situation, cells, candidate);
  }
  return choice;
}

void Potential::Solve(const Situation& situation, DenseGrid<FieldCell>& cells) {
  // The shortest path to each candidate stays open, so that the candidate stays connected to the robot.
  std::vector<VoxelIndex> paths;
  for (const Candidate& candidate : situation.candidates) {
    if (!options_.seal) break;
    const std::vector<VoxelIndex> path = situation.search.PathTo(candidate.goals.front());
    paths.insert(paths.end(), path.begin(), path.end());
  }
  field_.Solve(cells,
               {.relative_residual = options_.relative_residual,
                .screening_length_cells = options_.screening_length / situation.map.voxel_size(),
                .weak_sink = situation.map.options().doubt.weight,
                .threads = options_.threads,
                .solver = options_.solver},
               paths);
}

Choice Potential::ByFlux(const Situation& situation, const DenseGrid<FieldCell>& cells,
                         const DenseGrid<std::int32_t>& groups) const {
  std::vector<double> scores =
      HarmonicField::InflowOf(cells, field_.phi(), groups, situation.candidates.size());
  if (options_.cluster == Options::Cluster::kFluxPerLength) {
    for (std::size_t n = 0; n < scores.size(); ++n)
      scores[n] /= situation.candidates[n].length + kLeastLength;
  }
  const auto best = std::max_element(scores.begin(), scores.end()) - scores.begin();
  Choice choice = StraightTo(situation, static_cast<std::size_t>(best));
  choice.scores = std::move(scores);
  return choice;
}

Choice Potential::FollowStreamline(const Situation& situation, const DenseGrid<FieldCell>& cells,
                                   const DenseGrid<std::int32_t>& groups) const {
  const PlanningMap& map = situation.map;
  const VoxelIndex start = situation.search.start().front().voxel;
  const Streamline line = TraceStreamline(cells, field_.phi(), map.voxel_size(), map.CenterOf(start),
                                          /*upward=*/false, {});
  const std::int32_t group = groups.Get(map.IndexOf(line.points_W.back()), -1);
  if (line.end != StreamlineEnd::kArrived || group < 0)
    return StraightTo(situation, NearestCandidate(situation));
  std::vector<Eigen::Vector3d> path_W = {situation.robot_W};
  const std::vector<Eigen::Vector3d> centers_W = CentersAlong(line.points_W, map);
  path_W.insert(path_W.end(), centers_W.begin(), centers_W.end());
  return {.candidate = static_cast<std::size_t>(group), .path_W = Straightened(situation, std::move(path_W))};
}

std::vector<Eigen::Vector3d> Potential::TraceBack(const Situation& situation,
                                                  const DenseGrid<FieldCell>& cells,
                                                  const Candidate& candidate) const {
  const PlanningMap& map = situation.map;
  const Streamline line =
      TraceStreamline(cells, field_.phi(), map.voxel_size(), map.CenterOf(candidate.goals.front()),
                      /*upward=*/true, {});
  if (line.end != StreamlineEnd::kArrived) return ShortestPath(situation, candidate.goals.front());
  // The streamline ends at the rim of the source; the shortest path leads from there to the robot.
  std::vector<Eigen::Vector3d> path_W =
      situation.search.PathFrom(map, situation.robot_W, map.IndexOf(line.points_W.back()));
  const std::vector<Eigen::Vector3d> centers_W = CentersAlong(line.points_W, map);
  path_W.insert(path_W.end(), centers_W.rbegin() + 1, centers_W.rend());
  return Straightened(situation, std::move(path_W));
}

}  // namespace thalweg::explorer
