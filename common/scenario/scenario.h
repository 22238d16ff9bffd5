#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/scenario/mistakes.h"
#include "scenario.pb.h"

namespace thalweg {

/// The scenario of programs to which none is given.
inline constexpr auto kDefaultScenario = "kitchen";

/// Checks that need knowledge of the services. LoadScenario calls them, so that their errors name the place,
/// too.
struct ServiceChecks {
  /// Fills in absent fields, for the checks only: a field may contradict another's default.
  std::function<Scenario(const Scenario&)> with_defaults = nullptr;
  /// Returns further mistakes, such as a name that is known only to a service.
  std::function<std::vector<Mistake>(const Scenario&)> mistakes = nullptr;
};

/// Loads a scenario from a file, or by name from deploy/scenarios, and applies `overrides` such as
/// "mapper.voxel_size_m=0.05". Makes relative world files absolute and expands ${THALWEG_DATA}. Throws
/// std::runtime_error naming file, line, column and field of each mistake: unknown field, wrong type, value
/// out of range, fields that contradict each other (see CheckScenario), missing world file, and those found
/// by `checks`.
Scenario LoadScenario(const std::string& name_or_file, const std::vector<std::string>& overrides = {},
                      const ServiceChecks& checks = {});

/// Throws std::invalid_argument naming field, value and what is allowed.
void CheckScenario(const Scenario& scenario);

/// Saves as Protobuf text with everything resolved, for the processes of a run and for the record.
void SaveScenario(const Scenario& scenario, const std::filesystem::path& file);

/// Folder of the shipped scenarios: THALWEG_SCENARIOS if set; else share/thalweg/scenarios beside the bin
/// folder of an installed program; else deploy/scenarios, searched upward from the executable. Throws
/// std::runtime_error if there is none.
std::filesystem::path ScenarioFolder();

}  // namespace thalweg
