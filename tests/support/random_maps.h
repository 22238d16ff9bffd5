#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "common/voxel/for_each_voxel.h"
#include "services/explorer/core/field/harmonic_field.h"

/// Seeded random worlds for tests and benchmarks of the field.
namespace thalweg::testing {

using explorer::FieldCell;
using FieldMap = DenseGrid<FieldCell>;

inline int UniformInt(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

inline VoxelIndex RandomCell(const VoxelBox& box, std::mt19937& random) {
  return {UniformInt(random, box.min.x, box.max.x - 1), UniformInt(random, box.min.y, box.max.y - 1),
          UniformInt(random, box.min.z, box.max.z - 1)};
}

/// Sets the cells of `region` that lie within the map.
inline void FillBox(FieldMap& map, const VoxelBox& region, FieldCell value) {
  ForEachVoxel(Intersection(region, map.box()), [&](const VoxelIndex& i) { map[i] = value; });
}

inline void PutCube(FieldMap& map, const VoxelIndex& center, int radius, FieldCell value) {
  FillBox(map, CubeAround(center, radius), value);
}

/// Rooms in a row, each with a door to a corridor along x.
class Comb {
 public:
  static constexpr int kRoom = 24;  ///< Edge of a room in cells.

  static FieldMap Of(int rooms) {
    FieldMap map({{0, 0, 0}, {rooms * kPitch + 2, kRoom + kCorridor + 6, kRoom + 2}}, FieldCell::kWall);
    FillBox(map, {{1, 1, 1}, {rooms * kPitch + 1, 1 + kCorridor, 1 + kCorridor}}, FieldCell::kFree);
    for (int r = 0; r < rooms; ++r) {
      const int x = 1 + r * kPitch;
      FillBox(map, {{x, kCorridor + 3, 1}, {x + kRoom, kCorridor + 3 + kRoom, 1 + kRoom}}, FieldCell::kFree);
      const int door = x + kRoom / 2 - kDoor / 2;
      FillBox(map, {{door, kCorridor, 1}, {door + kDoor, kCorridor + 4, 1 + kDoor}}, FieldCell::kFree);
    }
    return map;
  }
  static VoxelIndex InRoom(int r) {
    return {1 + r * kPitch + kRoom / 2, kCorridor + 3 + kRoom / 2, kRoom / 2};
  }
  /// Adds the robot, and a frontier in the last room.
  static FieldMap Explored(int rooms) {
    FieldMap map = Of(rooms);
    PutCube(map, InRoom(rooms - 1) - VoxelIndex{7, 0, 0}, 2, FieldCell::kSource);
    PutCube(map, InRoom(rooms - 1) + VoxelIndex{7, 0, 0}, 2, FieldCell::kSink);
    return map;
  }

 private:
  static constexpr int kPitch = kRoom + 2;
  static constexpr int kCorridor = 10;  // in cells, width and height
  static constexpr int kDoor = 8;
};

/// Makes the free cells within `radius` of a random free cell the source.
inline void PlaceSource(FieldMap& map, int radius, std::mt19937& random) {
  for (int attempt = 0; attempt < 100000; ++attempt) {
    const VoxelIndex center = RandomCell(map.box(), random);
    if (map[center] != FieldCell::kFree) continue;
    ForEachVoxel(CubeAround(center, radius), [&](const VoxelIndex& i) {
      const auto [x, y, z] = i - center;
      if (x * x + y * y + z * z <= radius * radius && map.Get(i, FieldCell::kWall) == FieldCell::kFree) {
        map[i] = FieldCell::kSource;
      }
    });
    return;
  }
}

/// Makes sinks of the free cells in `count` cubes at random positions, with random edges of 1 to `max_edge`.
inline void PlaceSinks(FieldMap& map, int count, int max_edge, std::mt19937& random,
                       FieldCell kind = FieldCell::kSink) {
  for (int attempt = 0, placed = 0; placed < count && attempt < 1000 * count; ++attempt) {
    const VoxelIndex center = RandomCell(map.box(), random);
    if (map[center] != FieldCell::kFree) continue;
    const int edge = UniformInt(random, 1, max_edge);
    ForEachVoxel({center, center + VoxelIndex{edge, edge, edge}}, [&](const VoxelIndex& i) {
      if (map.Get(i, FieldCell::kWall) == FieldCell::kFree) map[i] = kind;
    });
    ++placed;
  }
}

/// Each cell is free with probability `free_share`, else wall: the hardest topology.
inline FieldMap RandomCells(const VoxelBox& box, double free_share, std::mt19937& random) {
  FieldMap map(box, FieldCell::kWall);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (random() < free_share * 4294967296.0) map[i] = FieldCell::kFree;
  }
  return map;
}

/// Free space with `count` wall boxes, some of them thin plates.
inline FieldMap RandomBoxes(const VoxelBox& box, int count, int max_edge, std::mt19937& random) {
  FieldMap map(box, FieldCell::kFree);
  for (int k = 0; k < count; ++k) {
    const VoxelIndex min = RandomCell(box, random);
    std::array<int, 3> edge{};
    for (int& e : edge) e = UniformInt(random, 1, max_edge);
    if (k % 2 == 0) edge[static_cast<std::size_t>(UniformInt(random, 0, 2))] = 1;
    FillBox(map, {min, min + VoxelIndex{edge[0], edge[1], edge[2]}}, FieldCell::kWall);
  }
  return map;
}

/// A perfect three-dimensional maze with corridors `corridor` cells wide between walls `wall` cells thick.
inline FieldMap Maze(const VoxelIndex& rooms, int corridor, int wall, std::mt19937& random) {
  const int pitch = corridor + wall;
  const auto first = [&](int r) { return wall + r * pitch; };
  FieldMap map({{0, 0, 0}, {first(rooms.x), first(rooms.y), first(rooms.z)}}, FieldCell::kWall);
  DenseGrid<std::uint8_t> seen({{0, 0, 0}, rooms}, 0);
  std::vector<VoxelIndex> path{{0, 0, 0}};
  const auto carve = [&](const VoxelIndex& a, const VoxelIndex& b) {
    FillBox(map,
            {{first(std::min(a.x, b.x)), first(std::min(a.y, b.y)), first(std::min(a.z, b.z))},
             {first(std::max(a.x, b.x)) + corridor, first(std::max(a.y, b.y)) + corridor,
              first(std::max(a.z, b.z)) + corridor}},
            FieldCell::kFree);
  };
  seen[path.back()] = 1;
  carve(path.back(), path.back());
  while (!path.empty()) {
    std::vector<VoxelIndex> steps;
    for (const VoxelIndex& d : kFaceNeighbors) {
      const VoxelIndex n = path.back() + d;
      if (seen.Contains(n) && !seen[n]) steps.push_back(n);
    }
    if (steps.empty()) {
      path.pop_back();
      continue;
    }
    const VoxelIndex next = steps[random() % steps.size()];
    seen[next] = 1;
    carve(path.back(), next);
    path.push_back(next);
  }
  return map;
}

/// Randomly divided rooms on several floors, connected by doors and hatches and furnished with boxes; about
/// half of the cells are free.
class FurnishedBuilding {
 public:
  static FieldMap Generate(const VoxelIndex& size, std::mt19937& random) {
    FurnishedBuilding building(size, random);
    building.Split({{2, 2, 2}, {size.x - 2, size.y - 2, size.z - 2}});
    for (const VoxelBox& door : building.doors_) FillBox(building.map_, door, FieldCell::kFree);
    return std::move(building.map_);
  }

 private:
  static constexpr int kWall = 4;
  static constexpr int kDoor = 7;
  static constexpr int kLargestRoom[3] = {64, 64, 30};

  FurnishedBuilding(const VoxelIndex& size, std::mt19937& random)
      : map_({{0, 0, 0}, size}, FieldCell::kWall), random_(random) {}

  void Split(const VoxelBox& room) {
    const int size[3] = {room.size_x(), room.size_y(), room.size_z()};
    int axis = 0;
    for (int a = 1; a < 3; ++a) {
      if (size[a] * kLargestRoom[axis] > size[axis] * kLargestRoom[a]) axis = a;
    }
    if (size[axis] <= kLargestRoom[axis]) return Furnish(room);
    const int at = size[axis] * UniformInt(random_, 42, 58) / 100;
    const auto with = [axis](VoxelIndex i, int value) {
      (axis == 0 ? i.x : axis == 1 ? i.y : i.z) = value;
      return i;
    };
    const int begin = axis == 0 ? room.min.x : axis == 1 ? room.min.y : room.min.z;
    Split({room.min, with(room.max, begin + at - kWall / 2)});
    Split({with(room.min, begin + at + kWall / 2), room.max});
    for (int k = 0; k < 2; ++k) {  // openings reach far into both sides, past furniture at the wall
      const VoxelBox place{room.min, room.max - VoxelIndex{kDoor, kDoor, kDoor}};
      VoxelIndex min = RandomCell(place, random_);
      if (axis != 2) min.z = std::max(room.min.z, min.z / kLargestRoom[2] * kLargestRoom[2]);
      min = with(min, begin + at - 2 * kWall);
      doors_.push_back({min, with(min + VoxelIndex{kDoor, kDoor, kDoor}, begin + at + 2 * kWall)});
    }
  }

  void Furnish(const VoxelBox& room) {
    FillBox(map_, room, FieldCell::kFree);
    const int count = static_cast<int>(room.count() / 5000);
    for (int k = 0; k < count; ++k) {
      const VoxelIndex min = RandomCell(room, random_);
      const bool stands = random_() % 2 == 0;
      const VoxelIndex from{min.x, min.y, stands ? room.min.z : min.z};
      const VoxelIndex edge{UniformInt(random_, 3, 20), UniformInt(random_, 3, 20),
                            UniformInt(random_, 2, 18)};
      const VoxelIndex end = from + edge;
      FillBox(map_,
              {from, {std::min(end.x, room.max.x), std::min(end.y, room.max.y), std::min(end.z, room.max.z)}},
              FieldCell::kWall);
    }
  }

  FieldMap map_;
  std::mt19937& random_;
  std::vector<VoxelBox> doors_;
};

/// A furnished building in the middle of its exploration: a robot with a radius of 3 cells, and frontier
/// patches.
inline FieldMap ExplorationScene(const VoxelIndex& size, std::uint32_t seed) {
  std::mt19937 random(seed);
  FieldMap map = FurnishedBuilding::Generate(size, random);
  const auto patches = static_cast<int>(map.size() / 20000) + 2;
  PlaceSinks(map, patches, 4, random);
  PlaceSource(map, 3, random);
  return map;
}

}  // namespace thalweg::testing
