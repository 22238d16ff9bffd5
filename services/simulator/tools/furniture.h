#pragma once

#include "services/simulator/tools/box_world.h"

namespace thalweg::simulator {

/// The colours that all worlds share: floor, wall, ceiling, wood, dark, white, metal, red, green, blue,
/// yellow.
void AddMaterials(BoxWorld& world);

/// A board on four legs.
/// @param low, high  The board's outline, z from the floor to its top.
void AddTable(BoxWorld& world, const Eigen::Vector2d& low, const Eigen::Vector2d& high, double height);

/// A seat on four legs with a back, all turned together. @param yaw_deg  Towards where one looks on it.
void AddChair(BoxWorld& world, const Eigen::Vector2d& center, double yaw_deg);

/// A seat on a column on a foot.
void AddStool(BoxWorld& world, const Eigen::Vector2d& center);

/// Boards between two sides, open to the front and the back.
/// @param low, high  The whole shelf. @param boards  Including the lowest and the highest.
/// The boards run along the longer side.
void AddShelf(BoxWorld& world, const Eigen::Vector3d& low, const Eigen::Vector3d& high, int boards);

}  // namespace thalweg::simulator
