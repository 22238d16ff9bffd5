#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Which robots a strategy is for.
enum class ForRobots : std::uint8_t {
  kAll,
  kDriving,  ///< Those that drive.
  kLooking,  ///< Those that fly, and can look in any direction.
};

struct StrategyInfo {
  std::string_view name;     ///< As scenarios and command lines spell it.
  std::string_view summary;  ///< One line for the help.
  ForRobots robots = ForRobots::kAll;
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

/// Why a strategy is not for a robot.
struct RobotMisfit {
  const char* robots;  ///< For which it is: "a robot that drives".
  const char* field;   ///< What of the block `robot` of a scenario says that this is none,
  const char* value;   ///< by that value.
};
/// Why the strategy of that name is not for that robot; nothing if it is, and for an unknown name.
std::optional<RobotMisfit> MisfitOf(const RobotModel& robot, std::string_view name);

/// Visits the name (field `strategy`) and the options of all strategies, each once. `strategy` becomes the
/// one that the visitor names, with the options that the visitor sets. An unknown name does not throw here;
/// its `make` throws as Configure does.
void Visit(OptionVisitor& visitor, ConfiguredStrategy& strategy);

}  // namespace thalweg::explorer
