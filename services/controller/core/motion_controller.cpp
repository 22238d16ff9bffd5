#include "services/controller/core/motion_controller.h"

namespace thalweg::controller {

MotionCommand MotionCommand::Leveled() const {
  const RigidTransform level = thalweg::Leveled(T_WB_of_velocities);
  const Eigen::Matrix3d R_LB = level.linear().transpose() * T_WB_of_velocities.linear();
  return {.T_WB = T_WB, .v_WB_B = R_LB * v_WB_B, .w_WB_B = R_LB * w_WB_B, .T_WB_of_velocities = level};
}

}  // namespace thalweg::controller
