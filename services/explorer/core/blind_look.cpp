#include "services/explorer/core/blind_look.h"

#include <iterator>
#include <numbers>

namespace thalweg::explorer {

std::optional<Eigen::Matrix3d> BlindLook::Next(const Eigen::Matrix3d& R_WB, const RobotModel& robot) {
  constexpr std::size_t kHeadings = 6;
  constexpr double kElevations[] = {0.0, 0.25 * std::numbers::pi, -0.25 * std::numbers::pi};
  const std::size_t round = looks_ / kHeadings;
  if (round == (robot.level() ? 1 : std::size(kElevations))) return std::nullopt;
  ++looks_;
  return RotationFromYawPitch(YawOf(R_WB) + 2.0 * std::numbers::pi / kHeadings,
                              robot.PitchWithin(kElevations[round]));
}

}  // namespace thalweg::explorer
