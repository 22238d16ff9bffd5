#include "services/evaluator/core/run_end.h"

#include <algorithm>
#include <array>

namespace thalweg::evaluator {
namespace {

/// The kinds of end that are not the explorer's.
struct Kind {
  RunEnd::Kind kind;
  std::string_view name;
};
constexpr std::array kKinds = {
    Kind{RunEnd::Kind::kCutOff, "cut_off"},
    Kind{RunEnd::Kind::kInterrupted, "interrupted"},
    Kind{RunEnd::Kind::kLost, "lost"},
    Kind{RunEnd::Kind::kFlown, "flown"},
};

}  // namespace

std::string_view NameOf(const RunEnd& end) {
  const auto found = std::ranges::find(kKinds, end.kind, &Kind::kind);
  return found != kKinds.end() ? found->name : explorer::NameOf(end.ending.outcome);
}

std::optional<RunEnd> RunEndNamed(std::string_view name) {
  const auto found = std::ranges::find(kKinds, name, &Kind::name);
  if (found != kKinds.end()) return RunEnd{.kind = found->kind};
  const std::optional<explorer::Outcome> outcome = explorer::OutcomeNamed(name);
  if (!outcome) return std::nullopt;
  return RunEnd{.kind = RunEnd::Kind::kExplorer, .ending = {.outcome = *outcome}};
}

}  // namespace thalweg::evaluator
