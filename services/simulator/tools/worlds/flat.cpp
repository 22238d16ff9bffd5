#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

void AddBed(BoxWorld& world) {
  world.Box("blue", {0.1, 5.4, 0.28}, {2.1, 7.0, 0.52});  // mattress, open underneath
  for (const double x : {0.12, 2.0}) {
    for (const double y : {5.42, 6.9}) world.Box("wood", {x, y, 0}, {x + 0.08, y + 0.08, 0.29});
  }
  world.Box("wood", {0.02, 5.4, 0.1}, {0.08, 7.0, 0.95});
  world.Box("white", {0.15, 5.55, 0.52}, {0.55, 6.1, 0.63});
  world.Box("white", {0.15, 6.3, 0.52}, {0.55, 6.85, 0.63});
  world.Box("wood", {0, 7.2, 0}, {0.42, 7.6, 0.50});
}

void AddBedroom(BoxWorld& world) {
  AddBed(world);
  world.Box("wood", {5.4, 5.0, 0}, {5.43, 5.77, 1.85});  // wardrobe, one half open
  world.Box("wood", {5.42, 5.0, 0}, {6.0, 5.03, 1.85});
  world.Box("wood", {5.42, 6.57, 0}, {6.0, 6.6, 1.85});
  world.Box("wood", {5.42, 5.75, 0}, {6.0, 5.78, 1.84});
  world.Box("wood", {5.4, 5.0, 1.82}, {6.0, 6.6, 1.85});
  world.Box("white", {4.0, 7.3, 0.70}, {5.4, 8.0, 0.74});  // desk
  world.Box("white", {4.0, 7.32, 0}, {4.03, 7.98, 0.71});
  world.Box("white", {4.95, 7.32, 0}, {5.38, 7.98, 0.71});
  world.Box("dark", {4.4, 7.75, 0.74}, {4.95, 7.80, 1.12});
  AddChair(world, {4.5, 6.95}, 80.0);
  AddShelf(world, {2.3, 7.68, 0.05}, {3.4, 8.0, 1.5}, 4);
  world.Box("green", {2.5, 7.72, 0.55}, {2.9, 7.96, 0.80});
}

void AddLivingRoom(BoxWorld& world) {
  world.Box("green", {0, 1.2, 0.12}, {0.85, 3.2, 0.42});  // sofa
  world.Box("green", {0, 1.2, 0.40}, {0.22, 3.2, 0.85});
  world.Box("green", {0, 1.2, 0.40}, {0.85, 1.38, 0.62});
  world.Box("green", {0, 3.02, 0.40}, {0.85, 3.2, 0.62});
  for (const double y : {1.25, 3.1}) {
    world.Box("dark", {0.05, y, 0}, {0.1, y + 0.05, 0.13});
    world.Box("dark", {0.75, y, 0}, {0.8, y + 0.05, 0.13});
  }
  AddTable(world, {1.5, 1.7}, {2.2, 2.8}, 0.45);
  AddTable(world, {3.6, 0.7}, {5.0, 1.5}, 0.74);
  AddChair(world, {4.0, 0.5}, 90.0);
  AddChair(world, {4.55, 1.85}, -100.0);
  AddChair(world, {5.3, 1.1}, 180.0);
  AddShelf(world, {5.68, 2.3, 0.05}, {6.0, 4.0, 1.8}, 5);
  world.Box("red", {5.72, 2.5, 0.50}, {5.95, 2.85, 0.75});
  world.Box("blue", {5.7, 3.3, 0.94}, {5.96, 3.7, 1.15});
  world.Box("dark", {0.9, 0, 0.2}, {2.5, 0.42, 0.50});  // a low board at the wall with a screen above it
  world.Box("dark", {1.0, 0.08, 0.62}, {2.3, 0.13, 1.35});
  world.Box("wood", {1.6, 0.0, 0.80}, {1.7, 0.09, 1.0});
  world.Box("white", {0, 3.6, 0}, {0.5, 4.12, 0.9});
}

}  // namespace

BoxWorld MakeFlat() {
  BoxWorld world("flat", {0.043, 0.031, 0.017});
  AddMaterials(world);
  world.Shell({6, 8, 2}, "floor", "wall", "ceiling");
  world.Box("wall", {0, 4.12, 0}, {2.5, 4.24, 2});  // the wall between the rooms, with a doorway
  world.Box("wall", {3.4, 4.12, 0}, {6, 4.24, 2});
  world.Box("wall", {2.5, 4.12, 1.9}, {3.4, 4.24, 2});
  world.TurnedBox("white", {3.02, 4.66, 0.02}, {3.84, 4.70, 1.88}, 70.0);  // the door of that doorway
  AddLivingRoom(world);
  AddBedroom(world);
  return world;
}

}  // namespace thalweg::simulator
