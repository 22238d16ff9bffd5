#pragma once

#include <optional>
#include <string>

#include "services/evaluator/core/lockstep.h"
#include "services/explorer/adapter/options.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/core/truth.h"

namespace thalweg::evaluator::test {

/// A shipped scenario as an exploration in lock step.
class ShippedScene {
 public:
  explicit ShippedScene(const std::string& name)
      : scenario_(LoadScenario(name)), world_(simulator::LoadWorld(scenario_)) {}

  const simulator::World& world() const { return world_; }
  /// @param seed  0 = where the scenario starts; else a random place connected to it.
  RigidTransform Start(int seed = 0) const {
    Scenario scenario = scenario_;
    scenario.mutable_simulator()->set_start_seed(seed);
    return simulator::StartFrom(scenario, world_, RobotFrom(scenario_));
  }
  LockstepOptions Options(const std::string& strategy) const {
    LockstepOptions options;
    options.robot = RobotFrom(scenario_);
    options.sensor = DepthSensorFrom(scenario_);
    options.mapper = mapper::OptionsFrom(scenario_, {}).map;
    options.explorer = explorer::OptionsFrom(scenario_);
    options.explorer.strategy.name = strategy;
    return options;
  }
  simulator::TrueMap Truth(const Eigen::Vector3d& start_W) const {
    return Truth(start_W, Options("closest").mapper.voxel_size);
  }
  simulator::TrueMap Truth(const Eigen::Vector3d& start_W, double voxel_size) const {
    simulator::TrueMap::Options options;
    options.voxel_size = voxel_size;
    options.robot_radius = RobotFrom(scenario_).radius;
    options.view_range = Options("closest").mapper.max_range;
    return {world_, start_W, options};
  }

 private:
  Scenario scenario_;
  simulator::World world_;
};

}  // namespace thalweg::evaluator::test
