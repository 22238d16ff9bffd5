#include <utility>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr double kFloor = 2.65;  // [m] height of the gallery's floor
constexpr double kTop = 5.0;

void AddStructure(BoxWorld& world) {
  world.Box("wood", {0, 7.2, 2.45}, {10, 10, kFloor});  // the gallery, along two walls
  world.Box("wood", {0, 0, 2.45}, {2.6, 7.25, kFloor});
  AddRailing(world, {2.55, 1.3, kFloor}, {2.55, 7.25, kFloor}, 6);
  AddRailing(world, {2.55, 7.25, kFloor}, {6.2, 7.25, kFloor}, 4);
  AddStairs(world, {5.95, 0.65, 0}, 180, 1.1, kFloor, 3.4, 13);
  world.Column("white", {2.62, 7.22, 0}, {2.62, 7.22, 2.5}, 0.16, 12);
  world.Column("white", {6.9, 6.95, 0}, {6.9, 6.95, kTop}, 0.14, 12);
}

void AddRoomsBelow(BoxWorld& world) {
  AddWall(world, {2.5, 7.36}, {10, 7.22}, 0, 2.45, {{.from = 0.9}, {.from = 5.4, .width = 1.0}});
  AddWall(world, {2.55, 0}, {2.48, 7.36}, 0, 2.45, {{.from = 1.3}, {.from = 4.9, .width = 0.95}});
  AddWall(world, {5.2, 7.25}, {5.55, 10}, 0, 2.45);
  AddWall(world, {0, 3.75}, {2.55, 3.52}, 0, 2.45);
  AddWall(world, {0, 7.3}, {2.55, 7.33}, 0, 2.45, {{.from = 0.7}});
  AddCot(world, {8.9, 9.35, 0}, 2);
  AddDesk(world, {6.3, 9.2}, 96);
  AddShelf(world, {9.66, 7.4, 0.06}, {10, 8.6, 2.0}, 5);
  AddTable(world, {3.3, 8.6}, {4.7, 9.5}, 0.75);
  AddChair(world, {3.9, 8.3}, 85);
  world.Box("white", {0, 9.4, 0}, {1.9, 10, 0.9});
  world.Box("metal", {0.1, 8.2, 0}, {0.7, 8.85, 1.75});
  AddDesk(world, {0.55, 1.4}, 180);
  AddShelf(world, {0.3, 0, 0.06}, {1.9, 0.36, 2.1}, 5);
  world.TurnedBox("blue", {1.6, 2.6, 0}, {2.2, 3.1, 0.7}, 24);
  AddCot(world, {0.75, 5.6, 0}, 91);
  world.Box("wood", {1.55, 3.62, 0}, {2.4, 4.1, 1.8});
}

void AddRoomAbove(BoxWorld& world) {
  AddWall(world, {6.15, 7.15}, {6.3, 10}, kFloor, kTop, {{.from = 1.6, .head = 1.95}});
  AddWall(world, {6.1, 7.24}, {10, 7.16}, kFloor, kTop,
          {{.from = 1.4, .width = 1.3, .sill = 0.9, .head = 1.8}});
  Placement room(world, {6.3, 7.3, kFloor}, 0);
  room.Box("green", {2.3, 1.6, 0.12}, {3.7, 2.4, 0.42});
  room.Box("green", {2.3, 2.2, 0.40}, {3.7, 2.4, 0.90});
  for (const double x : {2.35, 3.58}) room.Box("dark", {x, 1.65, 0}, {x + 0.07, 2.35, 0.13});
  room.Box("wood", {0.1, 0.05, 0}, {1.0, 0.5, 1.1});
  room.Box("wood", {2.9, 0.2, 0.4}, {3.6, 0.75, 0.44});
  room.Column("dark", {3.25, 0.48, 0}, {3.25, 0.48, 0.41}, 0.06, 8);
  room.Column("yellow", {1.9, 1.9, 0}, {1.9, 1.9, 1.4}, 0.025, 6);
  room.Column("yellow", {1.9, 1.9, 1.38}, {1.9, 1.9, 1.62}, 0.18, 8);
}

void AddHall(BoxWorld& world) {
  AddTable(world, {5.2, 2.6}, {7.4, 3.7}, 0.76);
  for (const double x : {5.7, 6.8}) {
    AddChair(world, {x, 2.35}, 88);
    AddChair(world, {x + 0.1, 3.95}, -95);
  }
  world.TurnedBox("dark", {8.3, 4.6, 0.62}, {9.7, 5.7, 0.92}, -32);  // a piano on legs
  for (const auto& [x, y] : {std::pair{8.55, 5.35}, {9.4, 4.85}, {9.25, 5.6}}) {
    world.Column("dark", {x, y, 0}, {x, y, 0.64}, 0.06, 8);
  }
  AddStool(world, {8.45, 4.35});
  AddShelf(world, {9.62, 0.6, 0.06}, {10, 3.2, 2.3}, 6);
  world.Box("red", {9.68, 1.0, 0.55}, {9.95, 1.5, 0.85});
  world.Box("blue", {9.68, 2.2, 1.45}, {9.95, 2.9, 1.75});
  world.TurnedBox("yellow", {3.4, 4.5, 0}, {3.46, 6.3, 1.7}, 12);  // a screen
  world.Box("green", {3.2, 2.1, 0}, {3.75, 2.65, 0.5});
  AddRing(world, "yellow", {6.2, 3.3, 3.7}, Eigen::Vector3d::UnitZ(), 0.55, 0.08);
  world.Column("yellow", {5.65, 3.3, 3.7}, {6.75, 3.3, 3.7}, 0.03, 6);
  world.Column("dark", {6.2, 3.3, 3.7}, {6.2, 3.3, kTop}, 0.025, 6);
  AddShelf(world, {0, 1.0, kFloor}, {0.35, 3.4, kFloor + 1.9}, 5);
  world.TurnedBox("red", {0.9, 5.2, kFloor}, {1.7, 6.0, kFloor + 0.45}, 31);
  world.Box("wood", {2.9, 9.5, kFloor}, {5.2, 10, kFloor + 0.85});
  world.Box("wood", {0, 8.4, kFloor}, {0.6, 10, kFloor + 1.5});
}

}  // namespace

BoxWorld MakeGallery() {
  BoxWorld world("gallery", {0.041, 0.067, 0.033});
  AddMaterials(world);
  world.Shell({10, 10, kTop}, "floor", "wall", "ceiling");
  AddStructure(world);
  AddRoomsBelow(world);
  AddRoomAbove(world);
  AddHall(world);
  return world;
}

}  // namespace thalweg::simulator
