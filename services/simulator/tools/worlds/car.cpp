#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr double kScreen = 0.08;  // [m] thickness of the windscreens

/// Adds one of the two front seats, on rails, so that a camera can look under it.
void AddSeat(BoxWorld& world, const Eigen::Vector2d& at, double yaw_deg) {
  Placement seat(world, {at.x(), at.y(), 0}, yaw_deg);
  seat.Box("red", {-0.6, -0.55, 0.55}, {0.6, 0.55, 0.90});
  for (const double y : {-0.45, 0.37}) seat.Box("metal", {-0.5, y, 0}, {0.5, y + 0.08, 0.56});
  seat.Box("red", {-0.78, -0.5, 0.82}, {-0.53, 0.5, 2.28}, 0, 14);
  for (const double y : {-0.1, 0.1}) seat.Column("metal", {-0.82, y, 2.2}, {-0.87, y, 2.45}, 0.03, 6);
  seat.Box("dark", {-1.02, -0.22, 2.42}, {-0.78, 0.22, 2.76}, 0, 14);
}

/// Adds a bench of which a third is folded down, which opens a passage to the boot.
void AddRearBench(BoxWorld& world) {
  world.Box("red", {1.6, 0.2, 0}, {2.9, 2.6, 0.85});
  world.TurnedBox("red", {1.40, 0.2, 0.75}, {1.65, 2.6, 2.35}, 0, 10);
  for (const double y : {0.75, 1.95}) {
    for (const double post : {y - 0.1, y + 0.1}) {
      world.Column("metal", {1.39, post, 2.28}, {1.36, post, 2.5}, 0.03, 6);
    }
    world.TurnedBox("dark", {1.23, y - 0.25, 2.48}, {1.47, y + 0.25, 2.82}, 0, 10);
  }
  world.Box("red", {1.6, 2.7, 0}, {2.9, 3.85, 0.60});
  world.TurnedBox("dark", {1.5, 2.75, 0.62}, {2.95, 3.8, 0.84}, 0, -3);
  world.TurnedBox("blue", {0.25, 0.5, 0}, {0.75, 1.5, 0.72}, 8);  // in the boot
  world.TurnedBox("yellow", {0.8, 2.1, 0}, {1.2, 2.5, 0.38}, -22);
  world.Box("dark", {0, 3.4, 0}, {1.3, 4, 0.55});
}

void AddDashboard(BoxWorld& world) {
  world.Box("dark", {5.5, 0, 1.35}, {7, 4, 1.75});
  world.Box("dark", {5.33, 2.5, 1.68}, {5.9, 3.55, 1.97});
  world.Box("dark", {5.42, 0.35, 0.98}, {6.1, 1.5, 1.36});
  world.Box("metal", {5.25, 1.7, 0.30}, {6.6, 2.3, 1.40});
  world.Column("dark", {5.6, 3.02, 1.50}, {4.93, 3.02, 1.80}, 0.06, 8);
  AddRing(world, "dark", {4.93, 3.02, 1.80}, Eigen::Vector3d(-0.913, 0, 0.408).normalized(), 0.40, 0.07);
  world.Column("dark", {4.93, 2.64, 1.80}, {4.93, 3.40, 1.80}, 0.035, 6);
  for (const double y : {2.65, 2.95, 3.3})
    world.TurnedBox("metal", {6.1, y, 0.2}, {6.16, y + 0.16, 0.5}, 0, 25);
  world.Column("metal", {4.55, 2.03, 0.30}, {4.72, 2.05, 0.98}, 0.035, 6);
  world.Box("dark", {4.64, 1.97, 0.95}, {4.80, 2.13, 1.10});
}

}  // namespace

BoxWorld MakeCar() {
  BoxWorld world("car", {0.029, 0.063, 0.037});
  AddMaterials(world);
  world.Shell({7, 4, 4}, "dark", "blue", "white");
  world.TurnedBox("white", {3.9, -0.05, 2.83}, {7.1, 4.05, 2.83 + kScreen}, 0, -54.6);
  world.TurnedBox("white", {-0.2, -0.05, 3.01}, {2.2, 4.05, 3.01 + kScreen}, 0, 62.2);
  world.Box("dark", {0, 0, 2.0}, {1.4, 4, 2.1});  // the parcel shelf over the boot
  world.Box("dark", {1.9, 1.75, 0}, {5.4, 2.25, 0.32});
  AddDashboard(world);
  AddSeat(world, {3.9, 1.02}, 2.0);
  AddSeat(world, {4.03, 3.0}, 0.0);
  AddRearBench(world);
  for (const double y : {0.0, 3.78}) {  // armrests, and pockets in the doors
    world.Box("dark", {2.2, y, 1.25}, {4.8, y + 0.22, 1.40});
    world.Box("dark", {2.5, y == 0.0 ? 0.0 : 3.86, 0.2}, {4.4, y == 0.0 ? 0.14 : 4.0, 0.62});
  }
  world.Box("white", {3.1, 0, 3.86}, {3.32, 4, 4});
  world.TurnedBox("dark", {4.62, 1.72, 3.22}, {4.70, 2.32, 3.44}, 6);
  world.Column("dark", {4.66, 2.02, 3.42}, {4.55, 2.02, 4.0}, 0.025, 6);
  for (const double y : {0.12, 3.88}) world.Column("dark", {2.3, y, 3.72}, {2.9, y, 3.72}, 0.04, 6);
  return world;
}

}  // namespace thalweg::simulator
