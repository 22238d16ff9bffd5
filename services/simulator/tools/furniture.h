#pragma once

#include <string_view>
#include <vector>

#include "services/simulator/tools/box_world.h"

namespace thalweg::simulator {

/// Adds the colors that all worlds share: floor, wall, ceiling, wood, dark, white, metal, red, green, blue,
/// yellow.
void AddMaterials(BoxWorld& world);

/// Adds things in axes of their own: x forward from a position on the ground, rotated about the vertical.
class Placement {
 public:
  /// @param at  Origin of the axes; its z lifts them. @param yaw_deg  Counterclockwise seen from above.
  Placement(BoxWorld& world, const Eigen::Vector3d& at, double yaw_deg);

  /// @param yaw_deg, lean_deg  Rotation of this box alone, as in BoxWorld::TurnedBox.
  void Box(std::string_view material, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
           double yaw_deg = 0.0, double lean_deg = 0.0);
  void Column(std::string_view material, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              double radius, int sides = 10);

 private:
  Eigen::Vector3d Placed(const Eigen::Vector3d& p) const;

  BoxWorld& world_;
  Eigen::Vector3d at_;
  double yaw_deg_;
};

/// An opening in a wall.
struct Opening {
  double from = 0.0;   ///< [m] along the wall
  double width = 0.9;  ///< [m]
  double sill = 0.0;   ///< [m] above the wall's foot; 0 = a doorway.
  double head = 2.0;   ///< [m] above the wall's foot.
};
/// Adds a vertical wall between two points, in the material "wall".
/// @param foot, top  Heights [m].
/// @param openings   In order along the wall; they must not overlap.
void AddWall(BoxWorld& world, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double foot, double top,
             const std::vector<Opening>& openings = {}, double thickness = 0.12);

/// Adds posts under a bar, with a second bar halfway up; the ends may be at different heights.
void AddRailing(BoxWorld& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to, int posts);

/// Adds steps without risers, so that a camera can look between and under them.
/// @param foot     Center of the lowest edge.
/// @param yaw_deg  Heading of somebody climbing the stairs.
/// @param rise     [m] to the top of the last step.
/// @param run      [m] over ground.
void AddStairs(BoxWorld& world, const Eigen::Vector3d& foot, double yaw_deg, double width, double rise,
               double run, int steps);

/// Adds a ring of `sides` rods, e.g. for a wheel. @param normal  Unit length.
void AddRing(BoxWorld& world, std::string_view material, const Eigen::Vector3d& center,
             const Eigen::Vector3d& normal, double radius, double thickness, int sides = 10);

/// Adds a desk of 1.4 x 0.7 m with drawers and a screen, and a chair in front of it.
/// @param center   Center of the board.
/// @param yaw_deg  Heading of somebody sitting at it.
void AddDesk(BoxWorld& world, const Eigen::Vector2d& center, double yaw_deg);

/// Adds a bed of 2 x 1.1 m on legs, open underneath.
/// @param center   On the ground.
/// @param yaw_deg  Towards its head.
void AddCot(BoxWorld& world, const Eigen::Vector3d& center, double yaw_deg);

/// Adds a board on four legs.
/// @param low, high  Outline of the board.
/// @param height     [m] of its top above the floor.
void AddTable(BoxWorld& world, const Eigen::Vector2d& low, const Eigen::Vector2d& high, double height);

/// Adds a seat on four legs with a back, all rotated together. @param yaw_deg  Heading of somebody sitting on
/// it.
void AddChair(BoxWorld& world, const Eigen::Vector2d& center, double yaw_deg);

/// Adds a seat on a column with a foot.
void AddStool(BoxWorld& world, const Eigen::Vector2d& center);

/// Adds boards between two side panels, open at the front and back. The boards run along the longer side.
/// @param low, high  Corners of the whole shelf.
/// @param boards     Including the lowest and the highest.
void AddShelf(BoxWorld& world, const Eigen::Vector3d& low, const Eigen::Vector3d& high, int boards);

}  // namespace thalweg::simulator
