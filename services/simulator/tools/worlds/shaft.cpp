#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr double kLower = 2.1;  // [m] top of the lower storey
constexpr double kUpper = 3.0;  // [m] floor of the upper one
constexpr double kTop = 5.0;

}  // namespace

BoxWorld MakeShaft() {
  BoxWorld world("shaft", {0.032, 0.049, 0.027});
  AddMaterials(world);
  world.Shell({8, 7, kTop}, "floor", "wall", "ceiling");
  // The slab between the storeys, which leaves open a shaft from (3.4, 2.6) to (4.6, 3.75).
  world.Box("metal", {0, 0, kLower}, {3.4, 7, kUpper});
  world.Box("metal", {4.6, 0, kLower}, {8, 7, kUpper});
  world.Box("metal", {3.4, 0, kLower}, {4.6, 2.6, kUpper});
  world.Box("metal", {3.4, 3.75, kLower}, {4.6, 7, kUpper});
  for (int k = 0; k < 6; ++k) {  // rungs
    const double z = kLower - 0.3 + 0.28 * k;
    world.Column("yellow", {3.75, 2.66, z}, {4.25, 2.66, z}, 0.025, 6);
  }

  AddWall(world, {4.95, 0}, {5.1, 7}, 0, kLower, {{.from = 5.2, .width = 0.95, .head = 1.9}});
  AddWall(world, {0, 4.55}, {5.0, 4.7}, 0, kLower, {{.from = 0.8, .head = 1.9}});
  AddDesk(world, {0.8, 1.4}, 178);
  AddShelf(world, {1.8, 0, 0.06}, {3.4, 0.36, 1.9}, 5);
  AddCot(world, {7.2, 2.1, 0}, -90);
  world.TurnedBox("green", {5.6, 0.4, 0}, {6.2, 1.0, 0.7}, 22);
  world.TurnedBox("yellow", {6.4, 5.3, 0}, {7.1, 6.0, 0.9}, 41);
  world.Box("wood", {2.6, 6.4, 0}, {4.4, 7, 1.2});
  AddTable(world, {2.0, 5.0}, {3.1, 5.9}, 0.7);

  AddWall(world, {0, 2.0}, {3.0, 1.85}, kUpper, kTop, {{.from = 1.4, .head = 1.85}});
  AddWall(world, {2.9, -0.05}, {3.0, 1.9}, kUpper, kTop);
  AddWall(world, {5.6, 4.2}, {8, 4.35}, kUpper, kTop, {{.from = 0.3, .head = 1.85}});
  AddWall(world, {5.55, 4.2}, {5.4, 7}, kUpper, kTop);
  AddRailing(world, {4.75, 2.4, kUpper}, {4.75, 3.95, kUpper}, 3);
  AddShelf(world, {0, 3.2, kUpper}, {0.36, 6.2, kUpper + 1.7}, 5);
  AddCot(world, {1.2, 0.7, kUpper}, 0);
  world.TurnedBox("red", {6.3, 1.0, kUpper}, {7.3, 1.9, kUpper + 0.8}, 15);
  world.TurnedBox("blue", {2.4, 5.2, kUpper + 0.1}, {2.46, 6.7, kUpper + 1.6}, -20);
  for (const double y : {5.3, 6.55})
    world.TurnedBox("dark", {2.2, y, kUpper}, {2.66, y + 0.08, kUpper + 0.12}, -20);
  world.Box("wood", {7.2, 5.6, kUpper}, {8, 7, kUpper + 1.5});
  world.TurnedBox("white", {5.8, 6.2, kUpper}, {6.3, 6.7, kUpper + 0.5}, 33);
  return world;
}

}  // namespace thalweg::simulator
