#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/simulator/tools/box_world.h"
#include "services/simulator/tools/furnisher.h"

namespace thalweg::simulator {

/// A randomly drawn world, to test strategies in worlds that nobody designed for them.
struct RandomWorld {
  // All coordinates are relative to the corner of the boxes' room, which lies at boxes.origin().
  BoxWorld boxes;
  Eigen::Vector3d size;          ///< [m]
  Eigen::Vector3d start;         ///< [m] A robot fits there.
  std::vector<FloorArea> rooms;  ///< The furnished rooms; corridors and aisles are not among them.
};

enum class Layout : std::uint8_t {
  // Floors of 6 to 10 by 8 to 14 m:
  kRooms,     ///< Rooms that open into each other.
  kCorridor,  ///< Rooms on both sides of a corridor.
  kStalls,    ///< Dead ends on both sides of an aisle.
  kHall,      ///< One hall with pillars and screens.
  // Floors of the size and kind that are common in the literature on exploration by multirotors:
  kOffices,  ///< 30 x 30 x 2 m: two corridors that cross, and blocks of rooms with several doors each.
  kMaze,     ///< 35 x 35 x 2 m: rings of eight sides, with walls across at their corners.
  kStoreys,  ///< 20 x 20 x 4 m: two storeys of rooms along a hall, joined by two holes in its ceiling.
};

using LayoutName = std::pair<std::string, Layout>;
/// All layouts, in order.
const std::vector<LayoutName>& LayoutNames();

struct RandomWorldOptions {
  std::uint32_t seed = 1;
  std::optional<Layout> layout = {};  ///< Absent: one of the first four, by the seed modulo 4.
  double clutter = 0.25;              ///< [1/m^2] Pieces of furniture, as far as there is space for them.
  double scale = 1.0;                 ///< Factor on the length and width of the floor.
};

/// Draws a world named random_SEED, or LAYOUT_SEED if a layout is given. A robot 0.4 m wide gets past every
/// piece of furniture. The same options give the same world with every compiler, up to rounding. Throws
/// std::invalid_argument unless 0 <= clutter <= 2 and 1 <= scale <= 5.
RandomWorld MakeRandomWorld(const RandomWorldOptions& options);

/// A scenario that refers to the world's OBJ file in the same folder.
std::string ScenarioText(const RandomWorld& world);

}  // namespace thalweg::simulator
