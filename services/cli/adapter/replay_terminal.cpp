#include "services/cli/adapter/replay_terminal.h"

#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <condition_variable>
#include <mutex>

#include "services/cli/report/live_line.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

/// Standard input as a terminal that gives each key at once and does not show it, from KeepRaw on while this
/// lives. A shell that takes the terminal back sets it as it wants it.
class RawTerminal {
 public:
  RawTerminal() = default;
  ~RawTerminal() {
    if (is_raw_ && IsInForeground(STDIN_FILENO)) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;

  /// Only in the foreground: the system stops a job that sets its terminal from the background.
  void KeepRaw() {
    if (is_raw_ || tcgetattr(STDIN_FILENO, &before_) != 0) return;
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    is_raw_ = tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
  }
  /// The terminal is the shell's now.
  void Leave() { is_raw_ = false; }

 private:
  termios before_{};
  bool is_raw_ = false;
};

}  // namespace

void Obey(recorder::Player& player, std::string_view typed) {
  constexpr auto kStep = 5s;
  while (!typed.empty()) {
    const recorder::Player::Progress its = player.progress();
    if (typed.starts_with("\x1b[") && typed.size() >= 3) {  // an arrow key
      if (typed[2] == 'D') player.Seek(its.now - kStep);
      if (typed[2] == 'C') player.Seek(its.now + kStep);
      typed.remove_prefix(3);
      continue;
    }
    if (typed[0] == '\n' || typed[0] == ' ') player.Toggle();
    if (typed[0] == '-') player.SetRate(its.rate / 2.0);
    if (typed[0] == '+' || typed[0] == '=') player.SetRate(its.rate * 2.0);
    typed.remove_prefix(1);
  }
}

std::string ProgressText(const recorder::Player::Progress& its) {
  return fmt::format("{} / {}  {:g}x{}", ClockText(Seconds(its.now - its.begin)),
                     ClockText(Seconds(its.end - its.begin)), its.rate, its.paused ? "  paused" : "");
}

bool IsInForeground(int terminal) {
  const pid_t owner = tcgetpgrp(terminal);
  return owner == -1 || owner == getpgrp();
}

void FollowKeys(recorder::Player& player, const std::stop_token& ended) {
  constexpr int kTurnMs = 100;
  RawTerminal terminal;
  pollfd in{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  std::array<char, 256> keys{};
  while (!ended.stop_requested()) {
    if (!IsInForeground(STDIN_FILENO)) {
      terminal.Leave();
      poll(nullptr, 0, kTurnMs);  // what is typed now is for the shell
      continue;
    }
    terminal.KeepRaw();
    if (poll(&in, 1, kTurnMs) <= 0 || !IsInForeground(STDIN_FILENO)) continue;
    const ssize_t count = read(STDIN_FILENO, keys.data(), keys.size());
    if (count <= 0) return;
    Obey(player, {keys.data(), static_cast<std::size_t>(count)});
  }
}

void ShowProgress(const recorder::Player& player, std::ostream& out, const std::stop_token& ended) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  while (!ended.stop_requested()) {
    // In the background it would write over what is typed. The cursor goes back to the beginning, so that a
    // log line takes the line's place.
    if (IsInForeground(STDOUT_FILENO))
      out << "\r  " << ProgressText(player.progress()) << "\x1b[K\r" << std::flush;
    never.wait_for(lock, ended, 200ms, [] { return false; });
  }
  if (IsInForeground(STDOUT_FILENO)) out << "\x1b[K" << std::flush;
}

}  // namespace thalweg::cli
