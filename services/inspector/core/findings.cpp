#include "services/inspector/core/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>

namespace thalweg::inspector {
namespace {

std::size_t CountOf(const std::vector<Finding>& findings, Level level) {
  return static_cast<std::size_t>(std::ranges::count(findings, level, &Finding::level));
}

}  // namespace

std::string FindingsJson(const std::vector<Finding>& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"level", NameOf(finding.level)},
                    {"subject", finding.subject},
                    {"text", finding.text},
                    {"advice", finding.advice}});
  }
  return list.dump(2) + '\n';
}

std::string FindingsText(const std::vector<Finding>& findings, bool quiet) {
  std::string text;
  for (const Finding& finding : findings) {
    if (quiet && finding.level == Level::kOk) continue;
    text += fmt::format("{:<8} {:<15} {}\n", NameOf(finding.level), finding.subject, finding.text);
    if (!finding.advice.empty()) text += fmt::format("{:>24} -> {}\n", "", finding.advice);
  }
  const std::size_t problems = CountOf(findings, Level::kProblem);
  const std::size_t notes = CountOf(findings, Level::kNote);
  return text + fmt::format("{} problem{}, {} note{}\n", problems, problems == 1 ? "" : "s", notes,
                            notes == 1 ? "" : "s");
}

bool HasProblem(const std::vector<Finding>& findings) {
  return CountOf(findings, Level::kProblem) > 0;
}

}  // namespace thalweg::inspector
