#include "services/cli/process/supervisor.h"

#include <poll.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <utility>

#include "common/base/text.h"

namespace thalweg::cli {
namespace {

/// ": " and the last line of a log, which mostly says why a process ended; "" without one.
std::string LastWords(const std::filesystem::path& log) {
  std::string line = LastLines(log, 1);
  while (line.ends_with('\n')) line.pop_back();
  return line.empty() ? "" : ": " + CleanText(line);
}

}  // namespace

Supervisor::~Supervisor() {
  Stop(std::chrono::seconds(2));
}

void Supervisor::Start(Program program) {
  const pid_t pid = StartProcess(program);
  children_.push_back({.program = std::move(program), .pid = pid});
}

std::optional<Death> Supervisor::Watch() {
  for (Child& child : children_) {
    int status = 0;
    if (child.pid == 0 || waitpid(child.pid, &status, WNOHANG) != child.pid) continue;
    if (auto failure = OnEnd(child, status)) return failure;
  }
  return std::nullopt;
}

std::optional<Death> Supervisor::OnEnd(Child& child, int wait_status) {
  child.pid = 0;
  const std::string what = child.program.name + " ended with " + DescribeEnd(wait_status);
  const std::string see = ", see " + child.program.log.string();
  const bool is_needed = on_death_ == OnDeath::kEndRun || on_death_ == OnDeath::kRespawn;
  const bool restarts = child.respawns < kMostRespawns &&
                        (on_death_ == OnDeath::kRespawn ||
                         (on_death_ == OnDeath::kRespawnIfKilled && WIFSIGNALED(wait_status)));
  if (child.program.expendable || (!is_needed && !restarts)) {
    say_(what + LastWords(child.program.log) + "; continuing without it" + see);
    if (child.program.expendable) done_without_.push_back({what, child.program.log});
    return std::nullopt;
  }
  if (!restarts) return Death{what, child.program.log};
  ++child.respawns;
  say_(what + "; restarted (" + std::to_string(child.respawns) + " of " + std::to_string(kMostRespawns) +
       ")" + see);
  try {
    child.pid = StartProcess(child.program);
  } catch (const std::exception& error) {  // so that the run still ends with its report
    return Death{what + " and cannot be restarted: " + error.what(), child.program.log};
  }
  return std::nullopt;
}

void Supervisor::Signal(int signal) const {
  for (const Child& child : children_) {
    if (child.pid != 0) kill(child.pid, signal);
  }
}

void Supervisor::Reap(bool were_asked_to_end) {
  for (Child& child : children_) {
    int status = 0;
    if (child.pid == 0 || waitpid(child.pid, &status, WNOHANG) != child.pid) continue;
    child.pid = 0;
    const bool by_us = were_asked_to_end && WIFSIGNALED(status) &&
                       (WTERMSIG(status) == SIGTERM || WTERMSIG(status) == SIGKILL);
    if (status == 0 || by_us) continue;
    failed_to_stop_.push_back({child.program.name + " ended with " + DescribeEnd(status), child.program.log});
  }
}

bool Supervisor::AllEndedBy(std::chrono::steady_clock::time_point deadline) {
  for (;;) {
    Reap(true);
    if (std::ranges::all_of(children_, [](const Child& child) { return child.pid == 0; })) return true;
    if (std::chrono::steady_clock::now() >= deadline) return false;
    poll(nullptr, 0, 10);
  }
}

std::vector<std::string> Supervisor::Stop(Duration grace) {
  Reap(false);  // what Watch has not seen yet
  Signal(SIGTERM);
  std::vector<std::string> killed;
  if (AllEndedBy(std::chrono::steady_clock::now() + grace)) return killed;
  for (const Child& child : children_) {
    if (child.pid != 0) killed.push_back(child.program.name);
  }
  Signal(SIGKILL);
  AllEndedBy(std::chrono::steady_clock::time_point::max());
  return killed;
}

}  // namespace thalweg::cli
