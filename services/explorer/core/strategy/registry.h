#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/option_visitor.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

struct StrategyInfo {
  std::string_view name;     ///< In scenarios and on command lines.
  std::string_view summary;  ///< One line, for people.
};
/// All strategies that a name stands for.
std::vector<StrategyInfo> Strategies();

/// A strategy with its options, of which any number can be made.
struct ConfiguredStrategy {
  std::string name;
  /// Throws std::invalid_argument naming the bad option.
  std::function<std::unique_ptr<Strategy>()> make;
};

/// The strategy of that name with its default options. Throws std::invalid_argument listing the names there
/// are.
ConfiguredStrategy Configure(std::string_view name);

/// Visits the name, field `strategy`, and the options of all strategies, each once; `strategy` becomes the
/// one that the visitor names, with the options that it was given. When there is none of that name it is
/// `make` that throws, as Configure does.
void Visit(OptionVisitor& visitor, ConfiguredStrategy& strategy);

}  // namespace thalweg::explorer
