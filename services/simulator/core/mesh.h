#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/point_cloud.h"
#include "common/geometry/triangle.h"

namespace thalweg::simulator {

/// An image laid over triangles; rows run from the top, and the image repeats beyond its edges.
struct Texture {
  int width_px = 0;
  int height_px = 0;
  std::vector<Rgb> pixels;
};

struct Material {
  Rgb diffuse{200, 200, 200};
  int texture = -1;  ///< Index into Mesh::textures; -1 = none, which gets a procedural pattern.
};

/// Triangles in W, in meters.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<Eigen::Vector2f, 3>> uvs;  ///< Per triangle, of its corners; may be empty.
  std::vector<int> materials;                       ///< Per triangle, index into material_table; -1 = none.
  std::vector<Material> material_table;
  std::vector<Texture> textures;
};

inline Triangle TriangleOf(const Mesh& mesh, std::uint32_t index) {
  const auto& corners = mesh.triangles[index];
  return {mesh.vertices[corners[0]].cast<double>(), mesh.vertices[corners[1]].cast<double>(),
          mesh.vertices[corners[2]].cast<double>()};
}

}  // namespace thalweg::simulator
