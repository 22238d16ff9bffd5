#pragma once

#include <functional>
#include <string>
#include <vector>

#include "services/cli/process/supervisor.h"

namespace thalweg::cli {

/// Why a run has to end.
struct Failure {
  std::string what;     ///< For the screen and the report.
  std::string details;  ///< For the screen only; may have several lines.
};

/// With the last lines of the service's log, which usually contain the cause.
Failure FailureFrom(const Death& death);

/// Stops the processes of a run as Supervisor::Stop does.
/// @param writer  The process whose end leaves files.
/// @param say     Receives a line for each other process that had to be killed.
/// @return  What went wrong with files: that the writer was killed, and each process that ended with an
/// error.
std::vector<std::string> StopServices(Supervisor& supervisor, Duration grace, const std::string& writer,
                                      const std::function<void(const std::string&)>& say);

}  // namespace thalweg::cli
