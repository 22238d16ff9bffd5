#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

/// Adds base units, worktop, wall cupboards, hood and fridge along y = 0, from x = 0.6 to 6.1.
void AddWorktop(BoxWorld& world) {
  world.Box("dark", {0.6, 0, 0}, {3.0, 0.53, 0.11});  // plinth
  world.Box("white", {0.6, 0, 0.10}, {3.0, 0.60, 0.87});
  world.Box("dark", {3.62, 0, 0}, {5.4, 0.53, 0.11});  // beyond an open niche
  world.Box("white", {3.62, 0, 0.10}, {5.4, 0.60, 0.87});
  world.Box("wood", {0.6, 0, 0.86}, {5.4, 0.64, 0.90});
  world.Box("white", {0.6, 0, 1.45}, {2.6, 0.35, 2.15});
  world.Box("white", {3.6, 0, 1.45}, {5.4, 0.35, 2.15});
  world.Box("metal", {2.72, 0, 1.70}, {3.48, 0.50, 1.85});
  world.Box("metal", {2.95, 0, 1.84}, {3.25, 0.30, 3.0});
  world.Box("white", {5.4, 0, 0}, {6.1, 0.70, 1.92});
  world.Box("red", {0.9, 0.12, 0.90}, {1.3, 0.42, 1.10});      // bread bin
  world.Box("metal", {2.85, 0.20, 0.90}, {3.13, 0.48, 1.06});  // pot
  world.Box("blue", {4.2, 0.10, 0.90}, {4.38, 0.28, 1.16});
  world.Box("yellow", {4.9, 0.12, 0.90}, {5.2, 0.22, 1.28});
}

void AddIsland(BoxWorld& world) {
  world.Box("green", {2.6, 2.3, 0}, {4.6, 3.1, 0.89});
  world.Box("wood", {2.55, 2.25, 0.88}, {4.65, 3.45, 0.92});
  AddStool(world, {3.1, 3.55});
  AddStool(world, {4.1, 3.62});
  world.Box("yellow", {3.4, 2.6, 0.92}, {3.75, 2.9, 1.02});
}

void AddDining(BoxWorld& world) {
  AddTable(world, {2.2, 5.4}, {4.0, 6.4}, 0.76);
  AddChair(world, {2.65, 5.2}, 90.0);
  AddChair(world, {3.55, 5.15}, 82.0);
  AddChair(world, {2.7, 6.62}, -90.0);
  AddChair(world, {3.7, 6.95}, -125.0);
  world.Box("yellow", {2.95, 5.75, 1.70}, {3.25, 6.05, 1.92});  // lamp
  world.Box("dark", {3.085, 5.885, 1.91}, {3.115, 5.915, 3.0});
  world.Box("blue", {3.0, 5.8, 0.76}, {3.18, 5.98, 1.0});
}

/// Adds open shelves at the wall x = 0, a bench, a sideboard on legs with a hutch, a screen, and crates.
void AddAlongTheWalls(BoxWorld& world) {
  AddShelf(world, {0, 2.2, 0.06}, {0.4, 4.2, 2.12}, 5);
  world.Box("red", {0.03, 2.4, 0.085}, {0.36, 2.8, 0.38});
  world.Box("blue", {0.05, 3.4, 0.60}, {0.33, 3.75, 0.85});
  world.Box("green", {0.02, 2.5, 1.11}, {0.30, 2.7, 1.45});
  world.Box("yellow", {0.05, 3.1, 1.11}, {0.35, 3.95, 1.30});
  world.Box("white", {0.05, 2.9, 1.62}, {0.28, 3.2, 1.88});

  world.Box("wood", {0.4, 7.5, 0.40}, {2.0, 8.0, 0.45});  // bench
  world.Box("wood", {0.45, 7.55, 0}, {0.52, 7.95, 0.41});
  world.Box("wood", {1.88, 7.55, 0}, {1.95, 7.95, 0.41});

  world.Box("dark", {7.5, 2.0, 0.25}, {8.0, 4.0, 0.86});  // sideboard
  for (const double y : {2.05, 3.89}) {
    world.Box("dark", {7.53, y, 0}, {7.59, y + 0.06, 0.26});
    world.Box("dark", {7.9, y, 0}, {7.96, y + 0.06, 0.26});
  }
  AddShelf(world, {7.72, 2.3, 0.855}, {8.0, 3.7, 1.75}, 3);
  world.Box("red", {7.76, 2.5, 1.325}, {7.98, 2.95, 1.55});

  world.Box("blue", {5.2, 3.7, 0}, {5.26, 5.3, 1.80});  // screen
  world.Box("wood", {6.9, 0, 0}, {7.4, 0.45, 0.40});    // crates
  world.Box("wood", {7.4, 0, 0}, {8.0, 0.55, 0.62});
  world.TurnedBox("yellow", {7.5, 0.08, 0.62}, {7.9, 0.43, 0.95}, 18.0);
  world.Box("wood", {0, 5.1, 2.78}, {8, 5.28, 3.0});  // beams
  world.Box("wood", {0, 1.6, 2.78}, {8, 1.78, 3.0});
}

/// Adds a closet of 1.7 x 2.0 m in the corner, with its door open.
void AddPantry(BoxWorld& world) {
  world.Box("wall", {6.2, 5.9, 0}, {6.5, 6.0, 3.0});  // front: doorway from x = 6.5 to 7.4
  world.Box("wall", {7.4, 5.9, 0}, {8.0, 6.0, 3.0});
  world.Box("wall", {6.5, 5.9, 2.1}, {7.4, 6.0, 3.0});
  world.Box("wall", {6.2, 6.0, 0}, {6.3, 8.0, 3.0});
  world.TurnedBox("white", {7.05, 5.42, 0.02}, {7.85, 5.46, 2.05}, -72.0);
  AddShelf(world, {6.5, 7.6, 0.06}, {7.9, 8.0, 2.2}, 5);
  world.Box("red", {6.6, 7.66, 0.595}, {6.9, 7.95, 0.86});
  world.Box("green", {7.2, 7.68, 1.12}, {7.6, 7.96, 1.40});
  world.Box("wood", {7.45, 6.3, 0}, {7.95, 6.8, 0.45});
  world.Box("yellow", {7.5, 6.35, 0.45}, {7.85, 6.7, 0.80});
}

}  // namespace

BoxWorld MakeKitchen() {
  BoxWorld world("kitchen", {0.037, 0.053, 0.021});
  AddMaterials(world);
  world.Shell({8, 8, 3}, "floor", "wall", "ceiling");
  AddWorktop(world);
  AddIsland(world);
  AddDining(world);
  AddAlongTheWalls(world);
  AddPantry(world);
  return world;
}

}  // namespace thalweg::simulator
