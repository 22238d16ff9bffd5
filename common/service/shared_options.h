#pragma once

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"

namespace thalweg {

/// Visits the options that several services share, each under its field, with the values that a scenario has
/// if it leaves everything else to the defaults: sources, network, names, robot, depth sensor, and what the
/// mapper's clouds and map are like.
void VisitShared(OptionVisitor& visitor, const Scenario& given);

/// Fills in the absent fields among these with their defaults.
Scenario WithSharedDefaults(const Scenario& given);

}  // namespace thalweg
