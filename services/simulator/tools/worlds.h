#pragma once

#include <vector>

#include "services/simulator/tools/box_world.h"

namespace thalweg::simulator {

// Sizes and kinds follow those of the source thesis.
BoxWorld MakeCar();      ///< 7 x 4 x 4 m: the cabin and boot of a car, twice life size.
BoxWorld MakeGallery();  ///< 10 x 10 x 5 m: rooms below and above a gallery, around an open space.
BoxWorld MakeKitchen();  ///< 8 x 8 x 3 m, with a pantry behind a doorway.
BoxWorld MakeHall();     ///< 8 x 18 x 5 m: side rooms on two levels along a hall.
BoxWorld MakeFlat();     ///< 6 x 8 x 2 m: a living room and a bedroom, joined by a door of 0.9 m.
BoxWorld MakeGarage();   ///< 7 x 9 x 2 m, with two cars, one of them open.

BoxWorld MakeOffice();    ///< 15 x 30 x 2 m: rooms on both sides of a corridor.
BoxWorld MakeMaze();      ///< 20 x 20 x 2 m, with a few loops.
BoxWorld MakeBridge();    ///< 10 x 20 x 5 m: a deck on pillars between two banks.
BoxWorld MakeComb();      ///< 15 x 6.5 x 2 m: nine dead ends along a corridor.
BoxWorld MakeOpenHall();  ///< 14 x 14 x 4 m, sparsely furnished.
BoxWorld MakeShaft();     ///< 8 x 7 x 5 m: two storeys, joined only by a shaft of 1.2 x 1.15 m.
BoxWorld MakeWarren();    ///< 12 x 10 x 2 m: rooms that branch like a tree; nothing to go around.

BoxWorld MakeTiny();  ///< 3 x 2.5 x 1.6 m with one box, for tests.

std::vector<BoxWorld> MakeAllWorlds();

}  // namespace thalweg::simulator
