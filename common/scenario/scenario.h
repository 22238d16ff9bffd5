#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/scenario/mistakes.h"
#include "scenario.pb.h"

namespace thalweg {

/// What only services know of a scenario. LoadScenario asks it, so that their complaints, too, name the
/// place.
struct ServiceChecks {
  /// Fills in what is absent, for the checks alone: a field may contradict another's default.
  std::function<Scenario(const Scenario&)> with_defaults = nullptr;
  /// Further mistakes, such as a name that only a service knows.
  std::function<std::vector<Mistake>(const Scenario&)> mistakes = nullptr;
};

/// Reads a scenario: a path, or a name under deploy/scenarios. Then applies `overrides`, each
/// "mapper.voxel_size_m=0.05". Relative world files become absolute, ${THALWEG_DATA} is replaced.
/// Throws std::runtime_error naming file, line, column and field of each mistake: unknown field, wrong type,
/// value out of range, fields that contradict each other (see CheckScenario), missing world file, and what
/// `checks` find.
Scenario LoadScenario(const std::string& name_or_file, const std::vector<std::string>& overrides = {},
                      const ServiceChecks& checks = {});

/// Throws std::invalid_argument naming field, value and what is allowed.
void CheckScenario(const Scenario& scenario);

/// As Protobuf text, with everything resolved, for the processes of a run and for the record.
void SaveScenario(const Scenario& scenario, const std::filesystem::path& file);

/// Folder of the shipped scenarios: THALWEG_SCENARIOS; else, of an installed program, share/thalweg/scenarios
/// beside its bin; else deploy/scenarios, found upwards from the executable. Throws std::runtime_error when
/// there is none.
std::filesystem::path ScenarioFolder();

}  // namespace thalweg
