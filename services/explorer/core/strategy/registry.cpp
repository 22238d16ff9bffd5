#include "services/explorer/core/strategy/registry.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <typeindex>
#include <utility>

#include "services/explorer/core/strategy/closest.h"
#include "services/explorer/core/strategy/flow.h"
#include "services/explorer/core/strategy/information_gain.h"
#include "services/explorer/core/strategy/potential.h"
#include "services/explorer/core/strategy/random.h"
#include "services/explorer/core/strategy/size_bonus.h"

namespace thalweg::explorer {
namespace {

using Maker = std::function<std::unique_ptr<Strategy>()>;

/// A line of the table.
struct Entry {
  StrategyInfo info;
  std::type_index options;  ///< Strategies with the same options have the same fields.
  /// Defaults, with what the visitor sets over them; without a visitor the defaults alone.
  std::function<Maker(OptionVisitor*)> configure;
};

/// A strategy that has no options, or options with a binding of their own.
struct NoOptions {};
void Visit(OptionVisitor& /*visitor*/, NoOptions& /*options*/) {}

template <class Options, class Make>
Entry Line(std::string_view name, std::string_view summary, Make make) {
  return {.info = {name, summary}, .options = typeid(Options), .configure = [make](OptionVisitor* visitor) {
            Options options;
            if (visitor != nullptr) Visit(*visitor, options);
            return [make, options] { return make(options); };
          }};
}

template <class Made>
Entry Line(std::string_view name, std::string_view summary) {
  if constexpr (requires { typename Made::Options; }) {
    return Line<typename Made::Options>(
        name, summary, [](const typename Made::Options& options) { return std::make_unique<Made>(options); });
  } else {
    return Line<NoOptions>(name, summary, [](const NoOptions&) { return std::make_unique<Made>(); });
  }
}

const std::vector<Entry>& Entries() {
  using Gain = InformationGain::Options;
  static const std::vector<Entry> entries = {
      Line<Closest>("closest", "the frontier at the end of the shortest path"),
      Line<Random>("random", "any frontier, by chance"),
      Line<Gain>("information_gain", "the place that sees most, wherever it is",
                 [](const Gain& gain) { return std::make_unique<InformationGain>(gain, 0.0); }),
      Line<Gain>("weighted_information_gain", "the place that sees most, the less the further it is",
                 [](const Gain& gain) { return std::make_unique<InformationGain>(gain, gain.decay); }),
      Line<Potential>("potential", "along the streamline of Laplace's equation"),
      Line<NoOptions>(
          "potential_flux", "the frontier with most flux per meter of path",
          [](const NoOptions&) { return std::make_unique<Potential>(Potential::Options::FluxPerLength()); }),
      Line<Flow>("flow", "the first stop of a tour through all frontiers"),
      Line<SizeBonus>("size_bonus", "an example: near, or nearly as near and large"),
  };
  return entries;
}

const Entry* Find(std::string_view name) {
  const auto entry =
      std::ranges::find_if(Entries(), [&](const Entry& known) { return known.info.name == name; });
  return entry == Entries().end() ? nullptr : &*entry;
}

std::invalid_argument Unknown(std::string_view name) {
  std::string names;
  for (const Entry& entry : Entries()) {
    names.append(names.empty() ? "" : ", ").append(entry.info.name);
  }
  return std::invalid_argument("strategy '" + std::string(name) + "' is unknown; there are: " + names);
}

}  // namespace

std::vector<StrategyInfo> Strategies() {
  std::vector<StrategyInfo> infos;
  for (const Entry& entry : Entries()) infos.push_back(entry.info);
  return infos;
}

ConfiguredStrategy Configure(std::string_view name) {
  const Entry* const entry = Find(name);
  if (entry == nullptr) throw Unknown(name);
  return {std::string(name), entry->configure(nullptr)};
}

void Visit(OptionVisitor& visitor, ConfiguredStrategy& strategy) {
  visitor.Text("strategy", strategy.name);
  const Entry* const chosen = Find(strategy.name);
  std::set<std::type_index> visited;
  if (chosen != nullptr) {
    strategy.make = chosen->configure(&visitor);
    visited.insert(chosen->options);
  } else {
    strategy.make = [name = strategy.name]() -> std::unique_ptr<Strategy> { throw Unknown(name); };
  }
  for (const Entry& entry : Entries()) {
    if (visited.insert(entry.options).second) entry.configure(&visitor);
  }
}

}  // namespace thalweg::explorer
