#pragma once

#include <string>

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"

namespace thalweg::cli {

/// Visits the options of all services, each under its field, with the values that a scenario has if it leaves
/// everything else to the defaults.
void VisitScenario(OptionVisitor& visitor, const Scenario& given);

/// Fills in every absent field of a scenario with the services' default. Fields that only the run itself
/// determines stay absent: the title, the world's file and bounds, and the start if none is given.
Scenario WithDefaults(const Scenario& given);

/// Prints `full` as Protobuf text that can be loaded again; fields that are not in `given` are marked as
/// defaults.
std::string CommentedText(const Scenario& full, const Scenario& given);

}  // namespace thalweg::cli
