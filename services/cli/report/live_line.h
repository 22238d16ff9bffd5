#pragma once

#include <optional>
#include <string>
#include <vector>

namespace thalweg::cli {

/// What a person wants to know while a run goes on.
struct LiveState {
  double time = 0.0;      ///< [s] of the run's clock.
  double rate = 0.0;      ///< Seconds of the run per second; 0 = not known yet.
  double explored = 0.0;  ///< [m^3]
  std::optional<double> coverage;
  std::optional<unsigned> frontiers;   ///< Clusters left.
  double distance = 0.0;               ///< [m]
  std::optional<unsigned> collisions;  ///< True ones.
  std::vector<std::string> unheard;    ///< What nothing was heard of yet: "pose", "map", ...
  std::string activity;
  double silence = 0.0;  ///< [s] Since the explorer was last heard, by the wall's clock.
};

/// What stands in which column of the lines below it.
std::string LiveHeading();

/// One line of at most `columns` characters.
std::string LiveLine(const LiveState& state, std::size_t columns);

/// "1:23" or "1:02:03".
std::string ClockText(double seconds);

}  // namespace thalweg::cli
