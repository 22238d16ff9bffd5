#pragma once

#include <string>

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"

namespace thalweg::cli {

/// Visits the options of all services, each under its field: those of a scenario that leaves all else to the
/// defaults.
void VisitScenario(OptionVisitor& visitor, const Scenario& given);

/// The scenario with every absent field as the services take it. What only the run itself decides stays
/// absent: the title, the world's file and bounds, and the start where none is given.
Scenario WithDefaults(const Scenario& given);

/// `full` as Protobuf text that can be loaded again; what is not in `given` is marked as a default.
std::string CommentedText(const Scenario& full, const Scenario& given);

}  // namespace thalweg::cli
