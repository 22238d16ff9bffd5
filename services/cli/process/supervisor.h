#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "services/cli/process/child_process.h"

namespace thalweg::cli {

/// What to do when a process ends unexpectedly.
enum class OnDeath {
  kEndRun,
  kRespawn,    ///< Restart it, a limited number of times.
  kKeepGoing,  ///< Continue without it, so that it can be restarted by hand.
  /// For what a run does not depend on: restart it as often if a signal has ended it, but continue without it
  /// where that does not help, or where it has ended by itself, as it would again.
  kRespawnIfKilled,
};

/// The unexpected end of a process.
struct Death {
  std::string what;           ///< "mapper ended with exit code 1"
  std::filesystem::path log;  ///< The process's log.
};

/// Starts, watches and stops the processes of a run.
///
/// Threading: one thread at a time; the one that starts processes must live as long as they.
class Supervisor {
 public:
  static constexpr int kMostRespawns = 5;  ///< For each process.

  /// @param say  Receives one line for people about each death and restart.
  Supervisor(OnDeath on_death, std::function<void(const std::string&)> say)
      : on_death_(on_death), say_(std::move(say)) {}
  ~Supervisor();  ///< Stops the processes that still run.
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  void Start(Program program);

  /// Handles the ends of processes; call often. Returns the death that must end the run, if there is one.
  std::optional<Death> Watch();

  /// Sends SIGTERM to all processes, then SIGKILL to those that still run after `grace`, and waits for them.
  /// @return The names of those that were killed.
  std::vector<std::string> Stop(Duration grace);

  /// The processes that Stop asked to end and that ended with an error, as a mapper does that cannot save its
  /// map; and those that it found dead.
  const std::vector<Death>& failed_to_stop() const { return failed_to_stop_; }
  /// The deaths of expendable programs, whose work is not whole.
  const std::vector<Death>& done_without() const { return done_without_; }

 private:
  struct Child {
    Program program;
    pid_t pid = 0;  ///< 0 = ended.
    int respawns = 0;
  };
  std::optional<Death> OnEnd(Child& child, int wait_status);
  bool AllEndedBy(std::chrono::steady_clock::time_point deadline);
  /// Takes note of the processes that have ended, without handling that as Watch does.
  void Reap(bool were_asked_to_end);
  void Signal(int signal) const;

  OnDeath on_death_;
  std::function<void(const std::string&)> say_;
  std::vector<Child> children_;
  std::vector<Death> failed_to_stop_;
  std::vector<Death> done_without_;
};

}  // namespace thalweg::cli
