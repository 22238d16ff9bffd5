#include "common/voxel/ray.h"

#include <cstdlib>

namespace thalweg {

VoxelRay::VoxelRay(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double voxel_size)
    : voxel_(VoxelAt(from, voxel_size)) {
  const VoxelIndex last = VoxelAt(to, voxel_size);
  const VoxelIndex delta = last - voxel_;
  const int deltas[3] = {delta.x, delta.y, delta.z};
  const int first[3] = {voxel_.x, voxel_.y, voxel_.z};
  for (int axis = 0; axis < 3; ++axis) {
    left_[axis] = std::abs(deltas[axis]);
    steps_left_ += left_[axis];
    if (left_[axis] == 0) {
      t_next_[axis] = std::numeric_limits<double>::infinity();
      continue;
    }
    step_[axis] = deltas[axis] > 0 ? 1 : -1;
    const double length = to[axis] - from[axis];
    const double boundary = (first[axis] + (step_[axis] > 0 ? 1 : 0)) * voxel_size;
    t_next_[axis] = (boundary - from[axis]) / length;
    t_step_[axis] = voxel_size / std::abs(length);
  }
}

}  // namespace thalweg
