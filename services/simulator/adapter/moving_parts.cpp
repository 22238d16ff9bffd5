#include "services/simulator/adapter/moving_parts.h"

#include <numbers>

#include "common/scenario/models.h"

namespace thalweg::simulator {

std::vector<MovingPart> MovingPartsFrom(const Scenario& scenario) {
  std::vector<MovingPart> parts;
  for (const thalweg::MovingPart& given : scenario.world().moving()) {
    MovingPart& part = parts.emplace_back();
    part.at_rest_W = {ToEigen(given.min_m()), ToEigen(given.max_m())};
    part.pivot_W = given.has_pivot_m() ? ToEigen(given.pivot_m()) : part.at_rest_W.center();
    part.period = given.period_s();
    for (const thalweg::MovingPart::Place& place : given.places()) {
      part.places.push_back({.time = place.time_s(),
                             .yaw = place.yaw_deg() * std::numbers::pi / 180.0,
                             .offset_W = ToEigen(place.offset_m())});
    }
  }
  return parts;
}

}  // namespace thalweg::simulator
