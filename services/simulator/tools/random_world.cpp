#include "services/simulator/tools/random_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/angles.h"
#include "services/simulator/tools/furniture.h"

namespace thalweg::simulator {
namespace {

using Room = RandomWorld::Room;

constexpr double kHalfWall = 0.06;  // [m]
constexpr double kLeastRoom = 2.1;  // [m]
constexpr double kDoorLeft = 0.7;   // [m] kept free about a doorway's center
constexpr double kStartLeft = 0.7;  // [m] kept free about the start
/// [m] Gap between pieces, and beside free-standing ones, so that a robot gets past and nothing is closed
/// off.
constexpr double kBetween = 0.5;
constexpr double kWallOverlap = 0.08;  // [m] of walls where they meet, because none is quite straight
constexpr int kTries = 8;

/// Random draws that are the same with every standard library, unlike std::uniform_real_distribution and its
/// kin. Draw once per statement: compilers choose in which order they evaluate the arguments of a call.
class Chance {
 public:
  explicit Chance(std::uint32_t seed) : random_(seed) {}
  double Between(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }
  Eigen::Vector2d Within(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    const double x = Between(low.x(), high.x());
    const double y = Between(low.y(), high.y());
    return {x, y};
  }
  std::size_t Below(std::size_t count) { return random_() % count; }

 private:
  std::mt19937 random_;
};

/// A position at a wall of a room.
struct Niche {
  Eigen::Vector2d at;
  double yaw_deg;  ///< Heading into the wall.
  Eigen::Vector2d Before(double distance) const {
    const double yaw = yaw_deg * kDegree;
    return at - distance * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
  }
};

class Builder {
 public:
  explicit Builder(const RandomWorldOptions& options)
      : options_(options),
        chance_(options.seed),
        world_("random_" + std::to_string(options.seed),
               {chance_.Between(0.01, 0.06), chance_.Between(0.01, 0.06), chance_.Between(0.01, 0.06)}) {}

  RandomWorld Build() {
    const std::uint32_t layout = options_.seed % 4;
    size_ = {chance_.Between(6.0, 10.0) * options_.scale, chance_.Between(8.0, 14.0) * options_.scale,
             layout == 3 ? chance_.Between(2.5, 4.0) : chance_.Between(2.0, 2.9)};
    AddMaterials(world_);
    world_.Shell(size_, "floor", "wall", "ceiling");
    const Room whole{{0.0, 0.0}, size_.head<2>()};
    if (layout == 0) {
      Split(whole);
    } else if (layout == 1) {
      AddCorridor(whole);
    } else if (layout == 2) {
      AddStalls(whole);
    } else {
      spaces_.push_back({whole});
    }
    const Room& first = spaces_.front().room;
    const Eigen::Vector2d start = 0.5 * (first.low + first.high);
    LeaveFree(start, kStartLeft);
    if (layout == 3) AddPillars(whole);
    std::vector<Room> rooms;
    for (const Space& space : spaces_) {
      Furnish(space);
      rooms.push_back(space.room);
    }
    return {.boxes = std::move(world_),
            .size = size_,
            .start = On(start, 0.5 * std::min(size_.z(), 2.4)),
            .rooms = std::move(rooms)};
  }

 private:
  struct Disc {
    Eigen::Vector2d middle;
    double radius;
  };
  enum Side : std::uint8_t { kHighX, kHighY, kLowX, kLowY, kNone };
  struct Space {
    Room room;
    Side open_side = kNone;
  };

  const char* Color() {
    constexpr std::array kColors{"red", "green", "blue", "yellow", "wood", "white"};
    return kColors[chance_.Below(kColors.size())];
  }
  double DoorHead() const { return std::min(2.0, size_.z() - 0.1); }
  Opening Door(double from) {
    return {.from = from, .width = chance_.Between(0.85, 1.1), .head = DoorHead()};
  }

  /// Adds a wall with a doorway across a room: for `axis` 0 at x = `at` from low to high y, for 1 at y =
  /// `at`.
  void AddWallWithDoor(const Room& room, int axis, double at, double door_from) {
    const int along = 1 - axis;
    const double skew = chance_.Between(-0.05, 0.05);
    Eigen::Vector2d from = room.low;
    Eigen::Vector2d to = room.high;
    from[axis] = at + skew;
    to[axis] = at - skew;
    from[along] -= kWallOverlap;
    to[along] += kWallOverlap;
    const Opening door = Door(door_from);
    Opening shifted = door;
    shifted.from += kWallOverlap;
    AddWall(world_, from, to, 0, size_.z(), {shifted});
    Eigen::Vector2d middle;
    middle[axis] = at;
    middle[along] = room.low[along] + door.from + 0.5 * door.width;
    LeaveFree(middle, kDoorLeft);
  }

  void Split(const Room& room) {
    const Eigen::Vector2d size = room.high - room.low;
    const int axis = size.x() > size.y() ? 0 : 1;
    const bool large_enough = size[axis] >= 2.0 * kLeastRoom + 0.3;
    if (!large_enough || (size.prod() < 14.0 && chance_.Below(3) == 0)) {
      spaces_.push_back({room});
      return;
    }
    for (int n = 0; n < kTries; ++n) {
      const double at = chance_.Between(room.low[axis] + kLeastRoom, room.high[axis] - kLeastRoom);
      const bool before_door = std::any_of(taken_.begin(), taken_.end(), [&](const Disc& door) {
        const bool beside = door.middle.x() > room.low.x() - 0.3 && door.middle.x() < room.high.x() + 0.3 &&
                            door.middle.y() > room.low.y() - 0.3 && door.middle.y() < room.high.y() + 0.3;
        return beside && std::abs(door.middle[axis] - at) < kDoorLeft + 0.1;
      });
      if (before_door) continue;
      AddWallWithDoor(room, axis, at, chance_.Between(0.3, size[1 - axis] - 1.4));
      Room lower = room;
      Room upper = room;
      lower.high[axis] = at - kHalfWall;
      upper.low[axis] = at + kHalfWall;
      Split(lower);
      Split(upper);
      return;
    }
    spaces_.push_back({room});
  }

  /// Adds a row of rooms between the outer wall and a parallel wall at `door_x`, with a door each.
  void AddRow(double outer_x, double door_x, double length) {
    const double low_x = std::min(outer_x, door_x);
    const double high_x = std::max(outer_x, door_x);
    std::vector<Opening> doors;
    for (double y = 0.0; y < length;) {
      double end = y + chance_.Between(kLeastRoom, 4.5);
      if (length - end < kLeastRoom) end = length;
      spaces_.push_back({{{low_x + kHalfWall, y + kHalfWall}, {high_x - kHalfWall, end - kHalfWall}}});
      doors.push_back(Door(y + chance_.Between(0.4, end - y - 1.5)));
      LeaveFree({door_x, doors.back().from + 0.5 * doors.back().width}, kDoorLeft);
      if (end < length)
        AddWall(world_, {low_x, end}, {high_x, end + chance_.Between(-0.05, 0.05)}, 0, size_.z());
      y = end;
    }
    AddWall(world_, {door_x, 0}, {door_x + chance_.Between(-0.05, 0.05), length}, 0, size_.z(), doors);
  }

  void AddCorridor(const Room& whole) {
    const Eigen::Vector2d size = whole.high;
    const double width = chance_.Between(1.3, 1.7);
    const double left = chance_.Between(kLeastRoom, size.x() - width - kLeastRoom);
    AddRow(0.0, left, size.y());
    AddRow(size.x(), left + width, size.y());
  }

  void AddStalls(const Room& whole) {
    const Eigen::Vector2d size = whole.high;
    const double aisle = chance_.Between(1.4, 1.8);
    const double left = chance_.Between(0.3, 0.7) * (size.x() - aisle);
    for (double y = 0.0; y < size.y();) {
      double end = y + chance_.Between(1.6, 2.6);
      if (size.y() - end < 1.6) end = size.y();
      for (const auto& [from, to] : {std::pair{0.0, left}, {left + aisle, size.x()}}) {
        spaces_.push_back({.room = {{from, y + kHalfWall}, {to, end - kHalfWall}},
                           .open_side = from == 0.0 ? kHighX : kLowX});
        if (end < size.y())
          AddWall(world_, {from, end}, {to, end + chance_.Between(-0.05, 0.05)}, 0, size_.z());
      }
      y = end;
    }
  }

  void AddPillars(const Room& room) {
    for (std::size_t n = 4 + chance_.Below(3); n > 0; --n) {
      const double radius = chance_.Between(0.15, 0.25);
      if (const auto place = Place(room, radius)) {
        world_.Column("white", On(*place, 0.0), On(*place, size_.z()), radius, 12);
      }
    }
    for (int n = 0; n < 3; ++n) {
      const double half = chance_.Between(0.7, 1.4);
      const auto place = Place(room, half + 0.01);
      if (!place) continue;
      const double top = chance_.Between(1.5, size_.z() - 0.2);
      const Eigen::Vector2d reach(0.04, half);
      world_.TurnedBox("blue", On(*place - reach, 0.0), On(*place + reach, top), chance_.Between(0.0, 180.0));
    }
  }

  static Eigen::Vector3d On(const Eigen::Vector2d& p, double z) { return {p.x(), p.y(), z}; }

  void LeaveFree(const Eigen::Vector2d& middle, double radius) {
    taken_.push_back({middle, radius - kBetween});
  }

  bool Take(const Eigen::Vector2d& middle, double radius) {
    const bool taken = std::any_of(taken_.begin(), taken_.end(), [&](const Disc& disc) {
      return (disc.middle - middle).norm() < disc.radius + radius + kBetween;
    });
    if (!taken) taken_.push_back({middle, radius});
    return !taken;
  }

  /// Finds a position in a room for something that fits into a circle; empty after kTries failures.
  std::optional<Eigen::Vector2d> Place(const Room& room, double radius) {
    const Eigen::Vector2d low = room.low.array() + (radius + kBetween);
    const Eigen::Vector2d high = room.high.array() - (radius + kBetween);
    if ((low.array() >= high.array()).any()) return std::nullopt;
    for (int n = 0; n < kTries; ++n) {
      const Eigen::Vector2d middle = chance_.Within(low, high);
      if (Take(middle, radius)) return middle;
    }
    return std::nullopt;
  }

  /// Finds a position at a wall for something of this width and depth.
  std::optional<Niche> PlaceAtWall(const Space& space, double width, double depth) {
    const Room& room = space.room;
    for (int n = 0; n < kTries; ++n) {
      const std::size_t side = chance_.Below(4);
      const int axis = side % 2 == 0 ? 0 : 1;
      const double low = room.low[1 - axis] + 0.5 * width + 0.1;
      const double high = room.high[1 - axis] - 0.5 * width - 0.1;
      if (side == space.open_side || low >= high || room.high[axis] - room.low[axis] < depth + kBetween)
        continue;
      Niche niche{.at = {}, .yaw_deg = std::array{0.0, 90.0, 180.0, -90.0}[side]};
      niche.at[axis] = side == kHighX || side == kHighY ? room.high[axis] : room.low[axis];
      niche.at[1 - axis] = chance_.Between(low, high);
      if (Take(niche.Before(0.5 * depth), 0.5 * std::max(width, depth))) return niche;
    }
    return std::nullopt;
  }

  void Furnish(const Space& space) {
    const double area = (space.room.high - space.room.low).prod();
    const auto pieces = static_cast<int>(std::lround(options_.clutter * area));
    for (int n = 0; n < pieces; ++n) AddPiece(space);
  }

  void AddPiece(const Space& space) {
    constexpr std::array kPieces{&Builder::AddDeskTo,   &Builder::AddCotTo,    &Builder::AddShelfTo,
                                 &Builder::AddTableTo,  &Builder::AddStoolTo,  &Builder::AddBoxTo,
                                 &Builder::AddScreenTo, &Builder::AddColumnTo, &Builder::AddCupboardTo};
    (this->*kPieces[chance_.Below(kPieces.size())])(space);
  }

  void AddDeskTo(const Space& space) {
    if (const auto niche = PlaceAtWall(space, 1.4, 1.4))
      AddDesk(world_, niche->Before(0.5), niche->yaw_deg + chance_.Between(-5.0, 5.0));
  }
  void AddCotTo(const Space& space) {
    if (const auto niche = PlaceAtWall(space, 1.2, 2.2))
      AddCot(world_, On(niche->Before(1.2), 0.0), niche->yaw_deg + chance_.Between(-4.0, 4.0));
  }
  void AddShelfTo(const Space& space) {
    const double half = 0.5 * chance_.Between(1.0, 2.0);
    const auto niche = PlaceAtWall(space, 2.0 * half, 0.4);
    if (!niche) return;
    const Eigen::Vector2d middle = niche->Before(0.22);
    const bool along_y = std::abs(niche->at.x() - middle.x()) > std::abs(niche->at.y() - middle.y());
    const Eigen::Vector2d reach = along_y ? Eigen::Vector2d(0.18, half) : Eigen::Vector2d(half, 0.18);
    const double top = chance_.Between(1.1, size_.z() - 0.2);
    const int boards = 3 + static_cast<int>(chance_.Below(3));
    AddShelf(world_, On(middle - reach, 0.05), On(middle + reach, top), boards);
  }
  void AddTableTo(const Space& space) {
    const Eigen::Vector2d reach = chance_.Within({0.4, 0.35}, {0.7, 0.5});
    const auto place = Place(space.room, 1.05);
    if (!place) return;
    AddTable(world_, *place - reach, *place + reach, chance_.Between(0.45, 0.8));
    AddChair(world_, *place - Eigen::Vector2d(0.1, reach.y() + 0.25), chance_.Between(60.0, 120.0));
    AddChair(world_, *place + Eigen::Vector2d(0.15, reach.y() + 0.25), chance_.Between(-120.0, -60.0));
  }
  void AddStoolTo(const Space& space) {
    if (const auto place = Place(space.room, 0.25)) AddStool(world_, *place);
  }
  void AddBoxTo(const Space& space) {
    const double half = chance_.Between(0.2, 0.35);
    const auto place = Place(space.room, 1.5 * half);
    if (!place) return;
    const char* const color = Color();
    const double top = chance_.Between(0.4, 1.2);
    const Eigen::Vector2d reach(half, half);
    world_.TurnedBox(color, On(*place - reach, 0.0), On(*place + reach, top), chance_.Between(0.0, 90.0));
  }
  void AddScreenTo(const Space& space) {
    const auto place = Place(space.room, 0.71);
    if (!place) return;
    const char* const color = Color();
    const double top = chance_.Between(1.2, size_.z() - 0.1);
    const Eigen::Vector2d reach(0.03, 0.7);
    world_.TurnedBox(color, On(*place - reach, 0.05), On(*place + reach, top), chance_.Between(0.0, 180.0));
  }
  void AddColumnTo(const Space& space) {
    const double radius = chance_.Between(0.12, 0.3);
    const auto place = Place(space.room, radius);
    if (!place) return;
    const char* const color = Color();
    world_.Column(color, On(*place, 0.0), On(*place, chance_.Between(0.6, size_.z())), radius);
  }
  void AddCupboardTo(const Space& space) {
    const auto place = Place(space.room, 0.5);
    if (!place) return;
    const char* const color = Color();
    const double foot = chance_.Between(0.4, 0.9);
    const double top = foot + chance_.Between(0.3, 0.8);
    const Eigen::Vector2d reach(0.4, 0.3);
    world_.Box(color, On(*place - reach, foot), On(*place + reach, top));
    world_.Column("dark", On(*place, 0.0), On(*place, foot + 0.01), 0.06, 8);
  }

  RandomWorldOptions options_;
  Chance chance_;
  BoxWorld world_;
  Eigen::Vector3d size_ = Eigen::Vector3d::Zero();
  std::vector<Space> spaces_;
  std::vector<Disc> taken_;  ///< Doorways, the start, and placed furniture.
};

std::string Text(const Eigen::Vector3d& p) {
  std::ostringstream text;
  text << "{ x: " << p.x() << " y: " << p.y() << " z: " << p.z() << " }";
  return text.str();
}

}  // namespace

RandomWorld MakeRandomWorld(const RandomWorldOptions& options) {
  if (!(options.clutter >= 0.0 && options.clutter <= 2.0))
    throw std::invalid_argument("clutter must be 0 to 2 pieces per square meter");
  if (!(options.scale >= 1.0 && options.scale <= 5.0)) throw std::invalid_argument("scale must be 1 to 5");
  return Builder(options).Build();
}

std::string ScenarioText(const RandomWorld& world) {
  const Eigen::Vector3d end = (10.0 * (world.boxes.origin() + world.size)).array().ceil() / 10.0;
  std::ostringstream text;
  text << "title: \"" << world.boxes.name() << "\"\n\n"
       << "world {\n"
       << "  file: \"" << world.boxes.name() << ".obj\"\n"
       << "  bounds_min_m " << Text(Eigen::Vector3d::Zero()) << '\n'
       << "  bounds_max_m " << Text(end) << "\n}\n\n"
       << "simulator {\n"
       << "  time_scale: 5\n"
       << "  start_position_m " << Text(world.boxes.origin() + world.start) << '\n'
       << "  start_yaw_deg: 0\n}\n\n"
       << "explorer {\n  min_cluster_area_m2: 0.1\n}\n";
  return text.str();
}

}  // namespace thalweg::simulator
