#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "services/cli/process/child_process.h"

namespace thalweg::cli {

/// What to do when a process ends that should not.
enum class OnDeath {
  kEndRun,
  kRespawn,    ///< Start it again, a few times.
  kKeepGoing,  ///< Go on without it: somebody restarts it by hand.
};

/// A process that ended and should not have.
struct Death {
  std::string what;           ///< "mapper ended with exit code 1"
  std::filesystem::path log;  ///< What it said.
};

/// The processes of a run: starts, watches and ends them. Threading: the main thread.
class Supervisor {
 public:
  static constexpr int kMostRespawns = 5;  ///< Of each process.

  /// @param tell  Gets one line for people about each death and restart.
  Supervisor(OnDeath on_death, std::function<void(const std::string&)> tell)
      : on_death_(on_death), tell_(std::move(tell)) {}
  ~Supervisor();  ///< Ends what still runs.
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  void Start(Program program);

  /// Looks after the processes; to be called often. The death for which the run must end, if there is one.
  std::optional<Death> Watch();

  /// SIGTERM to all, then SIGKILL to those that still run after `grace`; waits for them. Their names.
  std::vector<std::string> Stop(Duration grace);

 private:
  struct Child {
    Program program;
    pid_t pid = 0;  ///< 0 = ended.
    int respawns = 0;
  };
  std::optional<Death> OnEnd(Child& child, int wait_status);
  bool AllEndedBy(std::chrono::steady_clock::time_point deadline);
  void Signal(int signal) const;

  OnDeath on_death_;
  std::function<void(const std::string&)> tell_;
  std::vector<Child> children_;
};

}  // namespace thalweg::cli
