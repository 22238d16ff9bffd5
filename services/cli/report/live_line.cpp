#include "services/cli/report/live_line.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "common/base/text.h"
#include "services/cli/report/remaining_time.h"

namespace thalweg::cli {
namespace {

using Json = nlohmann::ordered_json;

/// [s] An explorer publishes its status twice a second.
constexpr double kSilent = 5.0;
constexpr std::size_t kWide = 100;

/// The text if it has at most `columns` characters, else what of it fits: whole words, and an ellipsis.
std::string Shortened(const std::string& text, std::size_t columns) {
  const std::string_view fits = FirstCharacters(text, columns);
  if (fits.size() == text.size() || columns == 0) return std::string(fits);
  std::string_view kept = FirstCharacters(text, columns - 1);
  const bool within_a_word = text[kept.size()] != ' ';
  if (const std::size_t space = kept.rfind(' '); within_a_word && space != std::string_view::npos)
    kept = kept.substr(0, space);
  kept = kept.substr(0, kept.find_last_not_of(" ,;:") + 1);
  return std::string(kept) + "\u2026";
}

std::string Figures(const LiveState& state) {
  std::string line = fmt::format("{:>8}", ClockText(state.time));
  line += state.rate > 0.0 ? fmt::format("  {:4.1f}x", state.rate) : "      -";
  line += fmt::format("  {:6.1f} m3", state.explored);
  line += state.coverage ? fmt::format("  {:5.1f} %", 100.0 * *state.coverage) : "        -";
  line += state.frontiers ? fmt::format("  {:9}", *state.frontiers) : "          -";
  return line + fmt::format("  {:6.1f} m  ", state.distance);
}

std::string ClosePackedFigures(const LiveState& state) {
  std::string line = fmt::format("{:>7}", ClockText(state.time));
  line += state.rate > 0.0 ? fmt::format(" {:4.1f}x", state.rate) : "     -";
  line += fmt::format(" {:6.1f}m3", state.explored);
  line += state.coverage ? fmt::format(" {:5.1f}%", 100.0 * *state.coverage) : "      -";
  line += state.frontiers ? fmt::format(" {:4}", *state.frontiers) : "    -";
  return line + fmt::format(" {:5.0f}m  ", state.distance);
}

}  // namespace

bool IsSilent(const LiveState& state) {
  return state.silence > kSilent;
}

Json ToJson(const LiveState& state) {
  const auto known = [](const auto& value) { return value ? Json(*value) : Json(nullptr); };
  return {{"t_s", state.time},
          {"rate", state.rate > 0.0 ? Json(state.rate) : Json(nullptr)},
          {"explored_m3", state.explored},
          {"coverage", known(state.coverage)},
          {"frontiers", known(state.frontiers)},
          {"distance_m", state.distance},
          {"collisions", known(state.collisions)},
          {"left_s", known(state.left)},
          {"unheard", state.unheard},
          {"explorer_silent_s", state.silence},
          {"trouble", state.trouble},
          {"activity", state.activity}};
}

std::string ClockText(double seconds) {
  const auto whole = static_cast<long>(std::floor(seconds + 0.5));
  if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

std::string LiveHeading(std::size_t columns) {
  return columns < kWide ? "   time speed explored  known left   path  activity"
                         : "    time  speed   explored    known  frontiers      path  activity";
}

std::string LiveLine(const LiveState& state, std::size_t columns) {
  std::string line = columns < kWide ? ClosePackedFigures(state) : Figures(state);
  if (state.collisions && *state.collisions > 0) line += fmt::format("{} COLLISIONS  ", *state.collisions);
  const char* before = "no ";
  for (const std::string& source : state.unheard) line += std::exchange(before, ", ") + source;
  if (!state.unheard.empty() && !state.activity.empty()) {
    line += ": ";
  } else if (!state.unheard.empty()) {
    line += state.trouble.empty() ? " yet" : " yet; ";
  }
  if (!state.trouble.empty()) line += state.trouble + (state.activity.empty() ? "" : "; ");
  if (state.left) line += AboutText(*state.left) + " left: ";
  if (!state.stop.empty()) line += "robot stopped: " + state.stop + (state.activity.empty() ? "" : "; ");
  if (!state.activity.empty()) {
    if (IsSilent(state)) line += fmt::format("explorer silent for {:.0f} s: ", state.silence);
    line += state.activity;
  }
  return Shortened(line, columns);
}

}  // namespace thalweg::cli
