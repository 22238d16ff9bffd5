#include <utility>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {

BoxWorld MakeOpenHall() {
  BoxWorld world("open_hall", {0.038, 0.027, 0.043});
  AddMaterials(world);
  world.Shell({14, 14, 4}, "floor", "wall", "ceiling");
  for (const auto& [x, y] : {std::pair{4.3, 4.6}, {9.7, 4.4}, {4.5, 9.6}, {9.5, 9.7}}) {
    world.Column("white", {x, y, 0}, {x, y, 4}, 0.24, 12);
  }
  AddShelf(world, {1.6, 6.2, 0.08}, {2.3, 9.4, 2.6}, 5);  // a rack in the open, with some goods
  world.Box("red", {1.7, 6.6, 0.70}, {2.2, 7.3, 1.1});
  world.Box("blue", {1.7, 8.1, 1.33}, {2.2, 9.0, 1.75});
  world.TurnedBox("wood", {11.2, 1.4, 0}, {12.4, 2.6, 1.1}, 24);  // crates
  world.TurnedBox("wood", {11.3, 1.6, 1.1}, {12.2, 2.5, 1.9}, -12);
  world.TurnedBox("wood", {12.6, 2.2, 0}, {13.4, 3.0, 0.8}, 55);
  world.TurnedBox("green", {6.2, 6.4, 0.55}, {8.2, 7.5, 0.62}, 17);  // a podium on four feet
  for (const auto& [x, y] : {std::pair{6.5, 6.4}, {7.9, 6.85}, {6.4, 7.1}, {7.8, 7.45}}) {
    world.Column("dark", {x, y, 0}, {x, y, 0.57}, 0.05, 6);
  }
  world.TurnedBox("yellow", {5.4, 12.2, 0}, {8.6, 12.26, 1.9}, -6);  // a screen
  world.TurnedBox("metal", {11.6, 10.8, 0}, {12.6, 12.6, 1.5}, 38);
  world.Column("metal", {3.0, 1.9, 0.5}, {6.2, 2.6, 0.5}, 0.5, 12);  // a boiler on its side
  world.Box("blue", {13.5, 6.0, 1.2}, {14, 8.2, 2.4});
  for (const double x : {3.4, 7.1, 10.8}) world.Box("wood", {x, 0, 3.72}, {x + 0.2, 14, 4});
  return world;
}

}  // namespace thalweg::simulator
