#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/simulator/tools/box_world.h"

namespace thalweg::simulator {

/// A randomly drawn world, to test strategies in worlds that nobody designed for them.
struct RandomWorld {
  struct Room {
    Eigen::Vector2d low = Eigen::Vector2d::Zero();   ///< [m]
    Eigen::Vector2d high = Eigen::Vector2d::Zero();  ///< [m]
  };

  // All coordinates are relative to the corner of the boxes' room, which lies at boxes.origin().
  BoxWorld boxes;
  Eigen::Vector3d size;     ///< [m]
  Eigen::Vector3d start;    ///< [m] A robot fits there.
  std::vector<Room> rooms;  ///< The furnished rooms; corridors and aisles are not among them.
};

struct RandomWorldOptions {
  /// Determines the layout, too, by its remainder modulo 4: 0 = rooms that open into each other, 1 = rooms on
  /// both sides of a corridor, 2 = dead ends on both sides of an aisle, 3 = one hall with pillars and
  /// screens.
  std::uint32_t seed = 1;
  double clutter = 0.25;  ///< [1/m^2] Pieces of furniture, as far as there is space for them.
  double scale = 1.0;     ///< 1 = a floor of 6 to 10 by 8 to 14 m.
};

/// Draws a world named random_SEED. A robot 0.4 m wide gets past every piece of furniture. The same options
/// give the same world with every compiler, up to rounding.
/// Throws std::invalid_argument unless 0 <= clutter <= 2 and 1 <= scale <= 5.
RandomWorld MakeRandomWorld(const RandomWorldOptions& options);

/// A scenario that refers to the world's OBJ file in the same folder.
std::string ScenarioText(const RandomWorld& world);

}  // namespace thalweg::simulator
