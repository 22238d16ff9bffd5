#include <utility>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

void AddWheels(Placement& car, double radius) {
  for (const double x : {-1.28, 1.31}) {
    for (const double y : {-0.84, 0.62}) {
      car.Column("dark", {x, y, radius}, {x, y + 0.22, radius}, radius, 12);
    }
  }
}

/// Adds a closed saloon car of 4.1 x 1.7 m.
void AddSaloon(BoxWorld& world, const Eigen::Vector2d& at, double yaw_deg) {
  Placement car(world, {at.x(), at.y(), 0}, yaw_deg);
  AddWheels(car, 0.32);
  car.Box("red", {-2.05, -0.85, 0.30}, {2.05, 0.85, 0.82});
  car.Box("dark", {-1.45, -0.74, 0.80}, {0.55, 0.74, 1.40});
  car.Box("dark", {0.28, -0.72, 0.90}, {1.20, 0.72, 1.0}, 0, -36);
  car.Box("red", {-1.35, -0.72, 1.39}, {0.45, 0.72, 1.43});
  for (const double y : {-0.98, 0.85}) car.Box("red", {0.45, y, 0.86}, {0.58, y + 0.13, 0.98});
}

/// Adds an open-topped car with its seats; the boot lid stands up.
void AddConvertible(BoxWorld& world, const Eigen::Vector2d& at, double yaw_deg) {
  Placement car(world, {at.x(), at.y(), 0}, yaw_deg);
  AddWheels(car, 0.30);
  car.Box("blue", {-2.0, -0.82, 0.30}, {2.0, 0.82, 0.46});
  for (const double y : {-0.82, 0.74}) car.Box("blue", {-2.0, y, 0.44}, {2.0, y + 0.08, 0.92});
  car.Box("blue", {0.65, -0.78, 0.44}, {2.0, 0.78, 0.90});
  car.Box("blue", {-1.25, -0.78, 0.44}, {-1.15, 0.78, 0.92});  // front, back and lid of the boot
  car.Box("blue", {-2.0, -0.78, 0.44}, {-1.92, 0.78, 0.92});
  car.Box("blue", {-1.85, -0.78, 1.20}, {-1.10, 0.78, 1.25}, 0, -60);
  car.Box("metal", {0.35, -0.76, 0.98}, {0.85, 0.76, 1.02}, 0, -48);
  for (const double y : {-0.62, 0.12}) {
    car.Box("wood", {-0.75, y, 0.46}, {-0.2, y + 0.5, 0.66});
    car.Box("wood", {-0.95, y, 0.60}, {-0.81, y + 0.5, 1.22}, 0, 12);
  }
  AddRing(world, "dark", Eigen::Vector3d(at.x() - 0.36, at.y() + 0.22, 0.95), {0, 0, 1}, 0.17, 0.04, 8);
}

void AddBicycle(BoxWorld& world) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.97, 0, 0.25).normalized();
  AddRing(world, "dark", {0.17, 1.1, 0.34}, normal, 0.32, 0.04, 12);
  AddRing(world, "dark", {0.17, 2.15, 0.34}, normal, 0.32, 0.04, 12);
  const Eigen::Vector3d rear(0.17, 1.1, 0.34);
  const Eigen::Vector3d front(0.17, 2.15, 0.34);
  const Eigen::Vector3d pedals(0.18, 1.55, 0.31);
  const Eigen::Vector3d saddle(0.04, 1.40, 0.87);
  const Eigen::Vector3d head(0.04, 2.0, 0.90);
  for (const auto& [a, b] : {std::pair{rear, pedals},
                             {rear, saddle},
                             {pedals, saddle},
                             {pedals, head},
                             {saddle, head},
                             {front, head}}) {
    world.Column("yellow", a, b, 0.02, 6);
  }
  world.Box("dark", {0.0, 1.28, 0.86}, {0.12, 1.52, 0.93});
  world.Column("metal", {0.0, 2.0, 0.94}, {0.32, 1.98, 1.0}, 0.02, 6);
}

void AddWorkshop(BoxWorld& world) {
  AddTable(world, {0.4, 8.36}, {3.3, 9.0}, 0.88);
  world.Box("wood", {0.6, 8.6, 0.12}, {1.7, 8.95, 0.5});  // under the bench
  world.Box("red", {2.1, 8.55, 0}, {2.6, 8.95, 0.45});
  world.Box("wood", {0.5, 8.97, 1.1}, {3.2, 9.0, 1.8});
  world.Box("blue", {1.0, 8.5, 0.88}, {1.4, 8.8, 1.08});
  world.Column("metal", {2.6, 8.6, 0.88}, {2.6, 8.6, 1.15}, 0.06, 8);
  AddShelf(world, {6.58, 0.5, 0.05}, {7, 2.6, 1.9}, 5);
  world.Box("green", {6.62, 0.8, 0.54}, {6.95, 1.3, 0.85});
  world.Box("yellow", {6.62, 1.8, 1.0}, {6.9, 2.2, 1.3});
  for (int k = 0; k < 4; ++k) {
    const double shift = 0.02 * (k % 3);
    world.Column("dark", {6.5 + shift, 8.45, 0.21 * k}, {6.5 + shift, 8.45, 0.21 * k + 0.2}, 0.33, 12);
  }
  world.Column("metal", {4.3, 8.55, 0}, {4.3, 8.55, 0.9}, 0.29, 12);
  world.Box("white", {5.0, 8.4, 0}, {5.7, 9.0, 1.6});
  for (const double y : {3.1, 3.55})
    world.Column("metal", {6.55, y, 0}, {6.95, y, 1.9}, 0.03, 6);  // a ladder
  for (int k = 1; k < 6; ++k) {
    const double x = 6.55 + 0.4 * k / 6.0;
    world.Column("metal", {x, 3.1, 1.9 * k / 6.0}, {x, 3.55, 1.9 * k / 6.0}, 0.02, 6);
  }
  world.TurnedBox("wood", {3.05, 0.1, 0}, {3.75, 0.7, 0.55}, 14);
  world.TurnedBox("wood", {3.1, 0.15, 0.55}, {3.6, 0.6, 0.95}, -9);
  world.Box("metal", {0, 6.4, 1.84}, {7, 6.5, 2.0});  // the rails of the door, and a hanging board
  world.Box("wood", {2.95, 2.6, 1.66}, {3.85, 5.6, 1.70});
  for (const double y : {2.8, 5.4}) world.Column("dark", {3.4, y, 1.68}, {3.4, y, 2.0}, 0.02, 6);
}

}  // namespace

BoxWorld MakeGarage() {
  BoxWorld world("garage", {0.053, 0.029, 0.022});
  AddMaterials(world);
  world.Shell({7, 9, 2}, "floor", "wall", "ceiling");
  AddSaloon(world, {1.95, 4.85}, 91.5);
  AddConvertible(world, {5.0, 4.95}, 86.0);
  AddBicycle(world);
  AddWorkshop(world);
  return world;
}

}  // namespace thalweg::simulator
