#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "services/explorer/core/gaps/polygon.h"
#include "tests/services/explorer/support/random_numbers.h"

/// Seeded random simply connected polygons of several kinds, in general position with probability 1.
namespace thalweg::explorer::test {

enum class PolygonKind { kMaze, kStar, kComb, kSpiral, kTangle };

inline constexpr PolygonKind kPolygonKinds[] = {PolygonKind::kMaze, PolygonKind::kStar, PolygonKind::kComb,
                                                PolygonKind::kSpiral, PolygonKind::kTangle};

inline std::string NameOf(PolygonKind kind) {
  switch (kind) {
    case PolygonKind::kMaze:
      return "Maze";
    case PolygonKind::kStar:
      return "Star";
    case PolygonKind::kComb:
      return "Comb";
    case PolygonKind::kSpiral:
      return "Spiral";
    case PolygonKind::kTangle:
      break;
  }
  return "Tangle";
}

/// Seeded random numbers.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double Between(double low, double high) { return RandomDouble(random_, low, high); }
  int Whole(int low, int high) { return RandomInt(random_, low, high); }
  Eigen::Vector2d Point(double low, double high) {
    const double x = Between(low, high);
    return {x, Between(low, high)};
  }

 private:
  std::mt19937 random_;
};

/// The corridors of a random spanning tree of width x height rooms: walls and corridors are 0.5 m to 1.2 m
/// wide, and every corner is moved by up to 0.1 m each way, so that walls are neither parallel nor in line.
inline Polygon Maze(Dice& dice, int width, int height) {
  // Cells of a finer grid: rooms where both coordinates are even, passages where one is.
  std::map<std::pair<int, int>, bool> is_open;
  std::vector<std::pair<int, int>> stack = {{0, 0}};
  is_open[{0, 0}] = true;
  while (!stack.empty()) {
    const auto [x, y] = stack.back();
    std::vector<std::pair<int, int>> steps;
    for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}, std::pair{-1, 0}, std::pair{0, -1}}) {
      const int to_x = x + 2 * dx;
      const int to_y = y + 2 * dy;
      const bool exists = to_x >= 0 && to_y >= 0 && to_x < 2 * width && to_y < 2 * height;
      if (exists && !is_open[{to_x, to_y}]) steps.emplace_back(dx, dy);
    }
    if (steps.empty()) {
      stack.pop_back();
      continue;
    }
    const auto [dx, dy] = steps[static_cast<std::size_t>(dice.Whole(0, static_cast<int>(steps.size()) - 1))];
    is_open[{x + dx, y + dy}] = true;
    is_open[{x + 2 * dx, y + 2 * dy}] = true;
    stack.emplace_back(x + 2 * dx, y + 2 * dy);
  }
  // The sides of open cells toward closed ones, counterclockwise, by their beginnings.
  std::map<std::pair<int, int>, std::pair<int, int>> sides;
  for (int x = 0; x < 2 * width - 1; ++x) {
    for (int y = 0; y < 2 * height - 1; ++y) {
      if (!is_open[{x, y}]) continue;
      if (!is_open[{x, y - 1}]) sides[{x, y}] = {x + 1, y};
      if (!is_open[{x + 1, y}]) sides[{x + 1, y}] = {x + 1, y + 1};
      if (!is_open[{x, y + 1}]) sides[{x + 1, y + 1}] = {x, y + 1};
      if (!is_open[{x - 1, y}]) sides[{x, y + 1}] = {x, y};
    }
  }
  std::vector<double> at_x(1, 0.0);
  std::vector<double> at_y(1, 0.0);
  for (int k = 1; k < 2 * std::max(width, height); ++k) {
    at_x.push_back(at_x.back() + dice.Between(0.5, 1.2));
    at_y.push_back(at_y.back() + dice.Between(0.5, 1.2));
  }
  std::vector<Eigen::Vector2d> vertices;
  const std::pair<int, int> first = sides.begin()->first;
  std::pair<int, int> before = first;
  std::pair<int, int> at = sides[first];
  do {
    const std::pair<int, int> after = sides[at];
    const bool straight = (before.first == at.first) == (at.first == after.first);
    if (!straight) {
      const Eigen::Vector2d moved = dice.Point(-0.1, 0.1);
      vertices.emplace_back(at_x[static_cast<std::size_t>(at.first)] + moved.x(),
                            at_y[static_cast<std::size_t>(at.second)] + moved.y());
    }
    before = std::exchange(at, after);
  } while (before != first);
  return Polygon(vertices);
}

/// Vertices at random distances around the origin, from which everything is in sight.
inline Polygon Star(Dice& dice, int vertices) {
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < vertices; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k + dice.Between(0.1, 0.9)) / vertices;
    points.push_back(dice.Between(1.0, 5.0) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return Polygon(points);
}

/// A corridor with dead ends of random depths and slants to both of its sides.
inline Polygon Comb(Dice& dice, int teeth) {
  std::vector<Eigen::Vector2d> points;
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k < teeth; ++k) {
      const double x = side < 0.0 ? 2.0 * k : 2.0 * (teeth - k) - 1.0;
      const double depth = dice.Between(0.8, 4.0);
      const double slant = dice.Between(-0.4, 0.4);
      const auto add = [&](double ahead, double y) {
        points.emplace_back(x - side * ahead + dice.Between(-0.1, 0.1), side * (y + dice.Between(-0.1, 0.1)));
      };
      add(0.2, 0.6);
      add(0.2 + slant, 0.6 + depth);
      add(0.9 + slant, 0.6 + depth);
      add(0.9, 0.6);
    }
  }
  return Polygon(points);
}

/// A corridor that winds inward for up to two turns, with walls so uneven that niches hide one another.
inline Polygon Spiral(Dice& dice, int corners) {
  std::vector<Eigen::Vector2d> outer;
  std::vector<Eigen::Vector2d> inner;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 28.0;
    const double radius = 8.0 * std::exp(-0.015 * k);
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    outer.push_back(radius * dice.Between(0.95, 1.05) * direction);
    inner.push_back(0.75 * radius * dice.Between(0.97, 1.03) * direction);
  }
  outer.insert(outer.end(), inner.rbegin(), inner.rend());
  return Polygon(outer);
}

/// Random points, joined in a random order that is untangled: two walls that cross are replaced with two
/// shorter ones until none do. Corners are sharp, and no two neighborhoods are alike.
inline Polygon Tangle(Dice& dice, int vertices) {
  std::vector<Eigen::Vector2d> points;
  for (int k = 0; k < vertices; ++k) points.push_back(dice.Point(0.0, 10.0));
  const auto n = static_cast<std::ptrdiff_t>(points.size());
  const auto left = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return Cross(b - a, c - a) > 0.0;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      for (std::ptrdiff_t k = i + 2; k < n; ++k) {
        const Eigen::Vector2d a = points[i];
        const Eigen::Vector2d b = points[i + 1];
        const Eigen::Vector2d c = points[k];
        const Eigen::Vector2d d = points[(k + 1) % n];
        if (a == d || left(a, b, c) == left(a, b, d) || left(c, d, a) == left(c, d, b)) continue;
        std::reverse(points.begin() + i + 1, points.begin() + k + 1);
        changed = true;
      }
    }
  }
  double twice_area = 0.0;
  for (std::ptrdiff_t k = 0; k < n; ++k) twice_area += Cross(points[k], points[(k + 1) % n]);
  if (twice_area < 0.0) std::ranges::reverse(points);
  return Polygon(points);
}

/// A polygon of the kind that has no corners closer than 5 mm to a wall that is not their own.
inline Polygon RandomPolygon(PolygonKind kind, unsigned seed) {
  Dice dice(seed);
  while (true) {
    Polygon polygon = [&] {
      switch (kind) {
        case PolygonKind::kMaze: {
          const int width = dice.Whole(2, 8);
          return Maze(dice, width, dice.Whole(2, 8));
        }
        case PolygonKind::kStar:
          return Star(dice, dice.Whole(8, 40));
        case PolygonKind::kComb:
          return Comb(dice, dice.Whole(3, 8));
        case PolygonKind::kSpiral:
          return Spiral(dice, dice.Whole(16, 56));
        case PolygonKind::kTangle:
          break;
      }
      return Tangle(dice, dice.Whole(8, 40));
    }();
    double room = 1.0;
    for (std::size_t k = 0; k < polygon.size(); ++k) room = std::min(room, polygon.RoomAround(k));
    if (room > 0.005) return polygon;
  }
}

inline Eigen::Vector2d RandomPointIn(Dice& dice, const Polygon& polygon) {
  while (true) {
    const Eigen::Vector2d point = dice.Point(-10.0, 20.0);
    if (polygon.Contains(point)) return point;
  }
}

}  // namespace thalweg::explorer::test
