#include "common/scenario/shipped_scenarios.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/scenario/scenario.h"

namespace thalweg {
namespace {

/// The first sentence of the comment that a file begins with.
std::string FirstSentenceOf(const std::filesystem::path& file) {
  std::ifstream lines(file);
  std::string comment;
  for (std::string line; std::getline(lines, line) && line.starts_with('#');) {
    const std::size_t word = line.find_first_not_of("# ");
    if (word == std::string::npos) continue;
    if (!comment.empty()) comment += ' ';
    comment.append(line, word);
  }
  const std::size_t end = comment.find(". ");
  return end == std::string::npos ? comment : comment.substr(0, end + 1);
}

}  // namespace

std::vector<ShippedScenario> ShippedScenarios() {
  std::vector<ShippedScenario> scenarios;
  for (const auto& entry : std::filesystem::directory_iterator(ScenarioFolder())) {
    if (entry.path().extension() != ".txtpb") continue;
    scenarios.push_back({entry.path().stem().string(), FirstSentenceOf(entry.path())});
  }
  std::ranges::sort(scenarios, {}, &ShippedScenario::name);
  return scenarios;
}

}  // namespace thalweg
