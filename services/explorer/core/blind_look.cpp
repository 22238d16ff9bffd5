#include "services/explorer/core/blind_look.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace thalweg::explorer {
namespace {

/// [rad] At which it looks around, one after the other.
std::vector<double> ElevationsOf(const RobotModel& robot) {
  constexpr double kSlope = 0.25 * std::numbers::pi;
  constexpr double kOther = 0.2;  // from any before
  if (robot.level()) return {0.0};
  if (!robot.gimballed()) return {0.0, kSlope, -kSlope};
  std::vector<double> elevations = {robot.PitchWithin(0.0)};
  for (const double elevation :
       {robot.PitchWithin(kSlope), robot.PitchWithin(-kSlope), robot.gimbal_highest, robot.gimbal_lowest}) {
    if (std::ranges::all_of(elevations, [&](double its) { return std::abs(its - elevation) > kOther; }))
      elevations.push_back(elevation);
  }
  return elevations;
}

}  // namespace

std::optional<Eigen::Matrix3d> BlindLook::Next(const Eigen::Matrix3d& R_WB, const RobotModel& robot) {
  constexpr std::size_t kHeadings = 6;
  const std::vector<double> elevations = ElevationsOf(robot);
  const std::size_t round = looks_ / kHeadings;
  if (round >= elevations.size()) return std::nullopt;
  ++looks_;
  return RotationFromYawPitch(YawOf(R_WB) + 2.0 * std::numbers::pi / kHeadings, elevations[round]);
}

}  // namespace thalweg::explorer
