#include "services/simulator/tools/random_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "services/simulator/tools/furniture.h"

namespace thalweg::simulator {
namespace {

using Room = RandomWorld::Room;

constexpr double kHalfWall = 0.06;  // [m]
constexpr double kLeastRoom = 2.2;  // [m]
constexpr double kDoorLeft = 0.7;   // [m] about a doorway's middle, free of furniture and walls' ends
constexpr double kStartLeft = 0.7;  // [m] about the start
constexpr double kBetween = 0.1;    // [m] of pieces
constexpr int kTries = 8;

/// Not the distributions of the standard library, which are not the same in every library.
class Chance {
 public:
  explicit Chance(std::uint32_t seed) : random_(seed) {}
  double Between(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }
  std::size_t Below(std::size_t count) { return random_() % count; }
  bool Coin() { return Below(2) == 0; }

 private:
  std::mt19937 random_;
};

/// A place on a wall of a room, seen from within.
struct Niche {
  Eigen::Vector2d at;
  double yaw_deg;  ///< Into the wall.
  Eigen::Vector2d Before(double distance) const {
    const double yaw = yaw_deg * std::numbers::pi / 180.0;
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
      rooms_.push_back(whole);
    }
    const Room& first = rooms_.front();
    const Eigen::Vector2d start = 0.5 * (first.low + first.high);
    left_free_.push_back({start, kStartLeft});
    if (layout == 3) AddPillars(whole);
    for (const Room& room : rooms_) Furnish(room);
    return {.boxes = std::move(world_),
            .size = size_,
            .start = On(start, 0.5 * std::min(size_.z(), 2.4)),
            .rooms = std::move(rooms_)};
  }

 private:
  struct Disc {
    Eigen::Vector2d middle;
    double radius;
  };

  const char* Color() {
    constexpr std::array kColors{"red", "green", "blue", "yellow", "wood", "white"};
    return kColors[chance_.Below(kColors.size())];
  }
  double DoorHead() const { return std::min(2.0, size_.z() - 0.1); }
  Opening Door(double from) {
    return {.from = from, .width = chance_.Between(0.85, 1.1), .head = DoorHead()};
  }

  /// A wall across a room, `axis` 0 from low to high y at an x, 1 the other way round, with a doorway in it.
  void AddWallWithDoor(const Room& room, int axis, double at, double door_from) {
    const int along = 1 - axis;
    const double skew = chance_.Between(-0.1, 0.1);
    Eigen::Vector2d from = room.low;
    Eigen::Vector2d to = room.high;
    from[axis] = at + skew;
    to[axis] = at - skew;
    const Opening door = Door(door_from);
    AddWall(world_, from, to, 0, size_.z(), {door});
    Eigen::Vector2d middle;
    middle[axis] = at;
    middle[along] = room.low[along] + door.from + 0.5 * door.width;
    left_free_.push_back({middle, kDoorLeft});
  }

  void Split(const Room& room) {
    const Eigen::Vector2d size = room.high - room.low;
    const int axis = size.x() > size.y() ? 0 : 1;
    const bool large_enough = size[axis] >= 2.0 * kLeastRoom + 0.3;
    if (!large_enough || (size.prod() < 14.0 && chance_.Below(3) == 0)) {
      rooms_.push_back(room);
      return;
    }
    for (int n = 0; n < kTries; ++n) {
      const double at = chance_.Between(room.low[axis] + kLeastRoom, room.high[axis] - kLeastRoom);
      const bool before_door = std::any_of(left_free_.begin(), left_free_.end(), [&](const Disc& door) {
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
    rooms_.push_back(room);
  }

  /// Rooms between the outer wall and an upright one at `door_x`, with a door each.
  void AddRow(double outer_x, double door_x, double length) {
    const double low_x = std::min(outer_x, door_x);
    const double high_x = std::max(outer_x, door_x);
    std::vector<Opening> doors;
    for (double y = 0.0; y < length;) {
      double end = y + chance_.Between(kLeastRoom, 4.5);
      if (length - end < kLeastRoom) end = length;
      rooms_.push_back({{low_x + kHalfWall, y + kHalfWall}, {high_x - kHalfWall, end - kHalfWall}});
      doors.push_back(Door(y + chance_.Between(0.4, end - y - 1.5)));
      left_free_.push_back({{door_x, doors.back().from + 0.5 * doors.back().width}, kDoorLeft});
      if (end < length)
        AddWall(world_, {low_x, end}, {high_x, end + chance_.Between(-0.1, 0.1)}, 0, size_.z());
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
        rooms_.push_back({{from, y + kHalfWall}, {to, end - kHalfWall}});
        if (end < size.y())
          AddWall(world_, {from, end}, {to, end + chance_.Between(-0.1, 0.1)}, 0, size_.z());
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
      if (const auto place = Place(room, half)) {
        world_.TurnedBox("blue", On(*place - Eigen::Vector2d(0.04, half), 0.0),
                         On(*place + Eigen::Vector2d(0.04, half), chance_.Between(1.5, size_.z() - 0.2)),
                         chance_.Between(0.0, 180.0));
      }
    }
  }

  static Eigen::Vector3d On(const Eigen::Vector2d& p, double z) { return {p.x(), p.y(), z}; }

  bool Take(const Eigen::Vector2d& middle, double radius) {
    const bool taken = std::any_of(left_free_.begin(), left_free_.end(), [&](const Disc& disc) {
      return (disc.middle - middle).norm() < disc.radius + radius + kBetween;
    });
    if (!taken) left_free_.push_back({middle, radius});
    return !taken;
  }

  /// A place in a room for something that fits into a circle.
  std::optional<Eigen::Vector2d> Place(const Room& room, double radius) {
    const Eigen::Vector2d low = room.low.array() + radius;
    const Eigen::Vector2d high = room.high.array() - radius;
    if ((low.array() >= high.array()).any()) return std::nullopt;
    for (int n = 0; n < kTries; ++n) {
      const Eigen::Vector2d middle(chance_.Between(low.x(), high.x()), chance_.Between(low.y(), high.y()));
      if (Take(middle, radius)) return middle;
    }
    return std::nullopt;
  }

  /// A place at a wall for something so wide and deep.
  std::optional<Niche> PlaceAtWall(const Room& room, double width, double depth) {
    for (int n = 0; n < kTries; ++n) {
      const std::size_t side = chance_.Below(4);
      const int axis = side % 2 == 0 ? 0 : 1;
      const double low = room.low[1 - axis] + 0.5 * width + 0.1;
      const double high = room.high[1 - axis] - 0.5 * width - 0.1;
      if (low >= high || room.high[axis] - room.low[axis] < depth + 0.8) continue;
      Niche niche{.at = {}, .yaw_deg = std::array{0.0, 90.0, 180.0, -90.0}[side]};
      niche.at[axis] = side < 2 ? room.high[axis] : room.low[axis];
      niche.at[1 - axis] = chance_.Between(low, high);
      if (Take(niche.Before(0.5 * depth), 0.45 * std::max(width, depth))) return niche;
    }
    return std::nullopt;
  }

  void Furnish(const Room& room) {
    const double area = (room.high - room.low).prod();
    const auto pieces = static_cast<int>(std::lround(options_.clutter * area));
    for (int n = 0; n < pieces; ++n) AddPiece(room);
  }

  void AddPiece(const Room& room) {
    constexpr std::array kPieces{&Builder::AddDeskTo,   &Builder::AddCotTo,    &Builder::AddShelfTo,
                                 &Builder::AddTableTo,  &Builder::AddStoolTo,  &Builder::AddBoxTo,
                                 &Builder::AddScreenTo, &Builder::AddColumnTo, &Builder::AddCupboardTo};
    (this->*kPieces[chance_.Below(kPieces.size())])(room);
  }

  void AddDeskTo(const Room& room) {
    if (const auto niche = PlaceAtWall(room, 1.4, 1.4))
      AddDesk(world_, niche->Before(0.5), niche->yaw_deg + chance_.Between(-5.0, 5.0));
  }
  void AddCotTo(const Room& room) {
    if (const auto niche = PlaceAtWall(room, 1.2, 2.2))
      AddCot(world_, On(niche->Before(1.2), 0.0), niche->yaw_deg + chance_.Between(-4.0, 4.0));
  }
  void AddShelfTo(const Room& room) {
    const double half = 0.5 * chance_.Between(1.0, 2.0);
    const auto niche = PlaceAtWall(room, 2.0 * half, 0.4);
    if (!niche) return;
    const Eigen::Vector2d middle = niche->Before(0.22);
    const bool along_y = std::abs(niche->at.x() - middle.x()) > std::abs(niche->at.y() - middle.y());
    const Eigen::Vector2d reach = along_y ? Eigen::Vector2d(0.18, half) : Eigen::Vector2d(half, 0.18);
    const double top = chance_.Between(1.1, size_.z() - 0.2);
    AddShelf(world_, On(middle - reach, 0.05), On(middle + reach, top),
             3 + static_cast<int>(chance_.Below(3)));
  }
  void AddTableTo(const Room& room) {
    const Eigen::Vector2d reach(chance_.Between(0.4, 0.7), chance_.Between(0.35, 0.5));
    const auto place = Place(room, 1.0);
    if (!place) return;
    AddTable(world_, *place - reach, *place + reach, chance_.Between(0.45, 0.8));
    AddChair(world_, *place - Eigen::Vector2d(0.1, reach.y() + 0.25), chance_.Between(60.0, 120.0));
    AddChair(world_, *place + Eigen::Vector2d(0.15, reach.y() + 0.25), chance_.Between(-120.0, -60.0));
  }
  void AddStoolTo(const Room& room) {
    if (const auto place = Place(room, 0.25)) AddStool(world_, *place);
  }
  void AddBoxTo(const Room& room) {
    const double half = chance_.Between(0.2, 0.35);
    if (const auto place = Place(room, 1.4 * half)) {
      const Eigen::Vector2d reach(half, half);
      world_.TurnedBox(Color(), On(*place - reach, 0.0), On(*place + reach, chance_.Between(0.4, 1.2)),
                       chance_.Between(0.0, 90.0));
    }
  }
  void AddScreenTo(const Room& room) {
    if (const auto place = Place(room, 0.75)) {
      const Eigen::Vector2d reach(0.03, 0.7);
      world_.TurnedBox(Color(), On(*place - reach, 0.05),
                       On(*place + reach, chance_.Between(1.2, size_.z() - 0.1)),
                       chance_.Between(0.0, 180.0));
    }
  }
  void AddColumnTo(const Room& room) {
    const double radius = chance_.Between(0.12, 0.3);
    if (const auto place = Place(room, radius))
      world_.Column(Color(), On(*place, 0.0), On(*place, chance_.Between(0.6, size_.z())), radius);
  }
  void AddCupboardTo(const Room& room) {
    if (const auto place = Place(room, 0.5)) {
      const double foot = chance_.Between(0.4, 0.9);
      const Eigen::Vector2d reach(0.4, 0.3);
      world_.Box(Color(), On(*place - reach, foot), On(*place + reach, foot + chance_.Between(0.3, 0.8)));
      world_.Column("dark", On(*place, 0.0), On(*place, foot + 0.01), 0.06, 8);
    }
  }

  RandomWorldOptions options_;
  Chance chance_;
  BoxWorld world_;
  Eigen::Vector3d size_ = Eigen::Vector3d::Zero();
  std::vector<Room> rooms_;
  std::vector<Disc> left_free_;  ///< Doorways, the start, and what furniture took.
};

}  // namespace

RandomWorld MakeRandomWorld(const RandomWorldOptions& options) {
  if (!(options.clutter >= 0.0 && options.clutter <= 2.0))
    throw std::invalid_argument("clutter must be 0 to 2 pieces a square metre");
  if (!(options.scale >= 1.0 && options.scale <= 5.0)) throw std::invalid_argument("scale must be 1 to 5");
  return Builder(options).Build();
}

}  // namespace thalweg::simulator
