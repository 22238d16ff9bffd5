#include "services/simulator/core/surface_color.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace thalweg::simulator {
namespace {

// Cells of the pattern [m], not multiples of one another nor of a voxel.
constexpr std::array<double, 5> kCells = {0.0041, 0.013, 0.041, 0.13, 0.41};
constexpr double kPatternContrast = 0.55;  // share of the colour that the pattern takes away at most
constexpr double kLeastAlbedo = 0.1;       // so that the pattern shows on black, too

/// A repeatable value in [-1, 1] for a corner of the lattice [Jarzynski, Olano: Hash Functions for GPU
/// Rendering, JCGT 9(3), 2020: pcg3d's mixing, first component].
double LatticeValue(std::int64_t x, std::int64_t y, std::int64_t z) {
  auto a = static_cast<std::uint32_t>(x) * 1664525U + 1013904223U;
  auto b = static_cast<std::uint32_t>(y) * 1664525U + 1013904223U;
  auto c = static_cast<std::uint32_t>(z) * 1664525U + 1013904223U;
  a += b * c;
  b += c * a;
  c += a * b;
  a ^= a >> 16U;
  b ^= b >> 16U;
  c ^= c >> 16U;
  a += b * c;
  return static_cast<double>(a >> 8U) * (2.0 / 16777215.0) - 1.0;
}

double ValueNoise(const Eigen::Vector3d& p) {
  std::array<std::int64_t, 3> cell{};
  Eigen::Vector3d share;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::floor(p[axis]);
    cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(low);
    const double t = p[axis] - low;
    share[axis] = t * t * (3.0 - 2.0 * t);
  }
  double sum = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const unsigned x = corner & 1U;
    const unsigned y = (corner >> 1U) & 1U;
    const unsigned z = corner >> 2U;
    const double weight = (x ? share.x() : 1.0 - share.x()) * (y ? share.y() : 1.0 - share.y()) *
                          (z ? share.z() : 1.0 - share.z());
    sum += weight * LatticeValue(cell[0] + x, cell[1] + y, cell[2] + z);
  }
  return sum;
}

Eigen::Vector3d ToVector(const Rgb& color) {
  return {double(color.r), double(color.g), double(color.b)};
}

Rgb ToRgb(const Eigen::Vector3d& color) {
  const auto channel = [](double value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  };
  return {channel(color.x()), channel(color.y()), channel(color.z())};
}

template <class Corner>
Corner Blend(const Corner& a, const Corner& b, const Corner& c, const Eigen::Vector2d& weights) {
  return (1.0 - weights.x() - weights.y()) * a + weights.x() * b + weights.y() * c;
}

}  // namespace

double ProceduralPattern(const Eigen::Vector3d& p_W, double footprint) {
  double sum = 0.0;
  double total = 0.0;
  for (const double cell : kCells) {
    const double visible = footprint > 0.0 ? std::clamp(cell / footprint - 1.0, 0.0, 1.0) : 1.0;
    total += 1.0;
    // Offset, so that surfaces at round coordinates do not lie in a plane of lattice corners.
    if (visible > 0.0) sum += visible * ValueNoise(p_W / cell + Eigen::Vector3d(0.37, 0.61, 0.23));
  }
  return std::clamp(1.6 * sum / total, -1.0, 1.0);  // a sum of few noises seldom nears its bounds
}

Eigen::Vector3d SampleTexture(const Texture& texture, const Eigen::Vector2d& uv) {
  const double u = uv.x() * texture.width_px - 0.5;
  const double v = (1.0 - uv.y()) * texture.height_px - 0.5;
  const double u_low = std::floor(u);
  const double v_low = std::floor(v);
  const auto pixel = [&](double column, double row) {
    const auto wrap = [](double value, int size) {
      return static_cast<std::size_t>(value - size * std::floor(value / size)) %
             static_cast<std::size_t>(size);
    };
    return ToVector(texture.pixels[wrap(row, texture.height_px) * static_cast<std::size_t>(texture.width_px) +
                                   wrap(column, texture.width_px)]);
  };
  const double s = u - u_low;
  const double t = v - v_low;
  return (1.0 - t) * ((1.0 - s) * pixel(u_low, v_low) + s * pixel(u_low + 1.0, v_low)) +
         t * ((1.0 - s) * pixel(u_low, v_low + 1.0) + s * pixel(u_low + 1.0, v_low + 1.0));
}

const Texture* TextureOf(const Mesh& mesh, std::uint32_t triangle) {
  const int material = mesh.materials.empty() ? -1 : mesh.materials[triangle];
  if (material < 0 || mesh.uvs.empty()) return nullptr;
  const int texture = mesh.material_table[static_cast<std::size_t>(material)].texture;
  return texture < 0 ? nullptr : &mesh.textures[static_cast<std::size_t>(texture)];
}

Rgb SurfaceColor(const Mesh& mesh, std::uint32_t triangle, const Eigen::Vector2d& barycentric,
                 double footprint) {
  if (const Texture* texture = TextureOf(mesh, triangle)) {
    const auto& [a, b, c] = mesh.uvs[triangle];
    const Eigen::Vector2d uv =
        Blend<Eigen::Vector2d>(a.cast<double>(), b.cast<double>(), c.cast<double>(), barycentric);
    return ToRgb(SampleTexture(*texture, uv));
  }
  const int index = mesh.materials.empty() ? -1 : mesh.materials[triangle];
  const Rgb base =
      index < 0 ? Material{}.diffuse : mesh.material_table[static_cast<std::size_t>(index)].diffuse;
  const auto& corners = mesh.triangles[triangle];
  const Eigen::Vector3d p_W = Blend<Eigen::Vector3d>(mesh.vertices[corners[0]].cast<double>(),
                                                     mesh.vertices[corners[1]].cast<double>(),
                                                     mesh.vertices[corners[2]].cast<double>(), barycentric);
  const Eigen::Vector3d albedo =
      Eigen::Vector3d::Constant(255.0 * kLeastAlbedo) + (1.0 - kLeastAlbedo) * ToVector(base);
  const double pattern = 0.5 + 0.5 * ProceduralPattern(p_W, footprint);
  return ToRgb(albedo * (1.0 - kPatternContrast * pattern));  // only darkens: bright surfaces do not clip
}

}  // namespace thalweg::simulator
