#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/simulator/tools/box_world.h"
#include "services/simulator/tools/chance.h"

namespace thalweg::simulator {

/// A rectangle of the floor [m], in the world's own coordinates.
struct FloorArea {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
};

/// The point above one of the floor.
inline Eigen::Vector3d On(const Eigen::Vector2d& p, double z) {
  return {p.x(), p.y(), z};
}

/// A part of the floor that is furnished by itself.
struct Space {
  enum Side : std::uint8_t { kHighX, kHighY, kLowX, kLowY, kNone };
  FloorArea area;
  Side open_side = kNone;  ///< Without a wall.
};

/// Draws furniture onto one floor, so that a robot 0.4 m wide gets past every piece.
class Furnisher {
 public:
  /// The world and the chance must outlive the furnisher. @param height  [m] of the ceiling above the floor.
  Furnisher(BoxWorld& world, Chance& chance, double height);

  /// Keeps a disc [m] free of furniture.
  void LeaveFree(const Eigen::Vector2d& middle, double radius);
  /// Whether the middle of what was left free or taken lies within `beside` [m] of an area, and within
  /// `within` [m] of `at` along an axis.
  bool IsTaken(const FloorArea& area, double beside, int axis, double at, double within) const;
  /// Adds pieces as far as there is space for them.
  void Furnish(const Space& space, int pieces);
  /// Finds a position in an area for something that fits into a circle, and takes it; empty after some
  /// failures.
  std::optional<Eigen::Vector2d> Place(const FloorArea& area, double radius);

 private:
  struct Disc {
    Eigen::Vector2d middle;
    double radius;
  };
  /// A position at a wall of a room.
  struct Niche {
    Eigen::Vector2d at;
    double yaw_deg;  ///< Heading into the wall.
    Eigen::Vector2d Before(double distance) const;
  };

  const char* Color();
  bool Take(const Eigen::Vector2d& middle, double radius);
  std::optional<Niche> PlaceAtWall(const Space& space, double width, double depth);
  void AddPiece(const Space& space);
  void AddDeskTo(const Space& space);
  void AddCotTo(const Space& space);
  void AddShelfTo(const Space& space);
  void AddTableTo(const Space& space);
  void AddStoolTo(const Space& space);
  void AddBoxTo(const Space& space);
  void AddScreenTo(const Space& space);
  void AddColumnTo(const Space& space);
  void AddCupboardTo(const Space& space);

  BoxWorld& world_;
  Chance& chance_;
  double height_;
  std::vector<Disc> taken_;  ///< Doorways, the start, and placed furniture.
};

}  // namespace thalweg::simulator
