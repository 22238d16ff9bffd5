#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/point_cloud.h"

namespace thalweg::simulator {

/// An image that is laid over triangles; rows from the top, repeated beyond its edges.
struct Texture {
  int width_px = 0;
  int height_px = 0;
  std::vector<Rgb> pixels;
};

struct Material {
  Rgb diffuse{200, 200, 200};
  int texture = -1;  ///< Into Mesh::textures; -1 = none: the simulator paints a procedural one.
};

/// Triangles in W, metres.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<Eigen::Vector2f, 3>> uvs;  ///< A triangle's corners; empty, or one a triangle.
  std::vector<int> materials;                       ///< A triangle's material; -1 = none.
  std::vector<Material> material_table;
  std::vector<Texture> textures;
};

}  // namespace thalweg::simulator
