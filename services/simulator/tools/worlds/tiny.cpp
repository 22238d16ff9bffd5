#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {

BoxWorld MakeTiny() {
  BoxWorld world("tiny", {0.033, 0.047, 0.024});
  AddMaterials(world);
  world.Shell({3, 2.5, 1.6}, "floor", "wall", "ceiling");
  world.Box("red", {1.9, 0.8, 0}, {2.4, 1.5, 0.7});
  return world;
}

}  // namespace thalweg::simulator
