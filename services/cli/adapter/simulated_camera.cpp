#include "services/cli/adapter/simulated_camera.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "common/scenario/models.h"
#include "services/evaluator/adapter/stereo_options.h"
#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::cli {
namespace {

/// Throws as LoadScenario and StereoSensorFrom do.
evaluator::StereoSensor::Options ColorSensorFrom(const Scenario& scenario) {
  evaluator::StereoSensor::Options options = evaluator::StereoSensorFrom(scenario);
  options.rig.color = true;
  options.matcher.threads = stereo::MatcherOptions{}.threads;  // nothing runs beside it
  return options;
}

}  // namespace

SimulatedCamera::SimulatedCamera(const std::string& scenario, const std::vector<std::string>& overrides,
                                 bool exact)
    : scenario_(LoadScenario(scenario, overrides)),
      robot_(RobotFrom(scenario_)),
      world_(simulator::LoadWorld(scenario_)),
      sensor_(ColorSensorFrom(scenario_), 1),
      exact_(exact) {}

RigidTransform SimulatedCamera::StartPose() const {
  return simulator::StartFrom(scenario_, world_, robot_) * robot_.T_BC;
}

surface::View SimulatedCamera::Look(const RigidTransform& T_WC) {
  simulator::StereoPair pair = sensor_.Render(world_, T_WC);
  const StereoGeometry geometry = sensor_.geometry();
  surface::View view{.rig = geometry, .disparities = {}, .colors = {}, .T_WC = T_WC};
  const std::vector<std::uint8_t>& colors = pair.left.data;
  for (std::size_t i = 0; i < colors.size(); i += 3)
    view.colors.push_back({colors[i], colors[i + 1], colors[i + 2]});
  const auto farthest = static_cast<float>(stereo::FarthestDepth(geometry, sensor_.options().triangulation));
  if (exact_) {
    for (float& z : pair.depth) {
      if (z > farthest) z = std::numeric_limits<float>::quiet_NaN();
    }
    view.disparities = surface::DisparitiesOf(
        {geometry.camera.width_px, geometry.camera.height_px, std::move(pair.depth)}, geometry);
    return view;
  }
  view.disparities = std::move(sensor_.Match(std::move(pair)).disparity.data());
  const auto least = static_cast<float>(geometry.camera.fx * geometry.baseline) / farthest;
  for (float& d : view.disparities) {
    if (d < least) d = stereo::kNoDisparity;
  }
  return view;
}

std::optional<Error> SimulatedCamera::WhyNotAt(const RigidTransform& T_WC) const {
  const Eigen::Vector3d p_W = (T_WC * robot_.T_BC.inverse()).translation();
  if (world_.ClearanceOf(robot_, p_W, robot_.radius) <= 0.0) return Error{"the robot would touch a surface"};
  if (!world_.bounds().contains(p_W)) return Error{"it is outside of the world"};
  return std::nullopt;
}

Result<surface::View> SimulatedCamera::LookFromAbove(const RigidTransform& T_WC,
                                                     const Eigen::Vector3d& above_W) {
  constexpr double kTolerance = 0.1;  // [m] that a matched point may lie behind its surface
  if (std::optional<Error> error = WhyNotAt(T_WC)) return *std::move(error);
  const Eigen::Vector3d p_W = T_WC.translation();
  const double distance = (above_W - p_W).norm();
  const auto hit = world_.CastRay(p_W, (above_W - p_W) / distance, distance);
  if (hit && hit->distance < distance - kTolerance) {
    return Error{fmt::format("a surface stands between it and its point of the path, {:.2f} of {:.2f} m away",
                             hit->distance, distance)};
  }
  return Look(T_WC);
}

}  // namespace thalweg::cli
