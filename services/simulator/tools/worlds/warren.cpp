#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr double kTop = 2.0;
constexpr double kDoor = 1.9;

}  // namespace

BoxWorld MakeWarren() {
  BoxWorld world("warren", {0.037, 0.029, 0.021});
  AddMaterials(world);
  world.Shell({12, 10, kTop}, "floor", "wall", "ceiling");
  // A corridor from the west to a hall in the east, with a room on each side at either end.
  AddWall(world, {0, 4.3}, {9, 4.22}, 0, kTop,
          {{.from = 1.2, .width = 1.0, .head = kDoor}, {.from = 5.6, .width = 1.1, .head = kDoor}});
  AddWall(world, {0, 5.7}, {9, 5.82}, 0, kTop,
          {{.from = 2.5, .width = 1.0, .head = kDoor}, {.from = 7.3, .width = 1.0, .head = kDoor}});
  AddWall(world, {4.1, 0}, {4.0, 4.3}, 0, kTop);
  AddWall(world, {5.0, 5.7}, {5.12, 10}, 0, kTop);
  AddWall(world, {9.0, 0}, {9.06, 10}, 0, kTop, {{.from = 4.5, .width = 1.0, .head = kDoor}});
  // Behind one room lies another; walls that end in the open make nooks of the rest.
  AddWall(world, {5.1, 8.0}, {9.05, 8.12}, 0, kTop, {{.from = 0.7, .width = 1.0, .head = kDoor}});
  AddWall(world, {0, 8.0}, {3.4, 7.86}, 0, kTop);
  AddWall(world, {7.0, 0}, {7.06, 2.7}, 0, kTop);
  AddWall(world, {9.03, 7.2}, {10.8, 7.34}, 0, kTop);
  AddWall(world, {12, 2.9}, {10.2, 2.76}, 0, kTop);
  // Nothing stands free.
  world.Box("wood", {-0.05, 0.4, 0}, {0.45, 1.9, 1.1});
  world.Box("blue", {5.0, -0.05, 0}, {6.2, 0.4, 0.9});
  world.Box("red", {7.5, 9.55, 0}, {8.4, 10.05, 1.4});
  world.Box("green", {11.5, 5.2, 0}, {12.05, 6.4, 0.8});
  return world;
}

}  // namespace thalweg::simulator
