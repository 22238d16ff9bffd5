#pragma once

#include <vector>

#include "common/scenario/scenario.h"
#include "services/gateway/core/protocol.h"

namespace thalweg::gateway {

/// The scenario's fields, each under its path, e.g. "mapper.voxel_size_m": those that are set, and the
/// defaults of those that several services share (common/service/shared_options.h). What a single service has
/// as its default is known to that service only.
std::vector<Parameter> ParametersOf(const Scenario& scenario);

}  // namespace thalweg::gateway
