#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <utility>

#include "services/simulator/tools/furniture.h"
#include "services/simulator/tools/worlds.h"

namespace thalweg::simulator {
namespace {

constexpr int kCells = 10;  // along each axis
constexpr double kCell = 2.0;
constexpr double kTop = 2.0;
constexpr double kShift = 0.14;  // [m] largest offset of a post from its grid point

/// A spanning tree of the cells by depth-first search, with a few more openings so that there are loops.
class Plan {
 public:
  explicit Plan(std::uint32_t seed) : random_(seed) {
    Carve(0, 0);
    for (int k = 0; k < 8; ++k) {
      const int x = 1 + Draw(kCells - 2);
      const int y = 1 + Draw(kCells - 2);
      (Draw(2) == 0 ? open_east_ : open_north_)[x][y] = true;
    }
  }
  bool OpenEast(int x, int y) const { return open_east_[x][y]; }
  bool OpenNorth(int x, int y) const { return open_north_[x][y]; }
  /// Draws 0 to count - 1, not by std::uniform_int_distribution, which differs between standard libraries.
  int Draw(int count) { return static_cast<int>(random_() % static_cast<std::uint32_t>(count)); }

 private:
  void Carve(int x, int y) {
    reached_[x][y] = true;
    std::array<int, 4> directions{0, 1, 2, 3};
    for (int k = 3; k > 0; --k) std::swap(directions[k], directions[Draw(k + 1)]);
    for (const int direction : directions) {
      const int to_x = x + std::array{1, -1, 0, 0}[direction];
      const int to_y = y + std::array{0, 0, 1, -1}[direction];
      if (to_x < 0 || to_x >= kCells || to_y < 0 || to_y >= kCells || reached_[to_x][to_y]) continue;
      if (direction < 2) {
        open_east_[std::min(x, to_x)][y] = true;
      } else {
        open_north_[x][std::min(y, to_y)] = true;
      }
      Carve(to_x, to_y);
    }
  }

  using Cells = std::array<std::array<bool, kCells>, kCells>;
  std::mt19937 random_;
  Cells reached_{};
  Cells open_east_{};
  Cells open_north_{};
};

}  // namespace

BoxWorld MakeMaze() {
  BoxWorld world("maze", {0.034, 0.042, 0.027});
  AddMaterials(world);
  world.Shell({kCells * kCell, kCells * kCell, kTop}, "floor", "wall", "ceiling");
  Plan plan(7);
  // Posts stand off their grid points, so that no wall between two of them is parallel to an axis.
  std::array<std::array<Eigen::Vector2d, kCells + 1>, kCells + 1> posts;
  for (int x = 0; x <= kCells; ++x) {
    for (int y = 0; y <= kCells; ++y) {
      const auto shift = [&](int k) {
        return k == 0 || k == kCells ? 0.0 : kShift * (plan.Draw(2001) - 1000) / 1000.0;
      };
      posts[x][y] = {kCell * x + shift(x), kCell * y + shift(y)};
      if (x % kCells == 0 || y % kCells == 0) continue;
      const Eigen::Vector3d low(posts[x][y].x() - 0.12, posts[x][y].y() - 0.12, 0);
      world.TurnedBox("wood", low, low + Eigen::Vector3d(0.24, 0.24, kTop), plan.Draw(90));
    }
  }
  for (int x = 0; x < kCells; ++x) {
    for (int y = 0; y < kCells; ++y) {
      if (x + 1 < kCells && !plan.OpenEast(x, y))
        AddWall(world, posts[x + 1][y], posts[x + 1][y + 1], 0, kTop);
      if (y + 1 < kCells && !plan.OpenNorth(x, y))
        AddWall(world, posts[x][y + 1], posts[x + 1][y + 1], 0, kTop);
    }
  }
  const std::array colors{"red", "green", "blue", "yellow", "white"};
  for (int k = 0; k < 24; ++k) {  // crates to look behind, on one side of a cell
    const double x = kCell * plan.Draw(kCells) + 0.32 + 0.02 * plan.Draw(10);
    const double y = kCell * plan.Draw(kCells) + 0.34 + 0.02 * plan.Draw(10);
    const double size = 0.3 + 0.02 * plan.Draw(10);
    const double height = 0.3 + 0.04 * plan.Draw(30);
    world.TurnedBox(colors[static_cast<std::size_t>(k) % colors.size()], {x, y, 0},
                    {x + size, y + size, height}, plan.Draw(90));
  }
  return world;
}

}  // namespace thalweg::simulator
