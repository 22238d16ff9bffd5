#include "services/cli/command/list.h"

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "common/scenario/shipped_scenarios.h"
#include "services/cli/command/command.h"
#include "services/explorer/core/explorer_options.h"
#include "services/explorer/core/strategy/registry.h"

namespace thalweg::cli {
namespace {

std::string ScenarioLines() {
  const std::vector<ShippedScenario> scenarios = ShippedScenarios();
  std::size_t width = 0;
  for (const ShippedScenario& scenario : scenarios) width = std::max(width, scenario.name.size());
  std::ostringstream text;
  for (const ShippedScenario& scenario : scenarios) {
    text << std::left << std::setw(static_cast<int>(width) + 2) << scenario.name << scenario.summary << '\n';
  }
  return text.str();
}

}  // namespace

std::string StrategyLines(const std::string& indent, const std::string& standard) {
  std::ostringstream text;
  for (const explorer::StrategyInfo& strategy : explorer::Strategies()) {
    text << indent << std::left << std::setw(28) << strategy.name << strategy.summary
         << (strategy.name == standard ? " (default)" : "") << '\n';
  }
  return text.str();
}

void AddList(CLI::App& app) {
  app.add_subcommand("scenarios", "List the scenarios that can be named, a line each")->callback([] {
    std::cout << ScenarioLines();
  });
  app.add_subcommand("strategies", "List the explorer's strategies, a line each")->callback([] {
    std::cout << StrategyLines("", explorer::ExplorerOptions().strategy.name);
  });
}

}  // namespace thalweg::cli
