#pragma once

#include <string>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/scenario/mistakes.h"
#include "common/scenario/scenario.h"
#include "services/explorer/core/explorer.h"

namespace thalweg::explorer {

void Visit(OptionVisitor& visitor, Explorer::Options& options);  ///< Block `explorer`.

/// The only code that sees both the scenario and the core's options.
Explorer::Options OptionsFrom(const Scenario& scenario);

/// What is explored, so that an exploration that was kept is not continued in another place: title, world and
/// bounds.
std::string PlaceOf(const Scenario& scenario);

/// What only the explorer can find wrong: a strategy that it does not have. For LoadScenario.
std::vector<Mistake> MistakesIn(const Scenario& scenario);

}  // namespace thalweg::explorer
