#pragma once

#include <vector>

#include "common/base/option_visitor.h"
#include "common/scenario/mistakes.h"
#include "common/scenario/scenario.h"
#include "services/controller/core/controller_type.h"
#include "services/controller/core/pose_gate.h"

namespace thalweg::controller {

struct ControllerOptions {
  ControllerType type = ControllerType::kPathFollower;
  PathFollower::Options follower;
  PoseGate::Options pose_gate;
  bool check_paths = false;   ///< Whether paths are checked against the map.
  double rate = 50.0;         ///< [Hz] Rate of commands.
  double status_rate = 10.0;  ///< [Hz] Rate of the motion status, which also follows every change of state.
};

void Visit(OptionVisitor& visitor, ControllerOptions& options);  ///< Block `controller`.

ControllerOptions OptionsFrom(const Scenario& scenario);

/// Finds what contradicts the controller's defaults or other options: a robot that would be cut off before
/// its path is silent. For LoadScenario.
std::vector<Mistake> MistakesIn(const Scenario& scenario);

}  // namespace thalweg::controller
