#include "services/explorer/core/explorer_options.h"

#include <algorithm>
#include <stdexcept>

#include "services/explorer/core/view/view.h"

namespace thalweg::explorer {
namespace {

PlanningMap::Options MapOptions(const ExplorerOptions& options) {
  // A driving robot touches the floor, so there is no vertical margin for it.
  const double above = options.robot.drives || options.robot.height == 0.0 ? 0.0 : options.safety_margin;
  return {.voxel_size = options.voxel_size,
          .clearance = options.robot.radius + options.safety_margin,
          .half_height = 0.5 * options.robot.height + above,
          .bounds = options.bounds,
          .max_voxels = options.max_voxels,
          .no_go = options.no_go,
          .camera_height = options.robot.T_BC.translation().z(),
          .doubt = options.doubt};
}

}  // namespace

void Check(const ExplorerOptions& options) {
  if (!(options.comfort.distance >= 0.0)) throw std::invalid_argument("comfort must be >= 0");
  if (!(options.max_missed_share >= 0.0 && options.max_missed_share <= 1.0))
    throw std::invalid_argument("max_missed_share must be 0 to 1");
  if (options.robot.drives && !(options.robot.height > 0.0))
    throw std::invalid_argument("a robot that drives needs a height");
  if (!options.robot.turns_on_the_spot() && !(options.robot.min_turning_radius > 0.0))
    throw std::invalid_argument("a robot that turns only in curves needs their radius");
}

Knowledge::Options KnowledgeOptions(const ExplorerOptions& options) {
  return {.map = MapOptions(options),
          .memory = options.memory,
          .robot = options.robot,
          .camera = options.camera,
          .look_range = options.look_range,
          .min_measured_share = options.min_measured_share,
          .reach = options.exemption};
}

CandidateSearch::Options SearchOptions(const ExplorerOptions& options) {
  return {.frontier = options.frontier,
          .robot_radius = options.robot.radius,
          .exemption = options.exemption,
          .wide_exemption = options.wide_exemption,
          .look_range = options.look_range,
          .voxel_size = options.voxel_size};
}

Mission::Options MissionOptions(const ExplorerOptions& options) {
  return {.time_budget = options.time_budget,
          .distance_budget = options.distance_budget,
          .return_home = options.return_home,
          .home_paths = {.margin = options.home_margin,
                         .robot_radius = options.robot.radius,
                         .exemption = options.exemption,
                         .wide_exemption = options.wide_exemption,
                         .max_speed = options.robot.max_speed,
                         .max_turn_rate = options.robot.max_turn_rate}};
}

ExplorerOptions WithLoopRules(ExplorerOptions options) {
  if (!options.loop.drop_small) options.frontier.min_area = 0.0;
  if (!options.loop.keep_off) options.comfort.distance = 0.0;
  if (!options.loop.set_aside) options.memory.sets_aside = false;
  return options;
}

ExplorerOptions ReachingBeyondItsFeet(ExplorerOptions options) {
  if (options.robot.turns_freely()) return options;
  const ViewPlanner views(options.camera, options.robot);
  const double half_height = options.robot.height > 0.0 ? 0.5 * options.robot.height : options.robot.radius;
  const double highest = half_height - options.robot.T_BC.translation().z();
  const double lowest = highest - 2.0 * half_height;
  double blind = 0.0;
  for (double distance = 0.0; distance < options.look_range; distance += 0.5 * options.voxel_size) {
    const bool shown = views.CanShow({distance, 0.0, highest}) && views.CanShow({distance, 0.0, lowest});
    if (!shown) blind = distance;
  }
  const double beyond = blind + options.robot.radius + options.safety_margin + 3.0 * options.voxel_size;
  options.wide_exemption = std::max(options.wide_exemption, beyond);
  return options;
}

ShutWays::Options ShutWayOptions(const ExplorerOptions& options) {
  return {.frontier = options.frontier,
          .look_range = options.look_range,
          .voxel_size = options.voxel_size,
          .patience = options.loop.wait_at_shut_ways ? options.shut_way_patience : Duration::zero()};
}

NoGoBoxes::Options NoGoOptions(const ExplorerOptions& options) {
  return {.fixed = options.no_go,
          .robot_radius = options.robot.radius,
          .exemption = options.exemption,
          .wide_exemption = options.wide_exemption};
}

}  // namespace thalweg::explorer
