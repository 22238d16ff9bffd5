#include "common/scenario/models.h"

#include <cmath>

#include "common/scenario/option_binding.h"

namespace thalweg {

void Visit(OptionVisitor& visitor, RobotModel& robot) {
  visitor.Number("radius_m", robot.radius);
  visitor.Number("height_m", robot.height);
  visitor.Choice("attitude", robot.attitude,
                 {{"FREE", Attitude::kFree}, {"LEVEL", Attitude::kLevel}, {"GIMBAL", Attitude::kGimbal}});
  visitor.Switch("drives", robot.drives);
  visitor.Choice("drive", robot.drive,
                 {{"OMNI", Drive::kOmni},
                  {"DIFFERENTIAL", Drive::kDifferential},
                  {"ACKERMANN", Drive::kAckermann}});
  visitor.Number("min_turning_radius_m", robot.min_turning_radius);
  visitor.Number("max_speed_mps", robot.max_speed);
  visitor.Number("max_acceleration_mps2", robot.max_acceleration);
  visitor.Number("max_jerk_mps3", robot.max_jerk);
  visitor.Degrees("max_turn_rate_dps", robot.max_turn_rate);
  visitor.Degrees("max_turn_acceleration_dps2", robot.max_turn_acceleration);
  visitor.Degrees("gimbal_min_pitch_deg", robot.gimbal_lowest);
  visitor.Degrees("gimbal_max_pitch_deg", robot.gimbal_highest);
  visitor.Degrees("max_gimbal_rate_dps", robot.max_gimbal_rate);
  Eigen::Vector3d p_B = robot.T_BC.translation();
  if (visitor.Vector("camera_position_m", p_B)) robot.T_BC.translation() = p_B;
  const Eigen::Vector3d ahead_B = robot.T_BC.linear() * Eigen::Vector3d::UnitZ();
  double pitch = std::asin(ahead_B.z());
  if (visitor.Degrees("camera_pitch_deg", pitch)) {
    robot.T_BC.linear() = RotationFromYawPitch(0.0, pitch) * BodyFromOptical();
  }
}

void Visit(OptionVisitor& visitor, PinholeCamera& camera) {
  int width = camera.width_px;
  int height = camera.height_px;
  double field_of_view = 2.0 * std::atan(0.5 * camera.width_px / camera.fx);
  visitor.Whole("width_px", width);
  visitor.Whole("height_px", height);
  visitor.Degrees("horizontal_fov_deg", field_of_view);
  camera = PinholeCamera::FromFieldOfView(width, height, field_of_view);
}

void Visit(OptionVisitor& visitor, DepthSensorModel& sensor) {
  Visit(visitor, sensor.camera);
  visitor.Number("rate_hz", sensor.rate);
  visitor.Number("max_range_m", sensor.max_range);
  visitor.Number("disparity_noise_px", sensor.disparity_noise_px);
  visitor.Number("image_noise_px", sensor.image_noise_px);
  visitor.Number("baseline_m", sensor.baseline);
  visitor.Switch("no_return_is_free", sensor.no_return_is_free);
}

void Visit(OptionVisitor& visitor, MapModel& map) {
  visitor.Number("voxel_size_m", map.voxel_size);
  visitor.Number("max_range_m", map.max_range);
  visitor.Block("filter", [&](OptionVisitor& filter) {
    using Type = FilterModel::Type;
    filter.Choice("type", map.filter.type,
                  {{"NONE", Type::kNone},
                   {"DISTANCE", Type::kDistance},
                   {"VOXEL", Type::kVoxel},
                   {"OUTLIER", Type::kOutlier}});
    filter.Number("max_distance_m", map.filter.max_distance);
    filter.Number("cell_m", map.filter.cell);
    filter.Whole("neighbors", map.filter.neighbors);
    filter.Number("deviations", map.filter.deviations);
  });
}

void Visit(OptionVisitor& visitor, DepthErrorModel& error) {
  visitor.Number("depth_error_per_m", error.sigma);
  visitor.Whole("smooth_window_px", error.window_px);
}

RobotModel RobotFrom(const Scenario& scenario) {
  return ReadOptions<RobotModel>(scenario.robot());
}

DepthSensorModel DepthSensorFrom(const Scenario& scenario) {
  return ReadOptions<DepthSensorModel>(scenario.depth_sensor());
}

MapModel MapFrom(const Scenario& scenario) {
  return ReadOptions<MapModel>(scenario.mapper());
}

DepthErrorModel DepthErrorFrom(const Scenario& scenario) {
  DepthErrorModel error;
  if (scenario.depth_source() != DepthSource::STEREO) {
    const DepthSensorModel sensor = DepthSensorFrom(scenario);
    error.sigma =
        std::hypot(sensor.disparity_noise_px, sensor.image_noise_px) / (sensor.camera.fx * sensor.baseline);
  }
  ReadOptions(scenario.mapper(), error);
  return error;
}

Eigen::Vector3d ToEigen(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

std::vector<Eigen::AlignedBox3d> NoGoFrom(const Scenario& scenario) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Box& box : scenario.world().no_go())
    boxes.emplace_back(ToEigen(box.min_m()), ToEigen(box.max_m()));
  return boxes;
}

}  // namespace thalweg
