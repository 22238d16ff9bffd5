#include "services/explorer/core/strategy/surface.h"

namespace thalweg::explorer {

void Visit(OptionVisitor& visitor, Surface::Options& options) {
  visitor.Block("surface", [&](OptionVisitor& surface) {
    surface.Number("distance_m", options.criterion.distance);
    surface.Degrees("max_angle_deg", options.criterion.max_angle);
    surface.Number("min_area_m2", options.min_area);
    surface.Number("stop_cost_m", options.stop_cost);
    surface.Number("least_strip", options.least_strip);
    surface.Number("eagerness", options.eagerness);
  });
}

}  // namespace thalweg::explorer
