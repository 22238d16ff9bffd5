#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scenario/scenario.h"
#include "services/cli/adapter/service_names.h"

namespace thalweg::cli {

// What `thalweg run` starts, and what the scenario says to it where the person left it open.

/// The services that the scenario needs, in the order in which they are started. The mapper reads clouds from
/// a single topic, and all services read poses from a single topic; the scenario's sources determine who
/// publishes them.
std::vector<std::string> ServicesOf(const Scenario& scenario);

/// The same without those that are started elsewhere. Throws std::runtime_error if one of them is not needed.
std::vector<std::string> ServicesOf(const Scenario& scenario, const std::vector<std::string>& without);

/// What a run needs that is started elsewhere, with a robot in place of the simulator: "mapper, explorer,
/// controller and a robot".
std::string NeedsText(const Scenario& scenario);

/// Limits a run to this machine if all its services run here (`all_here`), unless a network is named: by the
/// scenario or by the environment.
void KeepToThisMachine(Scenario& scenario, bool all_here);

/// Lets the controller check paths where the map costs it no link, that is beside the mapper, unless the
/// scenario says otherwise.
void CheckPathsWithMapper(Scenario& scenario, const std::vector<std::string>& services);

/// What a run does before it begins, for people: what it starts, what it expects from elsewhere, whom it
/// ignores, and from which checkpoint in its folder the mapper resumes.
std::string IntroductionText(const Scenario& scenario, const std::vector<std::string>& without,
                             bool with_surface, const std::filesystem::path& folder);

/// "a, b and c"
std::string Listed(const std::vector<std::string>& names);

}  // namespace thalweg::cli
