#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/cli/process/child_process.h"

namespace thalweg::cli {

/// Where the processes of a run find its scenario and leave their files.
struct RunPlace {
  std::filesystem::path folder;
  std::optional<int> domain;  ///< Nothing = from the environment or the scenario.

  std::filesystem::path ScenarioFile() const { return folder / "scenario.txtpb"; }
};

/// A service of the run, thalweg-NAME, whose executable is in the folder of our own.
Program ServiceProgram(const std::string& name, const RunPlace& place);

/// The gateway. It announces the port that it serves in a file of the folder.
Program GatewayProgram(const RunPlace& place);

/// What the gateway is to show of a run that was started elsewhere.
struct RemoteView {
  std::string scenario;  ///< Name or file.
  std::vector<std::string> overrides;
  std::optional<int> domain;  ///< Nothing = from the environment or the scenario.
  std::string announcement;   ///< The file in which the gateway announces its port.
};

/// The gateway for such a view. It has no log.
Program ViewProgram(const RemoteView& view);

/// The port that the gateway has announced; nothing before it has. Removes the announcement.
std::optional<int> TakeAnnouncedPort(const RunPlace& place);

/// Records the run in a file. A recording that fails, e.g. on a full disk, does not end the run.
/// @param scenario  Its name, which the file of the run's folder does not state.
Program RecorderProgram(const std::filesystem::path& file, const RunPlace& place,
                        const std::string& scenario);

}  // namespace thalweg::cli
