#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace thalweg::cli {

/// The state of a run, for the live display.
struct LiveState {
  double time = 0.0;      ///< [s] On the run's clock.
  double rate = 0.0;      ///< Seconds of the run per second; 0 = unknown yet.
  double explored = 0.0;  ///< [m^3]
  std::optional<double> coverage;
  std::optional<unsigned> frontiers;   ///< Number of clusters left.
  double distance = 0.0;               ///< [m]
  std::optional<unsigned> collisions;  ///< True collisions.
  /// Sources from which nothing has been received yet: "pose", "map", ...
  std::vector<std::string> unheard;
  std::string stop;  ///< Why the robot is stopped, or where it goes back to; empty while it moves as planned.
  std::string trouble;  ///< Which messages a service refuses now, and why; empty if none.
  std::string activity;
  std::optional<double> left;  ///< [s] Wall time until the end, as far as anybody can know.
  double silence = 0.0;        ///< [s] Wall time since the explorer's last message.
};

/// Whether the explorer has not been heard for longer than usual.
bool IsSilent(const LiveState& state);

/// The same for programs; keys include their units, unknown values are null.
nlohmann::ordered_json ToJson(const LiveState& state);

/// Headings of the columns of LiveLine.
std::string LiveHeading(std::size_t columns);

/// One line of at most `columns` characters; one that is cut ends with a whole word and an ellipsis. Below
/// 100 columns the figures stand closer, since the activity needs the room.
std::string LiveLine(const LiveState& state, std::size_t columns);

/// "1:23" or "1:02:03".
std::string ClockText(double seconds);

}  // namespace thalweg::cli
