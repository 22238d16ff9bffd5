#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "common/voxel/voxel_index.h"

namespace thalweg {

/// Steps through the voxels that a straight segment crosses, in order, including the first and the last.
///
/// Incremental traversal [Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics
/// 1987]. Where the segment passes exactly through an edge or corner, one axis is stepped before the other,
/// so that consecutive voxels are always face neighbors.
class VoxelRay {
 public:
  VoxelRay(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double voxel_size);

  const VoxelIndex& voxel() const { return voxel_; }
  bool at_end() const { return steps_left_ == 0; }
  void Step() {
    const int axis = t_next_[0] < t_next_[1] ? (t_next_[0] < t_next_[2] ? 0 : 2)  //
                                             : (t_next_[1] < t_next_[2] ? 1 : 2);
    if (axis == 0) voxel_.x += step_[0];
    if (axis == 1) voxel_.y += step_[1];
    if (axis == 2) voxel_.z += step_[2];
    // An axis that has reached the last voxel's layer is not stepped again, whatever the rounding.
    t_next_[axis] =
        --left_[axis] == 0 ? std::numeric_limits<double>::infinity() : t_next_[axis] + t_step_[axis];
    --steps_left_;
  }

 private:
  VoxelIndex voxel_;
  int step_[3] = {0, 0, 0};
  int left_[3] = {0, 0, 0};
  double t_next_[3] = {0, 0, 0};  ///< Fraction of the segment at the next crossing of each axis.
  double t_step_[3] = {0, 0, 0};
  int steps_left_ = 0;
};

/// Calls visit(voxel) -> bool for each voxel from `from` to `to`. Stops and returns false when visit does.
template <class Visitor>
bool TraverseVoxels(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double voxel_size,
                    Visitor&& visit) {
  for (VoxelRay ray(from, to, voxel_size);; ray.Step()) {
    if (!visit(ray.voxel())) return false;
    if (ray.at_end()) return true;
  }
}

}  // namespace thalweg
