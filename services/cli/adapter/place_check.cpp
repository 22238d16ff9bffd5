#include "services/cli/adapter/place_check.h"

#include <fmt/format.h>

#include "common/scenario/models.h"
#include "services/cli/report/floor_below.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::cli {

std::string FloatingText(const RobotModel& robot, const simulator::World& world,
                         const Eigen::Vector3d& start_W) {
  constexpr double kDeepest = 100.0;
  if (!robot.drives) return "";
  const Eigen::Vector3d bottom_W = start_W - 0.5 * robot.height * Eigen::Vector3d::UnitZ();
  const auto floor = world.CastRay(bottom_W, -Eigen::Vector3d::UnitZ(), kDeepest);
  if (floor && floor->distance <= kHighestOfWheels) return "";
  const std::string distance =
      floor ? fmt::format("{:.2f} m above the floor", floor->distance) : "above no floor";
  return "the robot drives, but starts " + distance +
         ", and explores only the heights that its body sweeps: set simulator.start_position_m";
}

std::vector<std::string> CheckPlace(const Scenario& scenario) {
  const simulator::World world = simulator::LoadWorld(scenario);
  simulator::CheckExtent(world, mapper::OptionsFrom(scenario, {}).map.voxel_size);
  Scenario given = scenario;
  given.mutable_simulator()->clear_start_seed();  // a random start is connected to the given one
  const RobotModel robot = RobotFrom(scenario);
  const RigidTransform T_WB = simulator::StartFrom(given, world, robot);
  const std::string floating = FloatingText(robot, world, T_WB.translation());
  return floating.empty() ? std::vector<std::string>() : std::vector<std::string>{floating};
}

}  // namespace thalweg::cli
