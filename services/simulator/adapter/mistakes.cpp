#include "services/simulator/adapter/mistakes.h"

namespace thalweg::simulator {

std::vector<Mistake> MistakesIn(const Scenario& scenario) {
  if (!scenario.network().wall_clock()) return {};
  Mistake mistake;
  mistake.field = PathOf("network", "wall_clock");
  mistake.other = PathOf("world", "file");
  mistake.text =
      "is true, which contradicts the simulator of " + ToString(mistake.other) +
      ": the simulator provides the time; remove it, or, for a robot of your own, add --without simulator";
  return {mistake};
}

}  // namespace thalweg::simulator
