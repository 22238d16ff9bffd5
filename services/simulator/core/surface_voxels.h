#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/voxel/dense_grid.h"
#include "services/simulator/core/mesh.h"

namespace thalweg::simulator {

inline constexpr double kTouchTolerance = 1e-4;  ///< [m] Cuts that are less deep leave a voxel's class open.

/// Classifies the voxels of a box by whether the triangles of a mesh cut them.
class SurfaceVoxels {
 public:
  enum class Kind : std::uint8_t {
    kNone,
    kTouched,  ///< Cut less deep than the tolerance, or missed by less than it.
    kCut,
  };

  /// @param tolerance  [m] Least overlap that counts as a cut, see OverlapDepth.
  SurfaceVoxels(const Mesh& mesh, const VoxelBox& box, double voxel_size, double tolerance);

  Kind KindOf(std::size_t offset) const { return kinds_[offset]; }
  const DenseGrid<Kind>& kinds() const { return kinds_; }
  /// The triangles that cut the voxel at `offset`, which must be of kind kCut.
  const std::vector<std::uint32_t>& TrianglesAt(std::size_t offset) const { return triangles_.at(offset); }

 private:
  DenseGrid<Kind> kinds_;
  std::unordered_map<std::size_t, std::vector<std::uint32_t>> triangles_;
};

/// The cube [m] that a voxel fills.
inline Eigen::AlignedBox3d BoxOf(const VoxelIndex& i, double voxel_size) {
  const Eigen::Vector3d low(i.x * voxel_size, i.y * voxel_size, i.z * voxel_size);
  return {low, low + Eigen::Vector3d::Constant(voxel_size)};
}

}  // namespace thalweg::simulator
