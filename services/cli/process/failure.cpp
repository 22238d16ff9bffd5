#include "services/cli/process/failure.h"

#include <sstream>

#include "common/base/text.h"

namespace thalweg::cli {

Failure FailureFrom(const Death& death) {
  constexpr int kLines = 10;
  constexpr std::size_t kMostOfALine = 500;  // a log may quote what came from the network
  const std::string lines = LastLines(death.log, kLines);
  if (lines.empty()) return {death.what, "; " + death.log.string() + " is empty"};
  Failure failure{death.what, "; the last lines of " + death.log.string() + ":"};
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) failure.details += "\n    " + CleanText(line, kMostOfALine);
  return failure;
}

std::vector<std::string> StopServices(Supervisor& supervisor, Duration grace, const std::string& writer,
                                      const std::function<void(const std::string&)>& say) {
  std::vector<std::string> lost;
  for (const std::string& name : supervisor.Stop(grace)) {
    const std::string what = name + " did not stop and was killed";
    name == writer ? lost.push_back(what) : say(what);
  }
  for (const std::vector<Death>& deaths : {supervisor.done_without(), supervisor.failed_to_stop()}) {
    for (const Death& death : deaths) {
      const Failure failed = FailureFrom(death);
      lost.push_back(failed.what + failed.details);
    }
  }
  return lost;
}

}  // namespace thalweg::cli
