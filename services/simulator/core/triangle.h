#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "services/simulator/core/mesh.h"

namespace thalweg::simulator {

using Triangle = std::array<Eigen::Vector3d, 3>;

inline Triangle TriangleOf(const Mesh& mesh, std::uint32_t index) {
  const auto& corners = mesh.triangles[index];
  return {mesh.vertices[corners[0]].cast<double>(), mesh.vertices[corners[1]].cast<double>(),
          mesh.vertices[corners[2]].cast<double>()};
}

/// Exact, also for triangles without area.
double DistanceToTriangle(const Eigen::Vector3d& p, const Triangle& triangle);

/// How deep a triangle reaches into a box: the least overlap of the two along any of the thirteen
/// separating axes [Akenine-Moeller: Fast 3D Triangle-Box Overlap Testing, J. Graphics Tools 6(1), 2001].
/// Negative: apart by at least that much. Within the triangle's own plane a box counts as deep as the plane
/// lies under its nearer side.
double OverlapDepth(const Triangle& triangle, const Eigen::AlignedBox3d& box);

/// The part of a triangle inside a box, as a convex polygon's corners; empty when they are apart.
std::vector<Eigen::Vector3d> ClipToBox(const Triangle& triangle, const Eigen::AlignedBox3d& box);

/// The same of the part between two planes across an axis, at `low` and at `high`.
std::vector<Eigen::Vector3d> ClipToSlab(const Triangle& triangle, int axis, double low, double high);

}  // namespace thalweg::simulator
