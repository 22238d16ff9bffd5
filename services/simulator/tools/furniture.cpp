#include "services/simulator/tools/furniture.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/base/angles.h"

namespace thalweg::simulator {
namespace {

constexpr double kBoard = 0.025;   // [m] thickness of boards
constexpr double kLeg = 0.05;      // [m] thickness of legs
constexpr double kOverlap = 0.01;  // [m] between parts of a wall, so that there are no cracks

}  // namespace

void AddMaterials(BoxWorld& world) {
  world.Material("floor", {0.55, 0.45, 0.36});
  world.Material("wall", {0.80, 0.78, 0.72});
  world.Material("ceiling", {0.88, 0.88, 0.88});
  world.Material("wood", {0.66, 0.46, 0.26});
  world.Material("dark", {0.30, 0.27, 0.28});
  world.Material("white", {0.92, 0.92, 0.90});
  world.Material("metal", {0.60, 0.63, 0.66});
  world.Material("red", {0.72, 0.22, 0.18});
  world.Material("green", {0.28, 0.52, 0.28});
  world.Material("blue", {0.24, 0.36, 0.62});
  world.Material("yellow", {0.86, 0.72, 0.26});
}

Placement::Placement(BoxWorld& world, const Eigen::Vector3d& at, double yaw_deg)
    : world_(world), at_(at), yaw_deg_(yaw_deg) {}

Eigen::Vector3d Placement::Placed(const Eigen::Vector3d& p) const {
  return at_ + Eigen::AngleAxisd(yaw_deg_ * kDegree, Eigen::Vector3d::UnitZ()) * p;
}

void Placement::Box(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                    double yaw_deg, double lean_deg) {
  const Eigen::Vector3d middle = Placed(0.5 * (low + high));
  const Eigen::Vector3d half = 0.5 * (high - low);
  world_.TurnedBox(material, middle - half, middle + half, yaw_deg_ + yaw_deg, lean_deg);
}

void Placement::Column(std::string_view material, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                       double radius, int sides) {
  world_.Column(material, Placed(from), Placed(to), radius, sides);
}

void AddWall(BoxWorld& world, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double foot, double top,
             const std::vector<Opening>& openings, double thickness) {
  const Eigen::Vector2d along = to - from;
  Placement wall(world, {from.x(), from.y(), foot}, std::atan2(along.y(), along.x()) / kDegree);
  const double height = top - foot;
  const auto part = [&](double start, double end, double low, double high) {
    if (end > start && high > low) {
      wall.Box("wall", {start, -0.5 * thickness, low}, {end, 0.5 * thickness, high});
    }
  };
  double built = 0.0;
  for (const Opening& opening : openings) {
    const double end = opening.from + opening.width;
    part(built, opening.from, 0.0, height);
    part(opening.from - kOverlap, end + kOverlap, opening.head, height);
    part(opening.from - kOverlap, end + kOverlap, 0.0, opening.sill);
    built = end;
  }
  part(built, along.norm(), 0.0, height);
}

void AddRailing(BoxWorld& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to, int posts) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (int k = 0; k < posts; ++k) {
    const Eigen::Vector3d foot = from + (to - from) * k / (posts - 1);
    world.Column("metal", foot, foot + 0.95 * up, 0.03, 6);
  }
  world.Column("wood", from + 0.95 * up, to + 0.95 * up, 0.045, 6);
  world.Column("metal", from + 0.5 * up, to + 0.5 * up, 0.025, 6);
}

void AddStairs(BoxWorld& world, const Eigen::Vector3d& foot, double yaw_deg, double width, double rise,
               double run, int steps) {
  Placement stairs(world, foot, yaw_deg);
  for (int k = 1; k <= steps; ++k) {
    const double z = rise * k / steps;
    const double x = run * (k - 1) / steps;
    stairs.Box("wood", {x - 0.02, -0.5 * width, z - 0.06}, {x + run / steps, 0.5 * width, z});
  }
}

void AddRing(BoxWorld& world, std::string_view material, const Eigen::Vector3d& center,
             const Eigen::Vector3d& normal, double radius, double thickness, int sides) {
  const Eigen::Vector3d aside = normal.unitOrthogonal();
  const Eigen::Vector3d across = normal.cross(aside);
  const auto at = [&](int k) -> Eigen::Vector3d {
    const double angle = 2.0 * std::numbers::pi * k / sides;
    return center + radius * (std::cos(angle) * aside + std::sin(angle) * across);
  };
  for (int k = 0; k < sides; ++k) world.Column(material, at(k), at(k + 1), 0.5 * thickness, 6);
}

void AddDesk(BoxWorld& world, const Eigen::Vector2d& center, double yaw_deg) {
  Placement desk(world, {center.x(), center.y(), 0}, yaw_deg);
  desk.Box("wood", {-0.35, -0.7, 0.70}, {0.35, 0.7, 0.74});
  desk.Box("metal", {-0.3, -0.68, 0}, {0.3, -0.64, 0.71});
  desk.Box("white", {-0.3, 0.28, 0}, {0.3, 0.68, 0.71});
  desk.Box("dark", {0.2, -0.35, 0.82}, {0.25, 0.25, 1.18}, 7.0);
  desk.Box("dark", {0.16, -0.12, 0.74}, {0.3, 0.04, 0.84});
  const Eigen::Rotation2Dd turn(yaw_deg * kDegree);
  AddChair(world, center + turn * Eigen::Vector2d(-0.6, -0.18), yaw_deg + 12.0);
}

void AddCot(BoxWorld& world, const Eigen::Vector3d& center, double yaw_deg) {
  Placement cot(world, center, yaw_deg);
  cot.Box("blue", {-1.0, -0.55, 0.38}, {1.0, 0.55, 0.58});
  cot.Box("white", {0.5, -0.4, 0.58}, {0.9, 0.4, 0.68});
  cot.Box("wood", {0.96, -0.55, 0.2}, {1.02, 0.55, 1.0});
  for (const double x : {-0.95, 0.89}) {
    for (const double y : {-0.52, 0.46}) cot.Box("wood", {x, y, 0}, {x + 0.06, y + 0.06, 0.39});
  }
}

void AddTable(BoxWorld& world, const Eigen::Vector2d& low, const Eigen::Vector2d& high, double height) {
  world.Box("wood", {low.x(), low.y(), height - 0.04}, {high.x(), high.y(), height});
  for (const double x : {low.x() + kLeg, high.x() - 2 * kLeg}) {
    for (const double y : {low.y() + kLeg, high.y() - 2 * kLeg}) {
      world.Box("wood", {x, y, 0}, {x + kLeg, y + kLeg, height - 0.03});
    }
  }
}

void AddChair(BoxWorld& world, const Eigen::Vector2d& center, double yaw_deg) {
  const Eigen::Rotation2Dd turn(yaw_deg * kDegree);
  // Adds a part, given by its center in the chair's own axes (x forward), its size, and its heights.
  const auto part = [&](double x, double y, double size_x, double size_y, double low, double high) {
    const Eigen::Vector2d middle = center + turn * Eigen::Vector2d(x, y);
    world.TurnedBox("red", {middle.x() - 0.5 * size_x, middle.y() - 0.5 * size_y, low},
                    {middle.x() + 0.5 * size_x, middle.y() + 0.5 * size_y, high}, yaw_deg);
  };
  part(0, 0, 0.42, 0.42, 0.43, 0.46);
  for (const double x : {-0.18, 0.18}) {
    for (const double y : {-0.18, 0.18}) part(x, y, 0.04, 0.04, 0.0, 0.44);
  }
  part(-0.195, 0, 0.03, 0.42, 0.46, 0.92);
}

void AddStool(BoxWorld& world, const Eigen::Vector2d& center) {
  const auto part = [&](double size, double low, double high) {
    world.Box("metal", {center.x() - 0.5 * size, center.y() - 0.5 * size, low},
              {center.x() + 0.5 * size, center.y() + 0.5 * size, high});
  };
  part(0.40, 0.0, 0.03);
  part(0.05, 0.02, 0.63);
  part(0.36, 0.62, 0.66);
}

void AddShelf(BoxWorld& world, const Eigen::Vector3d& low, const Eigen::Vector3d& high, int boards) {
  const int along = high.x() - low.x() > high.y() - low.y() ? 0 : 1;
  for (const double start : {low[along], high[along] - kBoard}) {
    Eigen::Vector3d side_low = low;
    Eigen::Vector3d side_high = high;
    side_low[along] = start;
    side_high[along] = start + kBoard;
    world.Box("wood", side_low, side_high);
  }
  for (int i = 0; i < boards; ++i) {
    const double z = low.z() + (high.z() - low.z() - kBoard) * i / (boards - 1);
    Eigen::Vector3d board_low(low.x(), low.y(), z);
    Eigen::Vector3d board_high(high.x(), high.y(), z + kBoard);
    board_low[along] += 0.5 * kBoard;
    board_high[along] -= 0.5 * kBoard;
    world.Box("wood", board_low, board_high);
  }
}

}  // namespace thalweg::simulator
