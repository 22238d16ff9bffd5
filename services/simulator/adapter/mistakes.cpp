#include "services/simulator/adapter/mistakes.h"

namespace thalweg::simulator {

std::vector<Mistake> MistakesIn(const Scenario& scenario) {
  if (!scenario.network().wall_clock()) return {};
  const auto* const network = Scenario::descriptor()->FindFieldByNumber(Scenario::kNetworkFieldNumber);
  const auto* const clock = Network::descriptor()->FindFieldByNumber(Network::kWallClockFieldNumber);
  const auto* const world = Scenario::descriptor()->FindFieldByNumber(Scenario::kWorldFieldNumber);
  const auto* const file = thalweg::World::descriptor()->FindFieldByNumber(thalweg::World::kFileFieldNumber);
  Mistake mistake;
  mistake.field = {network, clock};
  mistake.other = {world, file};
  mistake.text = "is true, which contradicts the simulator of " + ToString(mistake.other) +
                 ": the simulator provides the time; remove it, or run without the simulator";
  return {mistake};
}

}  // namespace thalweg::simulator
