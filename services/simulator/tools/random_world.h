#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/simulator/tools/box_world.h"

namespace thalweg::simulator {

/// A world drawn by chance: to try a strategy on what nobody made it for.
struct RandomWorld {
  struct Room {
    Eigen::Vector2d low = Eigen::Vector2d::Zero();   ///< [m]
    Eigen::Vector2d high = Eigen::Vector2d::Zero();  ///< [m]
  };

  // All coordinates are those of the boxes: from the room's corner, that lies at boxes.origin().
  BoxWorld boxes;
  Eigen::Vector3d size;     ///< [m]
  Eigen::Vector3d start;    ///< [m] With room for a robot.
  std::vector<Room> rooms;  ///< Furnished; corridors and aisles are none.
};

struct RandomWorldOptions {
  /// Also the layout, by its remainder of 4: 0 rooms that open into each other, 1 rooms on both sides of a
  /// corridor, 2 dead ends on both sides of an aisle, 3 one hall with pillars and screens.
  std::uint32_t seed = 1;
  double clutter = 0.25;  ///< [1/m^2] Pieces of furniture, as far as there is room for them.
  double scale = 1.0;     ///< Of 6 to 10 by 8 to 14 m of floor.
};

/// A robot 0.4 m wide gets past every piece. The same options give the same world, whatever the compiler, but
/// for rounding. Named random_SEED.
/// Throws std::invalid_argument unless 0 <= clutter <= 2 and 1 <= scale <= 5.
RandomWorld MakeRandomWorld(const RandomWorldOptions& options);

/// A scenario with the world's OBJ beside it.
std::string ScenarioText(const RandomWorld& world);

}  // namespace thalweg::simulator
