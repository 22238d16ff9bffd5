#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace thalweg::surface {

/// The triangles of a cell in which a surface separates some of the corners from the others [Lorensen, Cline,
/// Marching cubes, SIGGRAPH 1987].
///
/// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge e is along axis e / 4, from corner
/// EdgeStart(e) to EdgeEnd(e). The cases are computed, not tabulated by hand: on each face of the cell, every
/// run of neighboring corners inside the surface is cut off by a segment; segments join to closed loops,
/// which are cut into triangles. Corners that are diagonal on a face are thus never joined, whichever of the
/// two cells looks at it, so that the surface has no cracks [the flaw of the original: Dürst 1988].
class MarchingCubes {
 public:
  static constexpr int kCorners = 8;
  static constexpr int kEdges = 12;

  static int EdgeStart(int edge);
  static int EdgeEnd(int edge) { return EdgeStart(edge) | 1 << (edge / 4); }

  /// Triangles as triples of edges, counterclockwise as seen from outside.
  using Triangles = std::vector<std::array<std::uint8_t, 3>>;
  /// @param inside  Bit c says whether corner c is inside the surface.
  static const Triangles& TrianglesOf(std::uint8_t inside);
};

}  // namespace thalweg::surface
