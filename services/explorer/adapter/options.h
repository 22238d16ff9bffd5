#pragma once

#include "common/scenario/scenario.h"
#include "services/explorer/core/explorer.h"

namespace thalweg::explorer {

/// The only code that sees both the scenario and the core's options.
Explorer::Options OptionsFrom(const Scenario& scenario);

}  // namespace thalweg::explorer
