#pragma once

#include <string_view>
#include <vector>

#include "services/simulator/tools/box_world.h"

namespace thalweg::simulator {

/// The colours that all worlds share: floor, wall, ceiling, wood, dark, white, metal, red, green, blue,
/// yellow.
void AddMaterials(BoxWorld& world);

/// Things built in axes of their own: x forward from a place on the ground, turned about it.
class Placement {
 public:
  /// @param at  Where its own origin lies; z lifts it. @param yaw_deg  Counter-clockwise from above.
  Placement(BoxWorld& world, const Eigen::Vector3d& at, double yaw_deg);

  /// @param yaw_deg, lean_deg  Of this box alone, as of BoxWorld::TurnedBox.
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
  double sill = 0.0;   ///< [m] above the wall's foot; 0 = a doorway
  double head = 2.0;   ///< [m] above the wall's foot
};
/// An upright wall between two points, in the material "wall".
/// @param foot, top        Heights [m].
/// @param openings         In their order along the wall; they do not overlap.
void AddWall(BoxWorld& world, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double foot, double top,
             const std::vector<Opening>& openings = {}, double thickness = 0.12);

/// Posts under a bar, with a second bar half-way up; the ends may be at different heights.
void AddRailing(BoxWorld& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to, int posts);

/// Steps without risers: one looks between and under them.
/// @param foot     Middle of the lowest edge. @param yaw_deg  The way up.
/// @param rise     [m] to the top of the last step. @param run  [m] over ground.
void AddStairs(BoxWorld& world, const Eigen::Vector3d& foot, double yaw_deg, double width, double rise,
               double run, int steps);

/// A ring of `sides` rods, e.g. a wheel's. @param normal  Unit length.
void AddRing(BoxWorld& world, std::string_view material, const Eigen::Vector3d& center,
             const Eigen::Vector3d& normal, double radius, double thickness, int sides = 10);

/// A writing desk of 1.4 x 0.7 m with drawers and a screen, and a chair before it.
/// @param center  Of the board. @param yaw_deg  Towards where one looks who sits at it.
void AddDesk(BoxWorld& world, const Eigen::Vector2d& center, double yaw_deg);

/// A bed of 2 x 1.1 m on legs: one looks under it.
/// @param center  On the ground. @param yaw_deg  Towards its head.
void AddCot(BoxWorld& world, const Eigen::Vector3d& center, double yaw_deg);

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
