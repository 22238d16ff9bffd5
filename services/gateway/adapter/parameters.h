#pragma once

#include <vector>

#include "common/scenario/scenario.h"
#include "services/gateway/core/protocol.h"

namespace thalweg::gateway {

/// The scenario's fields that are set, each under its path, e.g. "mapper.voxel_size_m".
std::vector<Parameter> ParametersOf(const Scenario& scenario);

}  // namespace thalweg::gateway
