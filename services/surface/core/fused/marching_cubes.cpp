#include "services/surface/core/fused/marching_cubes.h"

#include <utility>

#include "common/base/check.h"

namespace thalweg::surface {
namespace {

constexpr int kNone = -1;

/// The edge between two corners that differ along one axis.
int EdgeBetween(int a, int b) {
  for (int edge = 0; edge < MarchingCubes::kEdges; ++edge) {
    const int start = MarchingCubes::EdgeStart(edge);
    const int end = MarchingCubes::EdgeEnd(edge);
    if ((start == a && end == b) || (start == b && end == a)) return edge;
  }
  THALWEG_CHECK(false);
  return kNone;
}

/// The corners of a face, counterclockwise as seen from outside of the cell.
std::array<int, 4> FaceOf(int axis, int side) {
  const int first = 1 << (axis + 1) % 3;
  const int second = 1 << (axis + 2) % 3;
  const int base = side << axis;
  if (side == 0) return {base, base | second, base | first | second, base | first};
  return {base, base | first, base | first | second, base | second};
}

MarchingCubes::Triangles Triangulate(std::uint8_t inside) {
  const auto is_inside = [&](int corner) { return (inside >> corner & 1) != 0; };
  std::array<int, MarchingCubes::kEdges> next;  // where the loop goes on from each edge
  next.fill(kNone);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      const std::array<int, 4> face = FaceOf(axis, side);
      for (std::size_t k = 0; k < 4; ++k) {
        const int corner = face[k];
        const int before = face[(k + 3) % 4];
        if (!is_inside(corner) || is_inside(before)) continue;
        std::size_t last = k;  // a run of corners inside, which begins here
        while (is_inside(face[(last + 1) % 4])) ++last;
        next[static_cast<std::size_t>(EdgeBetween(before, corner))] =
            EdgeBetween(face[last % 4], face[(last + 1) % 4]);
      }
    }
  }
  MarchingCubes::Triangles triangles;
  for (int first = 0; first < MarchingCubes::kEdges; ++first) {
    std::vector<std::uint8_t> loop;
    for (int edge = first; next[static_cast<std::size_t>(edge)] != kNone;) {
      loop.push_back(static_cast<std::uint8_t>(edge));
      edge = std::exchange(next[static_cast<std::size_t>(edge)], kNone);
    }
    for (std::size_t k = 2; k < loop.size(); ++k) triangles.push_back({loop[0], loop[k - 1], loop[k]});
  }
  return triangles;
}

}  // namespace

int MarchingCubes::EdgeStart(int edge) {
  const int axis = edge / 4;
  const int first = edge % 4 & 1;
  const int second = edge % 4 >> 1;
  return first << (axis + 1) % 3 | second << (axis + 2) % 3;
}

const MarchingCubes::Triangles& MarchingCubes::TrianglesOf(std::uint8_t inside) {
  static const auto cases = [] {
    std::array<Triangles, 256> all;
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = Triangulate(static_cast<std::uint8_t>(k));
    return all;
  }();
  return cases[inside];
}

}  // namespace thalweg::surface
