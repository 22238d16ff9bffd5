#pragma once

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"
#include "services/controller/core/path_follower.h"
#include "services/controller/core/pose_gate.h"

namespace thalweg::controller {

struct ControllerOptions {
  PathFollower::Options follower;
  PoseGate::Options pose_gate;
  bool check_paths = false;   ///< Whether paths are checked against the map.
  double rate = 50.0;         ///< [Hz] Rate of commands.
  double status_rate = 10.0;  ///< [Hz] Rate of the motion status, which also follows every change of state.
};

void Visit(OptionVisitor& visitor, ControllerOptions& options);  ///< Block `controller`.

/// Throws std::invalid_argument naming the invalid field.
ControllerOptions OptionsFrom(const Scenario& scenario);

}  // namespace thalweg::controller
