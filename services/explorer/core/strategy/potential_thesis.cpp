#include "services/explorer/core/strategy/potential_thesis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "services/explorer/core/map/free_frontier.h"

namespace thalweg::explorer {
namespace {

/// Whether a voxel belongs to the domain: free, and no nearer to an obstacle or a no-go box than the robot's
/// size.
bool InDomain(const PlanningMap& map, double clearance, const VoxelIndex& i) {
  if (map.State(i) != VoxelState::kFree || !map.InBounds(i)) return false;
  if (map.plane() && VoxelAt({0.0, 0.0, *map.plane()}, map.voxel_size()).z != i.z) return false;
  // Most voxels are even farther from whatever is unknown.
  if (clearance <= map.options().clearance && map.Traversable(i)) return true;
  constexpr double kTouch = 1e-6;  // [m]
  const auto in_reach = [&](const Eigen::AlignedBox3d& box_W) {
    return map.Touches(box_W, map.CenterOf(i), clearance - kTouch);
  };
  if (std::ranges::any_of(map.options().no_go, in_reach)) return false;
  return map.ClearanceAt(map.CenterOf(i), PlanningMap::Obstacles::kOccupied, clearance) >= clearance - kTouch;
}

/// The domain; all else is wall.
DenseGrid<FieldCell> DomainOf(const PlanningMap& map, double clearance) {
  DenseGrid<FieldCell> cells(map.box(), FieldCell::kWall);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (InDomain(map, clearance, cells.IndexAt(k))) cells[k] = FieldCell::kFree;
  }
  return cells;
}

/// Nonzero for the cells that steps from face to face connect with the robot's.
DenseGrid<std::uint8_t> ConnectedWith(const VoxelIndex& robot, const DenseGrid<FieldCell>& domain) {
  DenseGrid<std::uint8_t> connected(domain.box(), 0);
  std::vector<VoxelIndex> queue = {robot};
  for (std::size_t k = 0; k < queue.size(); ++k) {
    for (const VoxelIndex& step : kFaceNeighbors) {
      const VoxelIndex next = queue[k] + step;
      if (domain.Get(next, FieldCell::kWall) == FieldCell::kWall || connected[next] != 0) continue;
      connected[next] = 1;
      queue.push_back(next);
    }
  }
  return connected;
}

/// What the body can reach.
DenseGrid<FieldCell> DomainOf(const PathSearch& search) {
  DenseGrid<FieldCell> cells(search.costs().box(), FieldCell::kWall);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (search.costs()[k] != PathSearch::kUnreached) cells[k] = FieldCell::kFree;
  }
  return cells;
}

DenseGrid<FieldCell> MakeCells(const Situation& situation, PotentialThesis::Options::Domain domain) {
  const PlanningMap& map = situation.map;
  DenseGrid<FieldCell> cells = domain == PotentialThesis::Options::Domain::kFree
                                   ? DomainOf(map, situation.clearance)
                                   : DomainOf(situation.search);
  for (const Candidate& candidate : situation.candidates) {
    for (const VoxelIndex& goal : candidate.goals) cells[goal] = FieldCell::kSink;
  }
  cells[map.IndexOf(situation.robot_W)] = FieldCell::kSource;
  return cells;
}

template <typename To, typename From>
DenseGrid<To> Converted(const DenseGrid<From>& from) {
  DenseGrid<To> to(from.box(), To{});
  std::copy_n(from.data(), from.size(), to.data());
  return to;
}

std::size_t CandidateWith(const Situation& situation, const VoxelIndex& goal) {
  const auto found = std::ranges::find_if(situation.candidates, [&](const Candidate& candidate) {
    return std::ranges::count(candidate.goals, goal) > 0;
  });
  return found == situation.candidates.end() ? NearestCandidate(situation)
                                             : static_cast<std::size_t>(found - situation.candidates.begin());
}

/// Cuts a line that has not arrived where it came lowest.
void CutWhereLowest(const PlanningMap& map, const DenseGrid<double>& phi,
                    std::vector<Eigen::Vector3d>& line_W) {
  const auto height = [&](const Eigen::Vector3d& p_W) {
    const double value = phi.Get(map.IndexOf(p_W), 1.0);
    return std::isnan(value) ? 1.0 : value;  // in a wall
  };
  const auto lowest = std::ranges::min_element(line_W, {}, height);
  line_W.erase(lowest + 1, line_W.end());
}

}  // namespace

void Visit(OptionVisitor& visitor, PotentialThesis::Options& options) {
  using Sweep = RelaxationOptions::Sweep;
  using Walls = RelaxationOptions::Walls;
  using Beside = RelaxationOptions::Beside;
  visitor.Block("potential_thesis", [&](OptionVisitor& thesis) {
    thesis.Switch("solve", options.solve);
    thesis.Choice("sweep", options.relaxation.sweep,
                  {{"GAUSS_SEIDEL", Sweep::kGaussSeidel}, {"JACOBI", Sweep::kJacobi}});
    thesis.Choice("walls", options.relaxation.walls,
                  {{"MIRRORED", Walls::kMirrored}, {"DROPPED", Walls::kDropped}});
    thesis.Number("largest_change", options.relaxation.largest_change);
    thesis.Choice("change_beside", options.relaxation.beside,
                  {{"OLD_VALUE", Beside::kOldValue}, {"LARGEST_VALUE", Beside::kLargestValue}});
    thesis.Choice("integrator", options.descent.integrator,
                  {{"RUNGE_KUTTA_4", Integrator::kRungeKutta4},
                   {"EULER", Integrator::kEuler},
                   {"IMPROVED_EULER", Integrator::kImprovedEuler}});
    thesis.Number("step_voxels", options.descent.step_cells);
    thesis.Switch("connected_only", options.connected_only);
    using Sinks = PotentialThesis::Options::Sinks;
    using Domain = PotentialThesis::Options::Domain;
    thesis.Choice("sinks", options.sinks,
                  {{"FRONTIER_VOXELS", Sinks::kFrontierVoxels}, {"VIEWING_PLACES", Sinks::kViewingPlaces}});
    thesis.Choice("domain", options.domain, {{"FREE", Domain::kFree}, {"REACHABLE", Domain::kReachable}});
  });
}

PotentialThesis::PotentialThesis(const Options& options) : options_(options) {
  if (!(options.relaxation.largest_change > 0.0)) throw std::invalid_argument("largest_change must be > 0");
  if (!(options.descent.step_cells > 0.0)) throw std::invalid_argument("step_voxels must be > 0");
  if (options.solve && options.relaxation.walls != RelaxationOptions::Walls::kDropped)
    throw std::invalid_argument("solve knows no mirrored walls: with it, walls must be DROPPED");
  if (options.solve && options.sinks == Options::Sinks::kFrontierVoxels && !options.connected_only) {
    throw std::invalid_argument(
        "solve has no slope where no sink is connected with the robot: with it, connected_only must be true");
  }
  if (options.domain == Options::Domain::kReachable && options.sinks != Options::Sinks::kViewingPlaces) {
    throw std::invalid_argument(
        "domain REACHABLE ends before frontier voxels, into which the body would reach: with it, sinks must "
        "be VIEWING_PLACES");
  }
}

std::optional<std::vector<Candidate>> PotentialThesis::FindCandidates(const Surroundings& surroundings) {
  if (options_.sinks == Options::Sinks::kViewingPlaces) return std::nullopt;
  const PlanningMap& map = surroundings.map;
  const VoxelIndex robot = map.IndexOf(surroundings.robot_W);
  std::vector<VoxelIndex> frontier = FreeFrontier(map, surroundings.set_aside);
  const DenseGrid<FieldCell> domain = DomainOf(map, surroundings.clearance);
  const DenseGrid<std::uint8_t> connected = ConnectedWith(robot, domain);
  std::erase_if(frontier, [&](const VoxelIndex& i) {
    return i == robot || domain[i] == FieldCell::kWall || (options_.connected_only && connected[i] == 0);
  });
  std::vector<Candidate> candidates;
  for (std::vector<VoxelIndex>& component : ConnectedComponents(frontier)) {
    if (component.size() < VoxelsOfArea(surroundings.min_area, map.voxel_size())) continue;
    Candidate candidate;
    candidate.length = std::numeric_limits<double>::infinity();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::unordered_set<VoxelIndex, VoxelIndexHash> listed;
    for (const VoxelIndex& i : component) {
      sum += map.CenterOf(i);
      candidate.length = std::min(candidate.length, (map.CenterOf(i) - surroundings.robot_W).norm());
      for (const VoxelIndex& step : kFaceNeighbors) {
        const VoxelIndex beyond = i + step;
        if (!IsOpenUnknown(map, surroundings.set_aside, beyond) || !listed.insert(beyond).second) continue;
        candidate.cluster.unknowns.push_back(beyond);
      }
    }
    candidate.cluster.center_W = sum / static_cast<double>(component.size());
    candidate.goals = std::move(component);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

DenseGrid<double> PotentialThesis::Solve(const DenseGrid<FieldCell>& cells) {
  return options_.solve ? Converted<double>(solver_.Solve(cells, {})) : Relax(cells, options_.relaxation).phi;
}

Choice PotentialThesis::Choose(const Situation& situation) {
  const PlanningMap& map = situation.map;
  const VoxelIndex robot = map.IndexOf(situation.robot_W);
  if (!map.box().Contains(robot)) return {};
  const bool to_places = options_.sinks == Options::Sinks::kViewingPlaces;
  const std::size_t nearest = NearestCandidate(situation);
  if (to_places && std::ranges::count(situation.candidates[nearest].goals, robot) > 0)
    return StraightTo(situation, nearest);
  const DenseGrid<FieldCell> cells = MakeCells(situation, options_.domain);
  const DenseGrid<double> phi = Solve(cells);
  shown_ = Converted<float>(phi);
  Streamline line = FollowDescent(cells, phi, map.voxel_size(), robot, options_.descent);
  if (to_places && line.end != StreamlineEnd::kArrived) return StraightTo(situation, nearest);
  if (line.end != StreamlineEnd::kArrived) CutWhereLowest(map, phi, line.points_W);
  Choice choice;
  if (line.points_W.size() < 2) return choice;
  const VoxelIndex end = map.IndexOf(line.points_W.back());
  choice.candidate = CandidateWith(situation, end);
  choice.path_W = {situation.robot_W};
  choice.path_W.insert(choice.path_W.end(), line.points_W.begin() + 1, line.points_W.end());
  if (to_places) return choice;
  for (const VoxelIndex& step : kFaceNeighbors) {
    const auto& unknowns = situation.candidates[choice.candidate].cluster.unknowns;
    if (std::ranges::count(unknowns, end + step) > 0) choice.target.push_back(end + step);
  }
  return choice;
}

}  // namespace thalweg::explorer
