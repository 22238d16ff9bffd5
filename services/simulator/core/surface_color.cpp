#include "services/simulator/core/surface_color.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/simd.h"

namespace thalweg::simulator {
namespace {

// Cell sizes of the pattern [m]; none is a multiple of another one or of a usual voxel size.
constexpr std::array<double, 5> kCells = {0.0041, 0.013, 0.041, 0.13, 0.41};
constexpr double kPatternContrast = 0.55;  // largest share of the color that the pattern takes away
constexpr double kLeastAlbedo = 0.1;       // so that the pattern shows on black surfaces, too

/// The eight corners of a cell, x fastest, then y, then z.
using Corners = std::array<double, 8>;

/// Hashes the corners of a lattice cell, given by its lowest corner, to repeatable values in [-1, 1]
/// [Jarzynski, Olano: Hash Functions for GPU Rendering, JCGT 9(3), 2020: the mixing of pcg3d, first
/// component].
inline Corners LatticeValues(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  constexpr std::uint32_t kFactor = 1664525U;
  constexpr std::uint32_t kOffset = 1013904223U;
  alignas(32) std::array<std::uint32_t, 8> a, b, c;
  for (unsigned corner = 0; corner < 8; ++corner) {
    a[corner] = (x + (corner & 1U)) * kFactor + kOffset;
    b[corner] = (y + (corner >> 1U & 1U)) * kFactor + kOffset;
    c[corner] = (z + (corner >> 2U)) * kFactor + kOffset;
    a[corner] += b[corner] * c[corner];
    b[corner] += c[corner] * a[corner];
    c[corner] += a[corner] * b[corner];
    a[corner] ^= a[corner] >> 16U;
    b[corner] ^= b[corner] >> 16U;
    c[corner] ^= c[corner] >> 16U;
    a[corner] += b[corner] * c[corner];
  }
  Corners values;
  for (unsigned corner = 0; corner < 8; ++corner) {
    // All 24 bits are exact in a signed integer, which converts to double faster than an unsigned one.
    values[corner] =
        static_cast<double>(static_cast<std::int32_t>(a[corner] >> 8U)) * (2.0 / 16777215.0) - 1.0;
  }
  return values;
}

inline double ValueNoise(double x, double y, double z) {
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double x_low = std::floor(x);
  const double y_low = std::floor(y);
  const double z_low = std::floor(z);
  const double sx = smooth(x - x_low);
  const double sy = smooth(y - y_low);
  const double sz = smooth(z - z_low);
  const auto cell = [](double low) { return static_cast<std::uint32_t>(static_cast<std::int64_t>(low)); };
  const Corners values = LatticeValues(cell(x_low), cell(y_low), cell(z_low));
  double sum = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const double weight =
        (corner & 1U ? sx : 1.0 - sx) * (corner >> 1U & 1U ? sy : 1.0 - sy) * (corner >> 2U ? sz : 1.0 - sz);
    sum += weight * values[corner];
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

THALWEG_SIMD_CLONES
double ProceduralPattern(const Eigen::Vector3d& p_W, double footprint) {
  double sum = 0.0;
  double total = 0.0;
  for (const double cell : kCells) {
    const double visible = footprint > 0.0 ? std::clamp(cell / footprint - 1.0, 0.0, 1.0) : 1.0;
    total += 1.0;
    // The offset keeps surfaces at round coordinates from lying in a plane of lattice corners.
    if (visible > 0.0) {
      sum += visible * ValueNoise(p_W.x() / cell + 0.37, p_W.y() / cell + 0.61, p_W.z() / cell + 0.23);
    }
  }
  return std::clamp(1.6 * sum / total, -1.0, 1.0);  // a sum of several noises rarely comes near its bounds
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
  return PatternedColor(base, p_W, footprint);
}

Rgb PatternedColor(const Rgb& base, const Eigen::Vector3d& p_W, double footprint) {
  const Eigen::Vector3d albedo =
      Eigen::Vector3d::Constant(255.0 * kLeastAlbedo) + (1.0 - kLeastAlbedo) * ToVector(base);
  const double pattern = 0.5 + 0.5 * ProceduralPattern(p_W, footprint);
  // the pattern only darkens, so that bright surfaces do not clip
  return ToRgb(albedo * (1.0 - kPatternContrast * pattern));
}

}  // namespace thalweg::simulator
