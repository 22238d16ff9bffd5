#include "services/evaluator/core/run_end.h"

#include <array>
#include <utility>

namespace thalweg::evaluator {
namespace {

constexpr std::array kTexts = {
    std::pair{RunEnd::Kind::kCutOff, std::string_view("cut off")},
    std::pair{RunEnd::Kind::kInterrupted, std::string_view("interrupted")},
    std::pair{RunEnd::Kind::kLost, std::string_view("lost")},
    std::pair{RunEnd::Kind::kFlown, std::string_view("end of the trajectory")},
};

}  // namespace

std::string ToText(const RunEnd& end) {
  for (const auto& [kind, text] : kTexts) {
    if (kind == end.kind) return std::string(text);
  }
  return explorer::ToText(end.ending);
}

std::optional<RunEnd> RunEndFrom(std::string_view text) {
  for (const auto& [kind, its_text] : kTexts) {
    if (its_text == text) return RunEnd{.kind = kind};
  }
  const std::optional<explorer::Ending> ending = explorer::EndingFrom(text);
  if (!ending) return std::nullopt;
  return RunEnd{.kind = RunEnd::Kind::kExplorer, .ending = *ending};
}

}  // namespace thalweg::evaluator
