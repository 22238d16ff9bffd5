#include "services/cli/report/live_display.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <limits>

#include "common/base/environment.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""ms;

constexpr std::size_t kAllColumns = std::numeric_limits<std::size_t>::max();  // outside of a terminal
constexpr auto kQuietColor = "\033[2m";
constexpr auto kPlainColor = "\033[0m";

std::size_t TerminalColumns() {
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20;
  return known ? size.ws_col - 1U : 79U;
}

const char* ColorOf(LiveDisplay::Tone tone) {
  switch (tone) {
    case LiveDisplay::Tone::kGood:
      return "\033[1;32m";
    case LiveDisplay::Tone::kWarning:
      return "\033[33m";
    case LiveDisplay::Tone::kError:
      return "\033[1;31m";
    case LiveDisplay::Tone::kPlain:
      break;
  }
  return "";
}

const char* LevelOf(LiveDisplay::Tone tone) {
  if (tone == LiveDisplay::Tone::kWarning) return "warning";
  return tone == LiveDisplay::Tone::kError ? "error" : "info";
}

}  // namespace

LiveDisplay::Style LiveDisplay::StyleFor(bool json) {
  if (json) return Style::kJson;
  return isatty(STDOUT_FILENO) == 1 && Environment("TERM") != "dumb" ? Style::kTerminal : Style::kPlain;
}

bool LiveDisplay::WantsColor(Style style) {
  return style == Style::kTerminal && Environment("NO_COLOR").empty();  // no-color.org
}

void LiveDisplay::ShowHeading() {
  if (style_ == Style::kJson) return;
  const std::size_t columns = style_ == Style::kTerminal ? TerminalColumns() : kAllColumns;
  out_ << (color_ ? kQuietColor : "") << LiveHeading(columns) << (color_ ? kPlainColor : "") << std::endl;
}

void LiveDisplay::Show(const LiveState& state) {
  const auto now = std::chrono::steady_clock::now();
  const auto period = style_ == Style::kTerminal ? 200ms : style_ == Style::kJson ? 1000ms : 5000ms;
  if (now - shown_ < period) return;
  shown_ = now;
  if (style_ == Style::kJson) return PrintEvent("progress", ToJson(state));
  if (style_ == Style::kPlain) {
    out_ << LiveLine(state, kAllColumns) << std::endl;
    return;
  }
  const bool wrong = state.collisions.value_or(0) > 0 || IsSilent(state);
  const std::string line = LiveLine(state, TerminalColumns());
  out_ << "\r\033[K" << (color_ && wrong ? ColorOf(Tone::kError) : "") << line << (color_ ? kPlainColor : "")
       << std::flush;
  line_open_ = true;
}

void LiveDisplay::PrintLine(const std::string& text, Tone tone) {
  if (style_ == Style::kJson) return PrintEvent("message", {{"level", LevelOf(tone)}, {"text", text}});
  if (line_open_) out_ << "\r\033[K";
  line_open_ = false;
  const bool colored = color_ && tone != Tone::kPlain;
  out_ << (colored ? ColorOf(tone) : "") << text << (colored ? kPlainColor : "") << std::endl;
}

void LiveDisplay::PrintEvent(const std::string& name, const nlohmann::ordered_json& fields) {
  if (style_ != Style::kJson) return;
  nlohmann::ordered_json object = {{"event", name}};
  object.update(fields);
  out_ << object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << std::endl;
}

void LiveDisplay::Release() {
  if (line_open_) out_ << std::endl;
  line_open_ = false;
}

}  // namespace thalweg::cli
