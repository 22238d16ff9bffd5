#include "services/simulator/core/swept_voxels.h"

#include <cmath>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/voxels_within.h"

namespace thalweg::simulator {
namespace {

/// A box that may be turned about the vertical axis.
class TurnedBox {
 public:
  TurnedBox(const Eigen::AlignedBox3d& box_P, const RigidTransform& T_WP)
      : box_P_(box_P),
        T_PW_(T_WP.inverse()),
        center_W_(T_WP * box_P.center()),
        half_W_(0.5 * (T_WP.linear().cwiseAbs() * box_P.sizes())) {}

  Eigen::AlignedBox3d Extent() const { return {center_W_ - half_W_, center_W_ + half_W_}; }
  /// Whether it overlaps a cube that overlaps its extent: no side of the box has all of the cube before it.
  bool Overlaps(const Eigen::Vector3d& cube_center_W, double edge) const {
    const Eigen::Vector3d offset_P = T_PW_ * cube_center_W - box_P_.center();
    const Eigen::Vector3d reach_P = 0.5 * edge * T_PW_.linear().cwiseAbs().rowwise().sum();
    return (offset_P.cwiseAbs().array() <= (reach_P + 0.5 * box_P_.sizes()).array()).all();
  }

 private:
  Eigen::AlignedBox3d box_P_;
  RigidTransform T_PW_;
  Eigen::Vector3d center_W_;
  Eigen::Vector3d half_W_;
};

VoxelBox Common(const VoxelBox& a, const VoxelBox& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
}

}  // namespace

DenseGrid<std::uint8_t> SweptVoxels(std::span<const MovingPart> parts, const VoxelBox& box,
                                    double voxel_size) {
  DenseGrid<std::uint8_t> swept(box, 0);
  const double margin = voxel_size / 8.0;
  for (const MovingPart& part : parts) {
    Eigen::AlignedBox3d grown = part.at_rest_W;  // covers what lies between two poses
    grown.min().array() -= margin;
    grown.max().array() += margin;
    VisitPoses(part, margin, [&](const RigidTransform& T_WP) {
      const TurnedBox there(grown, T_WP);
      ForEachVoxel(Common(VoxelsWithin(there.Extent(), voxel_size), box), [&](const VoxelIndex& voxel) {
        if (there.Overlaps(VoxelCenter(voxel, voxel_size), voxel_size)) swept[voxel] = 1;
      });
    });
  }
  return swept;
}

}  // namespace thalweg::simulator
