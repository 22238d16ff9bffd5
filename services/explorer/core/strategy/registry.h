#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

struct StrategyInfo {
  std::string_view name;     ///< As scenarios and command lines spell it.
  std::string_view summary;  ///< One line for the help.
  bool drives_only = false;  ///< Whether it is for robots that drive, and no others.
};
/// All strategies that can be selected by name.
std::vector<StrategyInfo> Strategies();

/// A strategy with its options.
struct ConfiguredStrategy {
  std::string name;
  /// Makes a new instance. Throws std::invalid_argument naming the invalid option.
  std::function<std::unique_ptr<Strategy>()> make;
};

/// Returns the strategy of that name with its default options. Throws std::invalid_argument listing the known
/// names.
ConfiguredStrategy Configure(std::string_view name);

/// Whether the strategy of that name is one for that robot; an unknown name is.
bool IsFor(const RobotModel& robot, std::string_view name);

/// Visits the name (field `strategy`) and the options of all strategies, each once. `strategy` becomes the
/// one that the visitor names, with the options that the visitor sets. An unknown name does not throw here;
/// its `make` throws as Configure does.
void Visit(OptionVisitor& visitor, ConfiguredStrategy& strategy);

}  // namespace thalweg::explorer
