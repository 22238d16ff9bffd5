#pragma once

#include <cmath>
#include <numbers>

#include "services/simulator/core/mesh.h"
#include "tests/support/analytic_room.h"

namespace thalweg::test {

/// Adds the rectangle p, p + a, p + a + b, p + b, with texture coordinates from (0, 0) at p to (1, 1).
inline void AddQuad(simulator::Mesh& mesh, const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                    const Eigen::Vector3d& b, int material = -1) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3d& corner :
       {p, Eigen::Vector3d(p + a), Eigen::Vector3d(p + a + b), Eigen::Vector3d(p + b)}) {
    mesh.vertices.push_back(corner.cast<float>());
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.uvs.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 0), Eigen::Vector2f(1, 1)});
  mesh.uvs.push_back({Eigen::Vector2f(0, 0), Eigen::Vector2f(1, 1), Eigen::Vector2f(0, 1)});
  mesh.materials.insert(mesh.materials.end(), 2, material);
}

/// Adds the six sides of a box.
inline void AddBox(simulator::Mesh& mesh, const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d x = box.sizes().x() * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = box.sizes().y() * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = box.sizes().z() * Eigen::Vector3d::UnitZ();
  for (const Eigen::Vector3d& low : {box.min(), Eigen::Vector3d(box.min() + z)}) AddQuad(mesh, low, x, y);
  for (const Eigen::Vector3d& low : {box.min(), Eigen::Vector3d(box.min() + y)}) AddQuad(mesh, low, x, z);
  for (const Eigen::Vector3d& low : {box.min(), Eigen::Vector3d(box.min() + x)}) AddQuad(mesh, low, y, z);
}

inline simulator::Mesh BoxMesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  simulator::Mesh mesh;
  AddBox(mesh, {low, high});
  return mesh;
}

/// The surfaces of an analytic room as a mesh.
inline simulator::Mesh MeshOf(const AnalyticRoom& room) {
  simulator::Mesh mesh;
  AddBox(mesh, room.walls);
  for (const Eigen::AlignedBox3d& box : room.boxes) AddBox(mesh, box);
  return mesh;
}

/// A sphere of `rings` by 2 `rings` facets with all vertices on it: its surface lies at most radius * (1 -
/// cos(pi / rings)) below the true one.
inline simulator::Mesh SphereMesh(const Eigen::Vector3d& center, double radius, int rings) {
  simulator::Mesh mesh;
  const int columns = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double polar = std::numbers::pi * i / rings;
      const double azimuth = std::numbers::pi * j / rings;
      const Eigen::Vector3d direction(std::sin(polar) * std::cos(azimuth),
                                      std::sin(polar) * std::sin(azimuth), std::cos(polar));
      mesh.vertices.push_back((center + radius * direction).cast<float>());
    }
  }
  const auto corner = [&](int i, int j) { return static_cast<std::uint32_t>(i * columns + j % columns); };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      mesh.triangles.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
      mesh.triangles.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
    }
  }
  return mesh;
}

inline Eigen::Vector3d RandomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal(0.0, 1.0);
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

}  // namespace thalweg::test
