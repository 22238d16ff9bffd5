#include "services/simulator/tools/random_world.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "services/simulator/tools/chance.h"
#include "services/simulator/tools/furniture.h"

namespace thalweg::simulator {
namespace {

constexpr double kHalfWall = 0.06;     // [m]
constexpr double kDoorLeft = 0.7;      // [m] kept free about a doorway's center
constexpr double kStartLeft = 0.7;     // [m] kept free about the start
constexpr double kWallOverlap = 0.08;  // [m] of walls where they meet, because none is quite straight
constexpr int kTries = 8;

/// How rooms are divided.
struct Rooms {
  double least;  ///< [m] Least length and width.
  double small;  ///< [m^2] What is smaller is not always divided.
};
constexpr Rooms kHome{.least = 2.1, .small = 14.0};
constexpr Rooms kOffice{.least = 4.0, .small = 50.0};
constexpr double kLeastRoom = kHome.least;
constexpr double kSlab = 0.1;  // [m] between two storeys

Layout LayoutOf(const RandomWorldOptions& options) {
  return options.layout.value_or(static_cast<Layout>(options.seed % 4));
}

std::string NameOf(const RandomWorldOptions& options) {
  std::string kind = "random";
  for (const auto& [name, layout] : LayoutNames()) {
    if (layout == options.layout) kind = name;
  }
  return kind + '_' + std::to_string(options.seed);
}

class Builder {
 public:
  explicit Builder(const RandomWorldOptions& options)
      : options_(options),
        chance_(options.seed),
        world_(NameOf(options),
               {chance_.Between(0.01, 0.06), chance_.Between(0.01, 0.06), chance_.Between(0.01, 0.06)}) {}

  RandomWorld Build() {
    const Layout layout = LayoutOf(options_);
    size_ = DrawSize(layout);
    AddMaterials(world_);
    world_.Shell(size_, "floor", "wall", "ceiling");
    const FloorArea whole{{0.0, 0.0}, size_.head<2>()};
    if (layout == Layout::kStoreys) return BuildStoreys(whole);
    BeginFloor(size_.z());
    const Eigen::Vector2d start = AddLayout(layout, whole);
    return Finished(start, FurnishAll());
  }

 private:
  Eigen::Vector3d DrawSize(Layout layout) {
    const double scale = options_.scale;
    if (layout == Layout::kOffices) return {30.0 * scale, 30.0 * scale, 2.0};
    if (layout == Layout::kMaze) return {35.0 * scale, 35.0 * scale, 2.0};
    if (layout == Layout::kStoreys) return {20.0 * scale, 20.0 * scale, 4.0};
    const double x = chance_.Between(6.0, 10.0) * scale;
    const double y = chance_.Between(8.0, 14.0) * scale;
    const double z = layout == Layout::kHall ? chance_.Between(2.5, 4.0) : chance_.Between(2.0, 2.9);
    return {x, y, z};
  }

  void BeginFloor(double height) {
    height_ = height;
    spaces_.clear();
    furnisher_.emplace(world_, chance_, height);
  }

  /// Adds the walls of a world of one floor. Returns the start.
  Eigen::Vector2d AddLayout(Layout layout, const FloorArea& whole) {
    switch (layout) {
      case Layout::kRooms:
        Split(whole, kHome);
        break;
      case Layout::kCorridor:
        AddCorridor(whole);
        break;
      case Layout::kStalls:
        AddStalls(whole);
        break;
      case Layout::kHall:
        spaces_.push_back({whole});
        break;
      case Layout::kOffices:
        return AddOffices(whole);
      default:
        return AddMaze(whole);
    }
    const FloorArea& first = spaces_.front().area;
    const Eigen::Vector2d start = 0.5 * (first.low + first.high);
    furnisher_->LeaveFree(start, kStartLeft);
    if (layout == Layout::kHall) AddPillars(whole);
    return start;
  }

  std::vector<FloorArea> FurnishAll() {
    std::vector<FloorArea> rooms;
    for (const Space& space : spaces_) {
      const double area = (space.area.high - space.area.low).prod();
      furnisher_->Furnish(space, static_cast<int>(std::lround(options_.clutter * area)));
      rooms.push_back(space.area);
    }
    return rooms;
  }

  RandomWorld Finished(const Eigen::Vector2d& start, std::vector<FloorArea> rooms) {
    return {.boxes = std::move(world_),
            .size = size_,
            .start = On(start, 0.5 * std::min(height_, 2.4)),
            .rooms = std::move(rooms)};
  }

  double DoorHead() const { return std::min(2.0, height_ - 0.1); }
  Opening Door(double from) {
    return {.from = from, .width = chance_.Between(0.85, 1.1), .head = DoorHead()};
  }

  /// Adds a wall with a doorway across a room: for `axis` 0 at x = `at` from low to high y, for 1 at y =
  /// `at`.
  void AddWallWithDoor(const FloorArea& room, int axis, double at, double door_from) {
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
    AddWall(world_, from, to, 0, height_, {shifted});
    Eigen::Vector2d middle;
    middle[axis] = at;
    middle[along] = room.low[along] + door.from + 0.5 * door.width;
    furnisher_->LeaveFree(middle, kDoorLeft);
  }

  void Split(const FloorArea& room, const Rooms& rooms) {
    const Eigen::Vector2d size = room.high - room.low;
    const int axis = size.x() > size.y() ? 0 : 1;
    const bool large_enough = size[axis] >= 2.0 * rooms.least + 0.3;
    if (!large_enough || (size.prod() < rooms.small && chance_.Below(3) == 0)) {
      spaces_.push_back({room});
      return;
    }
    for (int n = 0; n < kTries; ++n) {
      const double at = chance_.Between(room.low[axis] + rooms.least, room.high[axis] - rooms.least);
      if (furnisher_->IsTaken(room, 0.3, axis, at, kDoorLeft + 0.1)) continue;
      AddWallWithDoor(room, axis, at, chance_.Between(0.3, size[1 - axis] - 1.4));
      FloorArea lower = room;
      FloorArea upper = room;
      lower.high[axis] = at - kHalfWall;
      upper.low[axis] = at + kHalfWall;
      Split(lower, rooms);
      Split(upper, rooms);
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
      furnisher_->LeaveFree({door_x, doors.back().from + 0.5 * doors.back().width}, kDoorLeft);
      if (end < length)
        AddWall(world_, {low_x, end}, {high_x, end + chance_.Between(-0.05, 0.05)}, 0, height_);
      y = end;
    }
    AddWall(world_, {door_x, 0}, {door_x + chance_.Between(-0.05, 0.05), length}, 0, height_, doors);
  }

  void AddCorridor(const FloorArea& whole) {
    const Eigen::Vector2d size = whole.high;
    const double width = chance_.Between(1.3, 1.7);
    const double left = chance_.Between(kLeastRoom, size.x() - width - kLeastRoom);
    AddRow(0.0, left, size.y());
    AddRow(size.x(), left + width, size.y());
  }

  void AddStalls(const FloorArea& whole) {
    const Eigen::Vector2d size = whole.high;
    const double aisle = chance_.Between(1.4, 1.8);
    const double left = chance_.Between(0.3, 0.7) * (size.x() - aisle);
    for (double y = 0.0; y < size.y();) {
      double end = y + chance_.Between(1.6, 2.6);
      if (size.y() - end < 1.6) end = size.y();
      for (const auto& [from, to] : {std::pair{0.0, left}, {left + aisle, size.x()}}) {
        spaces_.push_back({.area = {{from, y + kHalfWall}, {to, end - kHalfWall}},
                           .open_side = from == 0.0 ? Space::kHighX : Space::kLowX});
        if (end < size.y())
          AddWall(world_, {from, end}, {to, end + chance_.Between(-0.05, 0.05)}, 0, height_);
      }
      y = end;
    }
  }

  void AddPillars(const FloorArea& room) {
    for (std::size_t n = 4 + chance_.Below(3); n > 0; --n) {
      const double radius = chance_.Between(0.15, 0.25);
      if (const auto place = furnisher_->Place(room, radius)) {
        world_.Column("white", On(*place, 0.0), On(*place, size_.z()), radius, 12);
      }
    }
    for (int n = 0; n < 3; ++n) {
      const double half = chance_.Between(0.7, 1.4);
      const auto place = furnisher_->Place(room, half + 0.01);
      if (!place) continue;
      const double top = chance_.Between(1.5, size_.z() - 0.2);
      const Eigen::Vector2d reach(0.04, half);
      world_.TurnedBox("blue", On(*place - reach, 0.0), On(*place + reach, top), chance_.Between(0.0, 180.0));
    }
  }

  /// Adds a wall along one side of a block, with two doorways that lie apart.
  void AddWallWithDoors(const FloorArea& block, int axis, double at) {
    const int along = 1 - axis;
    Eigen::Vector2d from = block.low;
    Eigen::Vector2d to = block.high;
    from[axis] = to[axis] = at;
    const double half = 0.5 * (block.high[along] - block.low[along]);
    std::vector<Opening> doors;
    for (const double first : {0.0, half}) {
      doors.push_back(Door(first + chance_.Between(0.5, half - 1.6)));
      Eigen::Vector2d middle = from;
      middle[along] += doors.back().from + 0.5 * doors.back().width;
      furnisher_->LeaveFree(middle, kDoorLeft);
    }
    AddWall(world_, from, to, 0, height_, doors);
  }

  /// Two corridors that cross, with a block of rooms in each corner. Returns the crossing.
  Eigen::Vector2d AddOffices(const FloorArea& whole) {
    Eigen::Vector2d low;  // of the crossing
    Eigen::Vector2d high;
    for (int axis = 0; axis < 2; ++axis) {
      const double width = chance_.Between(1.8, 2.4);
      low[axis] = chance_.Between(0.35, 0.65) * whole.high[axis] - 0.5 * width;
      high[axis] = low[axis] + width;
    }
    const Eigen::Vector2d crossing = 0.5 * (low + high);
    furnisher_->LeaveFree(crossing, kStartLeft);
    for (const bool right : {false, true}) {
      for (const bool upper : {false, true}) {
        FloorArea block = whole;
        (right ? block.low : block.high).x() = right ? high.x() : low.x();
        (upper ? block.low : block.high).y() = upper ? high.y() : low.y();
        AddWallWithDoors(block, 0, right ? high.x() : low.x());
        AddWallWithDoors(block, 1, upper ? high.y() : low.y());
        Split(block, kOffice);
      }
    }
    return crossing;
  }

  /// Rings around a middle cell, of eight sides each, with a wall across at each corner. A spanning tree of
  /// the cells (Kruskal's algorithm on shuffled walls) has doorways, so that there is a way to each, and a
  /// third of the other walls. Returns the middle.
  Eigen::Vector2d AddMaze(const FloorArea& whole) {
    constexpr std::size_t kSides = 8;
    constexpr double kCorner = std::numbers::pi / kSides;
    constexpr double kPitch = 3.2;  // [m] between rings
    const Eigen::Vector2d middle = 0.5 * whole.high;
    const auto rings = static_cast<std::size_t>(std::lround(middle.x() / kPitch));
    const auto corner = [&](std::size_t ring, std::size_t side) -> Eigen::Vector2d {
      const double apothem =
          ring == rings ? middle.x() : middle.x() * (ring + 0.5) / (static_cast<double>(rings) + 0.5);
      const double angle = (2.0 * static_cast<double>(side) + 1.0) * kCorner;
      return middle + apothem / std::cos(kCorner) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    };
    // Cell 0 lies in the middle; ring n has the cells from 1 + kSides * (n - 1).
    struct Wall {
      Eigen::Vector2d from, to;
      std::array<std::size_t, 2> cells;
    };
    std::vector<Wall> walls;
    for (std::size_t ring = 0; ring < rings; ++ring) {
      for (std::size_t side = 0; side < kSides; ++side) {
        const std::size_t next = (side + 1) % kSides;
        const std::size_t outer = 1 + kSides * ring;
        walls.push_back(
            {corner(ring, side), corner(ring, next), {ring == 0 ? 0 : outer - kSides + next, outer + next}});
        walls.push_back({corner(ring, side), corner(ring + 1, side), {outer + side, outer + next}});
      }
    }
    for (std::size_t n = walls.size() - 1; n > 0; --n) std::swap(walls[n], walls[chance_.Below(n + 1)]);
    std::vector<std::size_t> group(1 + kSides * rings);
    std::iota(group.begin(), group.end(), std::size_t{0});
    for (const Wall& wall : walls) {
      const std::size_t here = group[wall.cells[0]];
      const std::size_t there = group[wall.cells[1]];
      const double length = (wall.to - wall.from).norm();
      const bool open = here != there || chance_.Below(3) == 0;
      std::vector<Opening> doors;
      if (open) {
        const double width = std::min(chance_.Between(1.2, 2.4), length - 0.3);
        doors.push_back(
            {.from = chance_.Between(0.15, length - width - 0.15), .width = width, .head = height_});
        std::ranges::replace(group, there, here);
      }
      AddWall(world_, wall.from, wall.to, 0, height_, doors);
    }
    return middle;
  }

  RandomWorld BuildStoreys(const FloorArea& whole) {
    std::vector<FloorArea> rooms;
    for (const double floor : {0.0, 0.5 * (size_.z() + kSlab)}) {
      world_.Lift(floor);
      BeginFloor(0.5 * (size_.z() - kSlab));
      AddStorey(whole);
      const std::vector<FloorArea> here = FurnishAll();
      rooms.insert(rooms.end(), here.begin(), here.end());
    }
    world_.Lift(0.0);
    AddSlab(whole);
    return Finished(0.5 * whole.high, std::move(rooms));
  }

  /// Adds the hall and the rooms on both sides of it.
  void AddStorey(const FloorArea& whole) {
    const double hall = 0.5 * chance_.Between(2.6, 3.2);
    furnisher_->LeaveFree(0.5 * whole.high, kStartLeft);
    FloorArea lower = whole;
    FloorArea upper = whole;
    lower.high.x() = 0.5 * whole.high.x() - hall;
    upper.low.x() = 0.5 * whole.high.x() + hall;
    AddWallWithDoors(lower, 0, lower.high.x());
    AddWallWithDoors(upper, 0, upper.low.x());
    Split(lower, kOffice);
    Split(upper, kOffice);
  }

  /// Adds what divides two storeys, with a hole in each half of the hall.
  void AddSlab(const FloorArea& whole) {
    const double low = height_;
    const double high = size_.z() - height_;
    constexpr double kHole = 1.0;  // [m] half of its length and width
    const double x = 0.5 * whole.high.x();
    double from = 0.0;
    for (const double share : {0.2, 0.8}) {
      const double y = share * whole.high.y();
      world_.Box("ceiling", {0.0, from, low}, {whole.high.x(), y - kHole, high});
      world_.Box("ceiling", {0.0, y - kHole, low}, {x - kHole, y + kHole, high});
      world_.Box("ceiling", {x + kHole, y - kHole, low}, {whole.high.x(), y + kHole, high});
      from = y + kHole;
    }
    world_.Box("ceiling", {0.0, from, low}, {whole.high.x(), whole.high.y(), high});
  }

  RandomWorldOptions options_;
  Chance chance_;
  BoxWorld world_;
  Eigen::Vector3d size_ = Eigen::Vector3d::Zero();
  // The floor that is being built:
  double height_ = 0.0;  ///< [m]
  std::vector<Space> spaces_;
  std::optional<Furnisher> furnisher_;
};

std::string Text(const Eigen::Vector3d& p) {
  std::ostringstream text;
  text << "{ x: " << p.x() << " y: " << p.y() << " z: " << p.z() << " }";
  return text.str();
}

}  // namespace

const std::vector<LayoutName>& LayoutNames() {
  static const std::vector<LayoutName> names{
      {"rooms", Layout::kRooms},     {"corridor", Layout::kCorridor}, {"stalls", Layout::kStalls},
      {"hall", Layout::kHall},       {"offices", Layout::kOffices},   {"maze", Layout::kMaze},
      {"storeys", Layout::kStoreys},
  };
  return names;
}

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
