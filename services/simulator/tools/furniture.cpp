#include "services/simulator/tools/furniture.h"

#include <Eigen/Geometry>
#include <array>
#include <numbers>

namespace thalweg::simulator {
namespace {

constexpr double kBoard = 0.025;  // [m] thickness of boards
constexpr double kLeg = 0.05;     // [m] thickness of legs

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

void AddTable(BoxWorld& world, const Eigen::Vector2d& low, const Eigen::Vector2d& high, double height) {
  world.Box("wood", {low.x(), low.y(), height - 0.04}, {high.x(), high.y(), height});
  for (const double x : {low.x() + kLeg, high.x() - 2 * kLeg}) {
    for (const double y : {low.y() + kLeg, high.y() - 2 * kLeg}) {
      world.Box("wood", {x, y, 0}, {x + kLeg, y + kLeg, height - 0.03});
    }
  }
}

void AddChair(BoxWorld& world, const Eigen::Vector2d& center, double yaw_deg) {
  const Eigen::Rotation2Dd turn(yaw_deg * std::numbers::pi / 180.0);
  // A part by its middle in the chair's own axes (x forward), its size, and its heights.
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
