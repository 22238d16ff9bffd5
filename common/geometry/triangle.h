#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace thalweg {

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Exact, including for degenerate triangles without area.
double DistanceToTriangle(const Eigen::Vector3d& p, const Triangle& triangle);

/// Penetration depth of a triangle into a box: the least overlap of the two along any of the thirteen
/// separating axes [Akenine-Moeller: Fast 3D Triangle-Box Overlap Testing, J. Graphics Tools 6(1), 2001]. A
/// negative value means that they are apart by at least that much. For a box in the middle of a large
/// triangle it is the depth of the triangle's plane below the nearer side of the box.
double OverlapDepth(const Triangle& triangle, const Eigen::AlignedBox3d& box);

/// The part of a triangle inside a box, as the corners of a convex polygon; empty when they are apart.
std::vector<Eigen::Vector3d> ClipToBox(const Triangle& triangle, const Eigen::AlignedBox3d& box);

/// The part of a triangle between the planes at `low` and `high` across an axis, in the same form.
std::vector<Eigen::Vector3d> ClipToSlab(const Triangle& triangle, int axis, double low, double high);

}  // namespace thalweg
