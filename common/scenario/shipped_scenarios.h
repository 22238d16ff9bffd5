#pragma once

#include <string>
#include <vector>

namespace thalweg {

/// A scenario that LoadScenario finds by name.
struct ShippedScenario {
  std::string name;
  std::string summary;  ///< First sentence of the comment in its first lines; may be empty.
};
/// Those in ScenarioFolder(), by name.
std::vector<ShippedScenario> ShippedScenarios();

}  // namespace thalweg
