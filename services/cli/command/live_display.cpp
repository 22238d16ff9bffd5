#include "services/cli/command/live_display.h"

#include <sys/ioctl.h>
#include <unistd.h>

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""ms;

constexpr std::size_t kPlainColumns = 160;

std::size_t TerminalColumns() {
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20;
  return known ? size.ws_col - 1U : 79U;
}

}  // namespace

LiveDisplay::LiveDisplay(std::ostream& out) : out_(out), terminal_(isatty(STDOUT_FILENO) == 1) {}

void LiveDisplay::Show(const LiveState& state) {
  const auto now = std::chrono::steady_clock::now();
  if (now - shown_ < (terminal_ ? 200ms : 5000ms)) return;
  shown_ = now;
  if (terminal_) {
    out_ << "\r\033[K" << LiveLine(state, TerminalColumns()) << std::flush;
    line_open_ = true;
  } else {
    out_ << LiveLine(state, kPlainColumns) << std::endl;
  }
}

void LiveDisplay::PrintLine(const std::string& text) {
  if (line_open_) out_ << "\r\033[K";
  line_open_ = false;
  out_ << text << std::endl;
}

void LiveDisplay::Release() {
  if (line_open_) out_ << std::endl;
  line_open_ = false;
}

}  // namespace thalweg::cli
