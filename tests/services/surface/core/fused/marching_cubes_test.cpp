#include "services/surface/core/fused/marching_cubes.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <set>

namespace thalweg::surface {
namespace {

Eigen::Vector3d CornerAt(int corner) {
  return Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1).cast<double>();
}
Eigen::Vector3d MiddleOf(int edge) {
  return 0.5 * (CornerAt(MarchingCubes::EdgeStart(edge)) + CornerAt(MarchingCubes::EdgeEnd(edge)));
}

TEST(MarchingCubes, HasEachEdgeOfTheCellOnce) {
  std::set<std::pair<int, int>> edges;
  for (int edge = 0; edge < MarchingCubes::kEdges; ++edge) {
    const int start = MarchingCubes::EdgeStart(edge);
    const int end = MarchingCubes::EdgeEnd(edge);
    EXPECT_NEAR((CornerAt(start) - CornerAt(end)).norm(), 1.0, 0.0);
    edges.insert({start, end});
  }
  EXPECT_EQ(edges.size(), 12U);
}

TEST(MarchingCubes, ASurfaceCrossesJustTheEdgesBetweenInsideAndOutside) {
  for (int inside = 0; inside < 256; ++inside) {
    std::set<int> used;
    for (const auto& triangle : MarchingCubes::TrianglesOf(static_cast<std::uint8_t>(inside))) {
      used.insert(triangle.begin(), triangle.end());
    }
    for (int edge = 0; edge < MarchingCubes::kEdges; ++edge) {
      const bool crosses =
          (inside >> MarchingCubes::EdgeStart(edge) & 1) != (inside >> MarchingCubes::EdgeEnd(edge) & 1);
      EXPECT_EQ(used.contains(edge), crosses) << "case " << inside << ", edge " << edge;
    }
  }
}

TEST(MarchingCubes, ACornerInsideIsCutOffByATriangleThatFacesAwayFromIt) {
  for (int corner = 0; corner < MarchingCubes::kCorners; ++corner) {
    const auto& triangles = MarchingCubes::TrianglesOf(static_cast<std::uint8_t>(1 << corner));
    ASSERT_EQ(triangles.size(), 1U);
    const Eigen::Vector3d a = MiddleOf(triangles[0][0]);
    const Eigen::Vector3d normal = (MiddleOf(triangles[0][1]) - a).cross(MiddleOf(triangles[0][2]) - a);
    EXPECT_GT(normal.dot(a - CornerAt(corner)), 0.0);
  }
}

/// Sides of triangles that no other triangle of the cell shares lie on the cell's faces. Two cells that share
/// a face, with whatever corners otherwise, must have the same sides there, in opposite directions: this is
/// what makes a surface closed.
TEST(MarchingCubes, CellsAgreeOnTheFaceThatTheyShare) {
  using Sides = std::set<std::pair<int, int>>;
  const auto open_sides = [](int inside) {
    Sides sides;
    for (const auto& triangle : MarchingCubes::TrianglesOf(static_cast<std::uint8_t>(inside))) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::pair<int, int> side{triangle[k], triangle[(k + 1) % 3]};
        if (sides.erase({side.second, side.first}) == 0) sides.insert(side);
      }
    }
    return sides;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto on_face = [&](int edge, int side) { return MiddleOf(edge)[axis] == side; };
    // The sides on the far face, by the corners of that face, as edges of the next cell and turned around.
    std::map<int, Sides> by_face;
    const auto corners_of = [&](int inside, int side) {
      int corners = 0;
      for (int c = 0; c < 8; ++c) {
        if ((c >> axis & 1) == side && (inside >> c & 1) != 0) corners |= 1 << (c & ~(1 << axis));
      }
      return corners;
    };
    const auto matching = [&](int edge) {  // the edge of the next cell at the same place
      for (int other = 0; other < MarchingCubes::kEdges; ++other) {
        if (MiddleOf(other) == MiddleOf(edge) - Eigen::Vector3d::Unit(axis)) return other;
      }
      return -1;
    };
    std::size_t compared = 0;
    for (int inside = 0; inside < 256; ++inside) {
      Sides turned;
      for (const auto& [from, to] : open_sides(inside)) {
        if (on_face(from, 1) && on_face(to, 1)) turned.insert({matching(to), matching(from)});
      }
      const auto [known, is_new] = by_face.try_emplace(corners_of(inside, 1), turned);
      EXPECT_EQ(known->second, turned);
    }
    for (int inside = 0; inside < 256; ++inside) {
      Sides sides;
      for (const auto& side : open_sides(inside)) {
        if (on_face(side.first, 0) && on_face(side.second, 0)) sides.insert(side);
      }
      EXPECT_EQ(by_face.at(corners_of(inside, 0)), sides) << "case " << inside << ", axis " << axis;
      compared += sides.size();
    }
    EXPECT_GT(compared, 100U);
    // All open sides are on faces of the cell.
    for (int inside = 0; inside < 256; ++inside) {
      for (const auto& [from, to] : open_sides(inside)) {
        const Eigen::Vector3d a = MiddleOf(from);
        const Eigen::Vector3d b = MiddleOf(to);
        bool shared = false;
        for (int k = 0; k < 3; ++k) shared = shared || (a[k] == b[k] && (a[k] == 0.0 || a[k] == 1.0));
        EXPECT_TRUE(shared);
      }
    }
  }
}

}  // namespace
}  // namespace thalweg::surface
