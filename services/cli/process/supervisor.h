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

  /// Looks after the processes; to be called often. What went wrong, when the run must end for it.
  std::optional<std::string> Watch();

  /// SIGTERM to all, then SIGKILL to those that still run after `grace`; waits for them. Their names.
  std::vector<std::string> Stop(Duration grace);

 private:
  struct Child {
    Program program;
    pid_t pid = 0;  ///< 0 = ended.
    int respawns = 0;
  };
  std::optional<std::string> OnEnd(Child& child, int wait_status);
  bool AllEndedBy(std::chrono::steady_clock::time_point deadline);
  void Signal(int signal) const;

  OnDeath on_death_;
  std::function<void(const std::string&)> tell_;
  std::vector<Child> children_;
};

}  // namespace thalweg::cli
