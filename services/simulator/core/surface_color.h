#pragma once

#include <Eigen/Core>

#include "services/simulator/core/mesh.h"

namespace thalweg::simulator {

/// The image that lies over a triangle, or nullptr.
const Texture* TextureOf(const Mesh& mesh, std::uint32_t triangle);

/// Color of a point of a triangle, before lighting.
/// @param barycentric  Weights of corners 1 and 2.
/// @param footprint    [m] Size of the area seen, e.g. that of a pixel on the surface. Detail of the
/// procedural pattern that is finer than this fades out, which avoids aliasing. 0 = a point.
Rgb SurfaceColor(const Mesh& mesh, std::uint32_t triangle, const Eigen::Vector2d& barycentric,
                 double footprint);

/// Color of a point that the procedural pattern alone covers, before lighting.
/// @param base       The color of the material.
/// @param p_W        The point where the pattern is fixed: for a part that moves, where the point rests.
Rgb PatternedColor(const Rgb& base, const Eigen::Vector3d& p_W, double footprint);

/// Bilinear interpolation; the texture repeats beyond its edges.
/// @param uv  (0, 0) is the image's lower left corner, as in OBJ.
Eigen::Vector3d SampleTexture(const Texture& texture, const Eigen::Vector2d& uv);

/// A gray pattern that is fixed in W. It sums value noise with cells from 4 mm to 0.4 m, so that a camera
/// finds detail at any distance from 0.5 to 5 m. Its mean is about 0; its values lie within [-1, 1].
double ProceduralPattern(const Eigen::Vector3d& p_W, double footprint);

}  // namespace thalweg::simulator
