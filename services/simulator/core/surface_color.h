#pragma once

#include <Eigen/Core>

#include "services/simulator/core/mesh.h"

namespace thalweg::simulator {

/// The image that lies over a triangle, or nullptr.
const Texture* TextureOf(const Mesh& mesh, std::uint32_t triangle);

/// Colour of a triangle at a place, before light.
/// @param barycentric  Weights of corners 1 and 2.
/// @param footprint    [m] Size of what is looked at, e.g. a pixel's on the surface: finer detail of the
///                     procedural pattern fades out. 0 = a point.
Rgb SurfaceColor(const Mesh& mesh, std::uint32_t triangle, const Eigen::Vector2d& barycentric,
                 double footprint);

/// Bilinear, repeated beyond the edges. @param uv  (0, 0) is the image's lower left corner, as in OBJ.
Eigen::Vector3d SampleTexture(const Texture& texture, const Eigen::Vector2d& uv);

/// A grey pattern in W that is the same from everywhere: sums value noise of cells from 4 mm to 0.4 m, so
/// that it has detail for a camera at 0.5 to 5 m. About 0 on average, within [-1, 1].
double ProceduralPattern(const Eigen::Vector3d& p_W, double footprint);

}  // namespace thalweg::simulator
