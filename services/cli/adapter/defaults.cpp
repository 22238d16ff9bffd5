#include "services/cli/adapter/defaults.h"

#include <google/protobuf/text_format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <sstream>

#include "common/base/check.h"
#include "common/dds/bus.h"
#include "services/controller/adapter/options.h"
#include "services/explorer/adapter/options.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/options.h"
#include "services/stereo/adapter/options.h"
#include "services/visual_odometry/adapter/options.h"

namespace thalweg::cli {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// To seven digits: the decimal that was meant, before it became a float or radians.
double Plain(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.7g", value);
  return std::strtod(text.data(), nullptr);
}

double FieldOfView(const PinholeCamera& camera) {
  return 2.0 * std::atan(0.5 * camera.width_px / camera.fx) * kDegrees;
}

/// One message of a scenario, of which what is absent is to be filled in.
class Absent {
 public:
  explicit Absent(Message& message) : message_(message), reflection_(*message.GetReflection()) {}

  void Number(const char* name, double value) {
    if (const FieldDescriptor* const field = Missing(name)) {
      reflection_.SetDouble(&message_, field, Plain(value));
    }
  }
  void Whole(const char* name, std::int64_t value) {
    if (const FieldDescriptor* const field = Missing(name)) {
      reflection_.SetInt32(&message_, field, static_cast<std::int32_t>(value));
    }
  }
  void Switch(const char* name, bool value) {
    if (const FieldDescriptor* const field = Missing(name)) reflection_.SetBool(&message_, field, value);
  }
  /// The number of an enum's value, which core and scenario share.
  void Choice(const char* name, int value) {
    if (const FieldDescriptor* const field = Missing(name)) reflection_.SetEnumValue(&message_, field, value);
  }
  void Text(const char* name, const std::string& value) {
    if (const FieldDescriptor* const field = Missing(name)) reflection_.SetString(&message_, field, value);
  }

 private:
  const FieldDescriptor* Missing(const char* name) const {
    const FieldDescriptor* const field = message_.GetDescriptor()->FindFieldByName(name);
    THALWEG_CHECK(field != nullptr);
    return reflection_.HasField(message_, field) ? nullptr : field;
  }

  Message& message_;
  const Reflection& reflection_;
};

void FillNetwork(Network& network) {
  const dds::BusOptions options;
  Absent absent(network);
  absent.Whole("domain", options.domain);
  absent.Switch("shared_memory", options.shared_memory);
  absent.Whole("segment_mb", options.segment_mb);
  absent.Text("network_interface", options.network_interface);
  absent.Text("discovery_server", options.discovery_server);
  absent.Switch("wall_clock", Network().wall_clock());
}

void FillRobot(Robot& robot) {
  const RobotModel model;
  Absent absent(robot);
  absent.Number("radius_m", model.radius);
  absent.Number("height_m", model.height);
  absent.Switch("drives", model.drives);
  absent.Number("max_speed_mps", model.max_speed);
  absent.Number("max_acceleration_mps2", model.max_acceleration);
  absent.Number("max_turn_rate_dps", model.max_turn_rate * kDegrees);
  if (!robot.has_camera_position_m()) {
    const Eigen::Vector3d position = model.T_BC.translation();
    robot.mutable_camera_position_m()->set_x(position.x());
    robot.mutable_camera_position_m()->set_y(position.y());
    robot.mutable_camera_position_m()->set_z(position.z());
  }
  const Eigen::Vector3d ahead_B = model.T_BC.linear() * Eigen::Vector3d::UnitZ();
  absent.Number("camera_pitch_deg", std::asin(ahead_B.z()) * kDegrees);
}

/// What both kinds of camera have.
void FillCamera(Absent& absent, const PinholeCamera& camera, double baseline, double rate) {
  absent.Whole("width_px", camera.width_px);
  absent.Whole("height_px", camera.height_px);
  absent.Number("horizontal_fov_deg", FieldOfView(camera));
  absent.Number("baseline_m", baseline);
  absent.Number("rate_hz", rate);
}

void FillCameras(DepthSensor& depth_sensor, StereoCamera& stereo_camera) {
  const DepthSensorModel depth;
  Absent absent_depth(depth_sensor);
  FillCamera(absent_depth, depth.camera, depth.baseline, depth.rate);
  absent_depth.Number("max_range_m", depth.max_range);
  absent_depth.Number("disparity_noise_px", depth.disparity_noise_px);
  absent_depth.Switch("enabled", true);
  absent_depth.Switch("no_return_is_free", depth.no_return_is_free);

  const simulator::StereoRigModel stereo;
  Absent absent_stereo(stereo_camera);
  absent_stereo.Switch("enabled", simulator::SimulatorOptions().stereo_camera.has_value());
  FillCamera(absent_stereo, stereo.camera, stereo.baseline, stereo.rate);
  absent_stereo.Number("noise_sigma", stereo.noise_sigma);
}

void FillSimulator(World& world, Simulator& given) {
  if (!world.has_up_axis()) world.set_up_axis(World().up_axis());
  Absent(world).Number("scale", simulator::kUnscaled);
  const simulator::SimulatorOptions options;
  Absent absent(given);
  absent.Number("time_scale", options.time_scale);
  absent.Number("start_yaw_deg", Simulator().start_yaw_deg());
  absent.Whole("start_seed", Simulator().start_seed());
  absent.Whole("noise_seed", options.noise_seed);
  absent.Number("odometry_rate_hz", options.odometry_rate);
}

void FillMapper(Mapper& given, const DepthErrorModel& depth_error) {
  const mapper::MapperOptions options;
  Absent absent(given);
  absent.Number("voxel_size_m", options.map.voxel_size);
  absent.Number("max_range_m", options.map.max_range);
  absent.Number("min_range_m", options.map.min_range);
  absent.Number("log_odds_hit", options.map.log_odds_hit);
  absent.Number("log_odds_miss", options.map.log_odds_miss);
  absent.Number("log_odds_min", options.map.log_odds_min);
  absent.Number("log_odds_max", options.map.log_odds_max);
  absent.Switch("protect", options.map.protect);
  absent.Switch("fill", options.map.fill);
  absent.Number("fill_max_gap_m", options.map.fill_max_gap);
  absent.Number("checkpoint_period_s", Seconds(options.checkpoint_period));
  absent.Switch("exact_rays", options.map.exact_rays);
  absent.Number("shadow_m", options.map.shadow);
  absent.Number("depth_error_per_m", depth_error.sigma);
  absent.Whole("smooth_window_px", depth_error.window_px);
  absent.Number("min_hit_probability", options.map.min_hit_probability);
}

void FillExplorer(thalweg::Explorer& given, double look_range) {
  const explorer::Explorer::Options options;
  Absent absent(given);
  absent.Text("strategy", options.strategy.name);
  absent.Number("min_cluster_area_m2", options.frontier.min_area);
  absent.Number("cluster_extent_m", options.frontier.extent);
  absent.Number("look_range_m", look_range);
  absent.Whole("looks_before_set_aside", options.memory.looks);
  absent.Number("look_around_min_area_m2", options.look_around_min_area);
  absent.Number("set_aside_expiry_s", Seconds(options.memory.expiry));
  absent.Number("safety_margin_m", options.safety_margin);
  absent.Number("time_budget_s", Seconds(options.time_budget));
  absent.Number("distance_budget_m", options.distance_budget);
  absent.Switch("return_home", options.return_home);
  absent.Number("home_margin", options.home_margin);
  absent.Number("min_measured_share", options.min_measured_share);
  absent.Number("max_missed_share", options.max_missed_share);
  absent.Number("comfort_m", options.comfort.distance);
  absent.Whole("random_seed", options.strategy.seed);
  Absent doubt(*given.mutable_doubt());
  doubt.Number("max_log_odds", options.doubt.max_log_odds);
  doubt.Number("weight", options.doubt.weight);
  Absent potential(*given.mutable_potential());
  potential.Number("source_radius_m", options.strategy.potential.source_radius);
  potential.Number("screening_length_m", options.strategy.potential.screening_length);
  potential.Number("relative_residual", options.strategy.potential.relative_residual);
  potential.Choice("cluster", static_cast<int>(options.strategy.potential.cluster));
  potential.Choice("way", static_cast<int>(options.strategy.potential.way));
  potential.Switch("seal", options.strategy.potential.seal);
  Absent gain(*given.mutable_gain());
  gain.Number("sample_share", options.strategy.gain.sample_share);
  gain.Number("decay_per_m", options.strategy.gain.decay);
  Absent flow(*given.mutable_flow());
  flow.Number("eagerness", options.strategy.flow.eagerness);
  flow.Number("hysteresis", options.strategy.flow.hysteresis);
  flow.Number("sight_worth", options.strategy.flow.sight_worth);
}

void FillController(Controller& given) {
  const controller::ControllerOptions options;
  Absent absent(given);
  absent.Number("rate_hz", options.rate);
  absent.Number("silence_s", options.follower.silence);
  absent.Number("position_tolerance_m", options.follower.position_tolerance);
  absent.Number("angle_tolerance_deg", options.follower.angle_tolerance * kDegrees);
}

/// Only where it is given: that it stands there is what starts the service.
void FillStereo(Stereo& given) {
  const stereo::StereoOptions options;
  Absent absent(given);
  absent.Text("engine", options.engine);
  absent.Whole("max_disparity_px", options.matcher.max_disparity);
  absent.Number("min_depth_m", options.triangulation.min_depth);
  absent.Number("max_depth_m", options.triangulation.max_depth);
  absent.Number("disparity_error_px", options.triangulation.disparity_error);
  absent.Number("max_depth_error_m", options.triangulation.max_depth_error);
  absent.Whole("threads", options.matcher.threads);
  absent.Switch("fill_surfaces", options.matcher.best.fill_surfaces);
  absent.Whole("speckle_px", options.matcher.best.speckle_pixels);
  absent.Switch("refine", options.refine);
  absent.Whole("window_px", options.matcher.sad5.window);
  absent.Whole("max_difference", options.matcher.sad5.max_difference);
  absent.Number("uniqueness", options.matcher.sad5.uniqueness);
  absent.Number("rate_hz", options.rate);
}

/// Only where it is given: without it the simulator's true pose is the odometry.
void FillVisualOdometry(thalweg::VisualOdometry& given) {
  const visual_odometry::VisualOdometryOptions options;
  Absent absent(given);
  absent.Choice("source", thalweg::VisualOdometry::STEREO);
  absent.Number("file_rate_hz", options.file_rate);
  absent.Number("rate_hz", options.rate);
  absent.Whole("features", options.estimator.features);
  absent.Whole("most_places", options.estimator.places.most_places);
}

/// @param given  The same message as it was given; null when it was not.
void Print(const Message& full, const Message* given, const std::string& indent, std::ostream& out) {
  const Reflection& reflection = *full.GetReflection();
  for (int k = 0; k < full.GetDescriptor()->field_count(); ++k) {
    const FieldDescriptor* const field = full.GetDescriptor()->field(k);
    if (field->is_repeated()) {  // of messages, which have no default
      for (int n = 0; n < reflection.FieldSize(full, field); ++n) {
        const Message& inner = reflection.GetRepeatedMessage(full, field, n);
        out << indent << field->name() << " {\n";
        Print(inner, &inner, indent + "  ", out);
        out << indent << "}\n";
      }
      continue;
    }
    const bool always = !field->has_presence();  // a vector's zero
    if (!always && !reflection.HasField(full, field)) continue;
    const bool is_given = given != nullptr && (always || reflection.HasField(*given, field));
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      const bool vector = field->message_type() == Vector3::descriptor();
      out << indent << field->name() << (vector && !is_given ? " {  # default\n" : " {\n");
      const Message& inner = reflection.GetMessage(full, field);
      const Message* const its_given = is_given ? &reflection.GetMessage(*given, field) : nullptr;
      Print(inner, vector ? &inner : its_given, indent + "  ", out);
      out << indent << "}\n";
      continue;
    }
    std::string value;
    google::protobuf::TextFormat::PrintFieldValueToString(full, field, -1, &value);
    out << indent << field->name() << ": " << value << (is_given ? "\n" : "  # default\n");
  }
}

}  // namespace

Scenario WithDefaults(const Scenario& given) {
  Scenario full = given;
  FillNetwork(*full.mutable_network());
  FillRobot(*full.mutable_robot());
  FillCameras(*full.mutable_depth_sensor(), *full.mutable_stereo_camera());
  FillSimulator(*full.mutable_world(), *full.mutable_simulator());
  FillMapper(*full.mutable_mapper(), DepthErrorFrom(full));
  FillExplorer(*full.mutable_explorer(), explorer::OptionsFrom(full).look_range);
  FillController(*full.mutable_controller());
  if (full.has_stereo()) FillStereo(*full.mutable_stereo());
  if (full.has_visual_odometry()) FillVisualOdometry(*full.mutable_visual_odometry());
  return full;
}

std::string CommentedText(const Scenario& full, const Scenario& given) {
  std::ostringstream out;
  Print(full, &given, "", out);
  return out.str();
}

}  // namespace thalweg::cli
