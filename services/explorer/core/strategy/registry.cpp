#include "services/explorer/core/strategy/registry.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <tuple>
#include <typeindex>
#include <utility>

#include "services/explorer/core/strategy/closest.h"
#include "services/explorer/core/strategy/cover.h"
#include "services/explorer/core/strategy/flow.h"
#include "services/explorer/core/strategy/gaps.h"
#include "services/explorer/core/strategy/information_gain.h"
#include "services/explorer/core/strategy/potential.h"
#include "services/explorer/core/strategy/potential_thesis.h"
#include "services/explorer/core/strategy/random.h"
#include "services/explorer/core/strategy/rift.h"
#include "services/explorer/core/strategy/size_bonus.h"
#include "services/explorer/core/strategy/surface.h"

namespace thalweg::explorer {
namespace {

using Maker = std::function<std::unique_ptr<Strategy>()>;

/// One strategy in the table.
struct Entry {
  StrategyInfo info;
  /// Applies what the visitor sets to the default options; null = the defaults alone. Options of a type that
  /// was visited before are not visited again: strategies that share their options share the fields, too.
  std::function<Maker(OptionVisitor*, std::set<std::type_index>& visited)> configure;
};

template <class Options>
void VisitOnce(OptionVisitor& visitor, Options& options, std::set<std::type_index>& visited) {
  if (visited.insert(typeid(Options)).second) Visit(visitor, options);
}

/// @param make  Makes the strategy from its options, one argument for each type of them.
template <class... Options, class Make>
Entry LineOf(std::string_view name, std::string_view summary, Make make) {
  return {.info = {name, summary},
          .configure = [make](OptionVisitor* visitor, std::set<std::type_index>& visited) -> Maker {
            std::tuple<Options...> all;
            if (visitor != nullptr) {
              std::apply([&](Options&... options) { (VisitOnce(*visitor, options, visited), ...); }, all);
            }
            return [make, all] { return std::apply(make, all); };
          }};
}

template <class Made>
Entry Line(std::string_view name, std::string_view summary) {
  if constexpr (requires { typename Made::Options; }) {
    return LineOf<typename Made::Options>(
        name, summary, [](const typename Made::Options& options) { return std::make_unique<Made>(options); });
  } else {
    return LineOf<>(name, summary, [] { return std::make_unique<Made>(); });
  }
}

Entry Only(ForRobots robots, Entry entry) {
  entry.info.robots = robots;
  return entry;
}

const std::vector<Entry>& Entries() {
  using Gain = InformationGain::Options;
  using Field = Potential::Options;
  static const std::vector<Entry> entries = {
      Line<Closest>("closest", "goes to the frontier with the shortest path"),
      Line<Random>("random", "goes to a frontier chosen at random"),
      LineOf<Gain>("information_gain", "goes where the sensor would see most, however far away",
                   [](const Gain& gain) { return std::make_unique<InformationGain>(gain, 0.0); }),
      LineOf<Gain>("weighted_information_gain", "as information_gain, but prefers places nearby",
                   [](const Gain& gain) { return std::make_unique<InformationGain>(gain, gain.decay); }),
      Line<Potential>("potential", "follows the streamline of a harmonic potential"),
      LineOf<Field>("potential_flux", "goes to the frontier with most flux per meter of path",
                    [](const Field& field) { return std::make_unique<Potential>(field.FluxPerLength()); }),
      Line<PotentialThesis>("potential_thesis", "the printed method of the source thesis, step by step"),
      Only(ForRobots::kDriving,
           Line<Gaps>("gaps", "goes by the gap navigation tree, where no loop leads around anything")),
      Line<Flow>("flow", "goes to the first stop of a tour through all frontiers"),
      Line<Cover>("cover", "goes to the first stop of a short tour that sees whatever is worth its path"),
      LineOf<Surface::Options, Flow::Options>("surface",
                                              "explores as flow does, and inspects all surface from nearby",
                                              [](const Surface::Options& surface, const Flow::Options& flow) {
                                                return std::make_unique<Surface>(surface, flow);
                                              }),
      Only(ForRobots::kLooking,
           Line<Rift>("rift", "goes where the surface that its camera saw is torn, as the source prints it")),
      Line<SizeBonus>("size_bonus", "an example: trades path length for frontier size"),
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
  std::set<std::type_index> visited;
  return {std::string(name), entry->configure(nullptr, visited)};
}

std::optional<RobotMisfit> MisfitOf(const RobotModel& robot, std::string_view name) {
  const Entry* const entry = Find(name);
  if (entry == nullptr) return std::nullopt;
  switch (entry->info.robots) {
    case ForRobots::kDriving:
      if (!robot.drives) return RobotMisfit{"a robot that drives", "drives", "false"};
      if (!robot.turns_on_the_spot())
        return RobotMisfit{"a robot that turns on the spot", "drive", "ACKERMANN"};
      break;
    case ForRobots::kLooking: {
      constexpr auto kLooks = "a robot that flies and can look in any direction";
      if (robot.drives) return RobotMisfit{kLooks, "drives", "true"};
      if (robot.level()) return RobotMisfit{kLooks, "attitude", "LEVEL"};
      if (robot.gimballed()) return RobotMisfit{kLooks, "attitude", "GIMBAL"};
      break;
    }
    case ForRobots::kAll:
      break;
  }
  return std::nullopt;
}

void Visit(OptionVisitor& visitor, ConfiguredStrategy& strategy) {
  visitor.Text("strategy", strategy.name);
  const Entry* const chosen = Find(strategy.name);
  std::set<std::type_index> visited;
  if (chosen != nullptr) {
    strategy.make = chosen->configure(&visitor, visited);
  } else {
    strategy.make = [name = strategy.name]() -> std::unique_ptr<Strategy> { throw Unknown(name); };
  }
  for (const Entry& entry : Entries()) entry.configure(&visitor, visited);
}

}  // namespace thalweg::explorer
