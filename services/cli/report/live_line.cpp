#include "services/cli/report/live_line.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace thalweg::cli {
namespace {

/// [s] An explorer says what it does twice a second.
constexpr double kSilent = 5.0;

template <class... Values>
std::string Format(const char* format, Values... values) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

std::string ClockText(double seconds) {
  const auto whole = static_cast<long>(std::floor(seconds + 0.5));
  if (whole >= 3600) return Format("%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  return Format("%ld:%02ld", whole / 60, whole % 60);
}

std::string LiveHeading() {
  return "    time  speed   explored    known  frontiers      path  what the robot does";
}

std::string LiveLine(const LiveState& state, std::size_t columns) {
  std::string line = Format("%8s", ClockText(state.time).c_str());
  line += state.rate > 0.0 ? Format("  %4.1fx", state.rate) : "      -";
  line += Format("  %6.1f m3", state.explored);
  line += state.coverage ? Format("  %5.1f %%", 100.0 * *state.coverage) : "        -";
  line += state.frontiers ? Format("  %9u", *state.frontiers) : "          -";
  line += Format("  %6.1f m  ", state.distance);
  if (state.collisions && *state.collisions > 0) line += Format("%u COLLISIONS  ", *state.collisions);
  const char* before = "no ";  // short: at 80 columns little is left of them
  for (const std::string& source : state.unheard) line += std::exchange(before, ", ") + source;
  if (!state.unheard.empty()) line += state.activity.empty() ? " heard yet" : ": ";
  if (!state.activity.empty()) {
    if (state.silence > kSilent) line += Format("explorer silent for %.0f s: ", state.silence);
    line += state.activity;
  }
  if (line.size() > columns) line.resize(columns);
  return line;
}

}  // namespace thalweg::cli
