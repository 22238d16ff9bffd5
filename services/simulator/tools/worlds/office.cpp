#include <array>
#include <utility>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr double kTop = 2.0;
constexpr double kDoor = 1.88;

void AddWalls(BoxWorld& world) {
  AddWall(world, {6.55, 0}, {6.42, 30}, 0, kTop,
          {{.from = 2.3, .head = kDoor},
           {.from = 8.1, .width = 0.95, .head = kDoor},
           {.from = 14.6, .head = kDoor},
           {.from = 20.2, .width = 0.95, .head = kDoor},
           {.from = 27.1, .head = kDoor}});
  for (const auto& [y, skew] : {std::pair{6.05, 0.1}, {11.85, -0.14}, {18.2, 0.2}, {24.1, 0.0}}) {
    AddWall(world, {0, y}, {6.5, y + skew}, 0, kTop);
  }
  // The other side is open as far as y = 13, except for pillars; then follow a meeting room, a kitchen and a
  // store.
  for (const double y : {3.1, 6.4, 9.8}) {
    world.TurnedBox("white", {8.35, y, 0}, {8.7, y + 0.35, kTop}, 3.0 * y);
  }
  AddWall(world, {8.5, 13.1}, {15, 13.1}, 0, kTop);
  AddWall(world, {8.52, 13.05}, {8.44, 30}, 0, kTop,
          {{.from = 1.6, .width = 1.0, .head = kDoor},
           {.from = 4.0, .width = 1.6, .sill = 0.9, .head = 1.7},
           {.from = 8.6, .width = 1.2, .head = kDoor},
           {.from = 14.2, .head = kDoor}});
  AddWall(world, {8.5, 20.05}, {15, 19.8}, 0, kTop);
  AddWall(world, {8.5, 25.1}, {15, 25.1}, 0, kTop, {{.from = 4.6, .head = kDoor}});
}

void FurnishRooms(BoxWorld& world) {
  for (const auto& [x, y, yaw] : {std::array{1.0, 1.2, 180.0},
                                  {4.4, 5.0, 92.0},
                                  {1.0, 7.8, 182.0},
                                  {1.2, 10.6, 175.0},
                                  {3.6, 13.2, -90.0},
                                  {1.1, 16.4, 180.0},
                                  {3.9, 16.9, 88.0},
                                  {1.0, 20.1, 184.0},
                                  {4.6, 22.9, 90.0},
                                  {2.2, 28.9, 91.0},
                                  {4.6, 28.8, 90.0}}) {
    AddDesk(world, {x, y}, yaw);
  }
  AddShelf(world, {2.6, 0, 0.05}, {5.0, 0.36, 1.8}, 5);
  AddShelf(world, {4.2, 6.2, 0.05}, {6.2, 6.54, 1.8}, 5);
  AddShelf(world, {0, 12.4, 0.05}, {0.36, 14.4, 1.8}, 5);
  AddShelf(world, {2.4, 18.45, 0.05}, {4.4, 18.8, 1.8}, 5);
  AddShelf(world, {0, 24.5, 0.05}, {0.36, 27.6, 1.8}, 5);
  world.Box("wood", {0, 4.4, 0}, {0.6, 5.8, 1.5});
  world.TurnedBox("green", {4.6, 9.4, 0}, {5.6, 10.3, 0.42}, 28);
  world.Box("white", {5.6, 12.0, 0}, {6.3, 12.7, 1.4});
  world.TurnedBox("white", {2.6, 21.4, 0.1}, {2.66, 23.2, 1.7}, 10);
  for (const double y : {21.5, 23.0}) world.TurnedBox("dark", {2.4, y, 0}, {2.86, y + 0.08, 0.12}, 10);
  world.TurnedBox("wood", {3.3, 25.2, 0}, {3.9, 25.8, 0.6}, 33);
}

void FurnishOpenPlan(BoxWorld& world) {
  for (const auto& [x, y, yaw] : {std::array{10.4, 1.9, 0.0},
                                  {11.9, 1.95, 180.0},
                                  {10.4, 5.4, 2.0},
                                  {11.9, 5.4, 180.0},
                                  {13.9, 8.2, 0.0},
                                  {10.6, 10.6, 270.0}}) {
    AddDesk(world, {x, y}, yaw);
  }
  world.Box("blue", {10.8, 3.45, 0}, {11.5, 3.5, 1.3});
  world.TurnedBox("blue", {10.1, 7.6, 0.05}, {12.4, 7.66, 1.5}, -8);
  AddShelf(world, {14.62, 2.0, 0.05}, {15, 5.2, 1.7}, 5);
  world.Box("red", {14.66, 2.5, 0.5}, {14.95, 3.0, 0.8});
  world.Box("white", {13.2, 12.2, 0}, {14.9, 12.95, 1.1});
  world.TurnedBox("green", {13.3, 10.6, 0}, {14.1, 11.4, 0.42}, 40);
}

void FurnishOtherRooms(BoxWorld& world) {
  AddTable(world, {10.3, 15.3}, {13.4, 17.2}, 0.74);  // meeting
  for (const double x : {10.9, 11.9, 12.8}) {
    AddChair(world, {x, 14.95}, 92);
    AddChair(world, {x + 0.15, 17.6}, -86);
  }
  world.Box("dark", {14.9, 15.4, 0.8}, {15, 17.2, 1.7});
  world.Box("wood", {13.9, 19.0, 0}, {15, 19.6, 0.8});
  world.Box("white", {10.4, 24.45, 0}, {12.9, 25.04, 0.88});  // kitchen
  world.Box("white", {14.3, 20.1, 0}, {15, 20.8, 1.75});
  AddTable(world, {10.4, 21.6}, {12.2, 22.7}, 0.75);
  AddChair(world, {10.1, 22.1}, -4);
  AddChair(world, {12.55, 22.2}, 176);
  AddStool(world, {14.1, 23.1});
  AddShelf(world, {9.3, 27.2, 0.05}, {12.4, 27.6, 1.8}, 5);  // store
  AddShelf(world, {9.2, 29.6, 0.05}, {12.8, 30, 1.8}, 5);
  world.Box("yellow", {9.8, 27.25, 0.5}, {10.5, 27.55, 0.85});
  world.TurnedBox("wood", {13.5, 28.4, 0}, {14.4, 29.3, 0.9}, 17);
  world.TurnedBox("wood", {13.7, 28.5, 0.9}, {14.3, 29.1, 1.4}, -24);
  world.TurnedBox("green", {7.1, 29.0, 0}, {7.7, 29.6, 0.9}, 20);  // corridor
  world.Box("red", {6.55, 12.6, 0.2}, {6.85, 13.9, 0.95});
}

}  // namespace

BoxWorld MakeOffice() {
  BoxWorld world("office", {0.031, 0.058, 0.019});
  AddMaterials(world);
  world.Shell({15, 30, kTop}, "floor", "wall", "ceiling");
  AddWalls(world);
  FurnishRooms(world);
  FurnishOpenPlan(world);
  FurnishOtherRooms(world);
  return world;
}

}  // namespace thalweg::simulator
