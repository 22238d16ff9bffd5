#include <utility>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr double kFloor = 2.55;  // [m] height of the upper rooms' floor
constexpr double kTop = 5.0;
constexpr double kLength = 18.0;

void AddSideRooms(BoxWorld& world) {
  world.Box("wood", {0, 0, 2.35}, {3.5, kLength, kFloor});  // the upper floor, with a balcony in front
  AddRailing(world, {3.44, 0, kFloor}, {3.44, 16.4, kFloor}, 12);
  AddStairs(world, {7.1, 17.3, 0}, 180, 1.1, kFloor, 3.6, 13);
  AddWall(world, {2.64, 0}, {2.53, kLength}, 0, 2.35,
          {{.from = 2.0}, {.from = 6.4, .width = 0.95}, {.from = 11.0}, {.from = 15.4, .width = 1.0}});
  AddWall(world, {2.56, 0}, {2.61, kLength}, kFloor, kTop,
          {{.from = 3.1, .width = 0.95}, {.from = 7.4}, {.from = 11.7}, {.from = 15.9, .head = 1.95}});
  AddWall(world, {0, 4.3}, {2.6, 4.62}, 0, 2.35);
  AddWall(world, {0, 9.2}, {2.6, 8.95}, 0, 2.35);
  AddWall(world, {0, 13.45}, {2.6, 13.6}, 0, 2.35);
  AddWall(world, {0, 5.05}, {2.6, 4.9}, kFloor, kTop);
  AddWall(world, {0, 9.55}, {2.6, 9.83}, kFloor, kTop);
  AddWall(world, {0, 14.1}, {2.6, 13.9}, kFloor, kTop);
}

void FurnishRooms(BoxWorld& world) {
  AddDesk(world, {0.6, 1.2}, 176);
  AddShelf(world, {0.2, 3.85, 0.06}, {1.7, 4.18, 2.0}, 5);
  AddCot(world, {0.75, 6.2, 0}, 92);
  world.Box("wood", {1.3, 8.4, 0}, {2.4, 8.85, 1.7});
  AddTable(world, {0.4, 10.2}, {1.4, 11.9}, 0.75);
  AddChair(world, {1.75, 10.7}, 178);
  world.TurnedBox("yellow", {0.3, 12.6, 0}, {0.9, 13.2, 0.6}, 20);
  AddShelf(world, {0, 14.4, 0.06}, {0.38, 17.2, 2.0}, 5);
  world.Box("red", {0.04, 15.0, 0.57}, {0.33, 15.5, 0.85});
  world.TurnedBox("wood", {1.2, 17.1, 0}, {1.8, 17.7, 0.6}, -15);
  AddCot(world, {0.8, 1.2, kFloor}, 181);
  world.Box("wood", {0, 3.5, kFloor}, {0.6, 4.8, kFloor + 1.9});
  AddShelf(world, {0.3, 5.15, kFloor}, {2.0, 5.5, kFloor + 1.8}, 5);
  world.TurnedBox("green", {0.6, 7.2, kFloor + 0.4}, {1.5, 8.3, kFloor + 0.45}, 9);
  world.Column("dark", {1.05, 7.75, kFloor}, {1.05, 7.75, kFloor + 0.41}, 0.07, 8);
  world.Box("blue", {0, 10.6, kFloor + 0.3}, {0.8, 12.6, kFloor + 0.5});
  for (const double y : {10.65, 12.45}) world.Box("dark", {0.1, y, kFloor}, {0.7, y + 0.1, kFloor + 0.31});
  world.TurnedBox("white", {1.5, 12.9, kFloor}, {1.56, 13.8, kFloor + 1.6}, 35);
  world.TurnedBox("red", {0.4, 15.1, kFloor}, {1.2, 15.7, kFloor + 0.7}, -12);
  world.Box("wood", {0, 17.3, kFloor}, {1.8, 18, kFloor + 1.1});
}

void FurnishHall(BoxWorld& world) {
  for (const auto& [x, y] : {std::pair{6.25, 3.3}, {6.17, 7.9}, {6.31, 12.6}}) {
    world.Column("white", {x, y, 0}, {x, y, kTop}, 0.22, 12);
  }
  world.Box("wood", {3.9, 0, 0.45}, {8, 1.9, 0.52});  // a stage on trestles, a curtain
  for (const double x : {4.0, 5.9, 7.8}) world.Box("dark", {x, 0.1, 0}, {x + 0.1, 1.8, 0.46});
  world.Box("red", {3.9, 0.55, 0.5}, {5.4, 0.62, 3.9});
  world.TurnedBox("red", {6.3, 0.5, 0.5}, {7.8, 0.57, 3.9}, 4);
  for (int row = 0; row < 4; ++row) {
    Placement bench(world, {4.9, 3.1 + 1.25 * row, 0}, 90 + 1.5 * row);
    bench.Box("wood", {-0.2, -0.9, 0.40}, {0.2, 0.9, 0.45});
    bench.Box("wood", {0.17, -0.9, 0.44}, {0.22, 0.9, 0.90});
    for (const double y : {-0.8, 0.72}) bench.Box("wood", {-0.18, y, 0}, {0.18, y + 0.08, 0.41});
  }
  world.TurnedBox("white", {4.9, 9.9, 0}, {5.7, 10.7, 0.9}, 45);  // a statue
  world.Column("metal", {5.3, 10.3, 0.9}, {5.35, 10.3, 2.4}, 0.2, 8);
  AddTable(world, {4.4, 12.6}, {5.3, 15.4}, 0.78);
  AddChair(world, {5.65, 13.2}, 184);
  AddChair(world, {5.7, 14.6}, 172);
  AddShelf(world, {7.64, 8.8, 0.06}, {8, 11.6, 2.2}, 5);
  world.Box("blue", {7.7, 9.4, 0.55}, {7.96, 9.9, 0.9});
  world.Box("wood", {7.2, 5.0, 0}, {8, 6.4, 1.1});
  world.TurnedBox("yellow", {4.1, 6.2, 3.3}, {7.7, 6.26, 4.4}, 3);  // a banner and the rod it hangs from
  world.Column("dark", {3.6, 6.2, 4.42}, {8, 6.35, 4.42}, 0.04, 6);
  AddRing(world, "yellow", {5.4, 14.2, 3.5}, Eigen::Vector3d::UnitZ(), 0.6, 0.08);
  world.Column("yellow", {4.8, 14.2, 3.5}, {6.0, 14.2, 3.5}, 0.03, 6);
  world.Column("dark", {5.4, 14.2, 3.5}, {5.4, 14.2, kTop}, 0.025, 6);
  for (const double y : {4.6, 9.1, 13.7}) world.Box("wood", {3.5, y, 4.75}, {8, y + 0.22, kTop});
}

}  // namespace

BoxWorld MakeHall() {
  BoxWorld world("hall", {0.047, 0.036, 0.018});
  AddMaterials(world);
  world.Shell({8, kLength, kTop}, "floor", "wall", "ceiling");
  AddSideRooms(world);
  FurnishRooms(world);
  FurnishHall(world);
  return world;
}

}  // namespace thalweg::simulator
