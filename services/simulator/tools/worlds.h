#pragma once

#include "services/simulator/tools/box_world.h"

namespace thalweg::simulator {

BoxWorld MakeKitchen();  ///< 8 x 8 x 3 m, with a pantry behind a doorway.
BoxWorld MakeFlat();     ///< 6 x 8 x 2 m: a living room and a bedroom, joined by a door of 0.9 m.
BoxWorld MakeTiny();     ///< 3 x 2.5 x 1.6 m with one box, for tests.

}  // namespace thalweg::simulator
