#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {

std::vector<BoxWorld> MakeAllWorlds() {
  return {MakeCar(),  MakeGallery(), MakeKitchen(), MakeHall(),     MakeFlat(),  MakeGarage(), MakeOffice(),
          MakeMaze(), MakeBridge(),  MakeComb(),    MakeOpenHall(), MakeShaft(), MakeWarren(), MakeTiny()};
}

}  // namespace thalweg::simulator
