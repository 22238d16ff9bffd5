#include "common/scenario/mistakes.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "common/base/angles.h"
#include "common/base/check.h"
#include "common/base/text.h"
#include "common/scenario/models.h"

namespace thalweg {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

std::string VectorText(const Vector3& v) {
  std::ostringstream text;
  text << '(' << v.x() << ", " << v.y() << ", " << v.z() << ')';
  return text.str();
}

/// Checks the values of a message and, recursively, of its parts.
/// @param elements  Indices of the repeated fields on the path.
void Check(const Message& message, FieldPath& path, std::vector<int>& elements,
           std::vector<Mistake>& mistakes) {
  std::vector<const FieldDescriptor*> present;
  message.GetReflection()->ListFields(message, &present);
  for (const FieldDescriptor* field : present) {
    path.push_back(field);
    if (field->is_repeated()) {  // repeated fields contain messages only
      const int count = message.GetReflection()->FieldSize(message, field);
      for (int n = 0; n < count; ++n) {
        elements.push_back(n);
        Check(message.GetReflection()->GetRepeatedMessage(message, field, n), path, elements, mistakes);
        elements.pop_back();
      }
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      Check(message.GetReflection()->GetMessage(message, field), path, elements, mistakes);
    } else if (std::string text = WrongValueText(message, path); !text.empty()) {
      mistakes.push_back({.field = path, .text = std::move(text), .elements = elements});
    }
    path.pop_back();
  }
}

void CheckNetwork(const Network& network, std::vector<Mistake>& mistakes) {
  in_addr parsed{};
  const std::string& address = network.network_interface();
  if (!address.empty() && inet_pton(AF_INET, address.c_str(), &parsed) != 1) {
    mistakes.push_back(
        {PathOf("network", "network_interface"), "is \"" + address + "\", must be an IPv4 address"});
  }
  static const std::regex kServers(";*[^:;\\s]+:[0-9]{1,5}(;+[^:;\\s]+:[0-9]{1,5})*");
  static const std::regex kHosts("[^:,\\s]+(,[^:,\\s]+)*");
  const std::string& peers = network.peers();
  if (!peers.empty() && !std::regex_match(peers, kHosts)) {
    mistakes.push_back({PathOf("network", "peers"), "is \"" + peers + "\", must be HOST,HOST,..."});
  }
  const std::string& server = network.discovery_server();
  if (!server.empty() && !std::regex_match(server, kServers)) {
    mistakes.push_back({PathOf("network", "discovery_server"),
                        "is \"" + server + "\", must be HOST:PORT, or several with ; between"});
  }
  if (!server.empty() && !peers.empty()) {
    mistakes.push_back({PathOf("network", "peers"), "is set as well as discovery_server: one or the other"});
  }
}

void CheckNoGo(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const World& world = scenario.world();
  for (int n = 0; n < world.no_go_size(); ++n) {
    const Box& box = world.no_go(n);
    const Vector3& low = box.min_m();
    const Vector3& high = box.max_m();
    if (box.has_min_m() && box.has_max_m() && low.x() < high.x() && low.y() < high.y() && low.z() < high.z())
      continue;
    mistakes.push_back({.field = PathOf("world", "no_go"),
                        .text = "box " + std::to_string(n + 1) + " from " + VectorText(low) + " to " +
                                VectorText(high) + " needs min_m and a max_m that is greater on each axis",
                        .elements = {n}});
  }
}

/// The path of a field of world.moving, or of its places.
FieldPath PathOfMoving(const char* field, const char* of_place = nullptr) {
  FieldPath path = PathOf("world", "moving");
  path.push_back(MovingPart::descriptor()->FindFieldByName(field));
  if (of_place != nullptr) path.push_back(MovingPart::Place::descriptor()->FindFieldByName(of_place));
  THALWEG_CHECK(path.back() != nullptr);
  return path;
}

bool Same(const MovingPart::Place& a, const MovingPart::Place& b) {
  const auto same = [](const Vector3& v, const Vector3& w) {
    return v.x() == w.x() && v.y() == w.y() && v.z() == w.z();
  };
  return a.yaw_deg() == b.yaw_deg() && same(a.offset_m(), b.offset_m());
}

/// Checks one part; `n` is its index.
void CheckMovingPart(const MovingPart& part, int n, std::vector<Mistake>& mistakes) {
  const std::string name = "of part " + std::to_string(n + 1) + " ";
  const Vector3& low = part.min_m();
  const Vector3& high = part.max_m();
  if (!part.has_min_m() || !part.has_max_m() || low.x() >= high.x() || low.y() >= high.y() ||
      low.z() >= high.z()) {
    mistakes.push_back({.field = PathOf("world", "moving"),
                        .text = "part " + std::to_string(n + 1) + " from " + VectorText(low) + " to " +
                                VectorText(high) + " needs min_m and a max_m that is greater on each axis",
                        .elements = {n}});
  }
  if (part.places().empty()) {
    mistakes.push_back(
        {.field = PathOf("world", "moving"),
         .text = "part " + std::to_string(n + 1) + " needs a place, places { time_s: 0 } for example",
         .elements = {n}});
    return;
  }
  for (int k = 1; k < part.places_size(); ++k) {
    if (part.places(k).time_s() > part.places(k - 1).time_s()) continue;
    mistakes.push_back({.field = PathOfMoving("places", "time_s"),
                        .text = name + "is " + NumberText(part.places(k).time_s()) + " in place " +
                                std::to_string(k + 1) + ", must be later than in the place before, " +
                                NumberText(part.places(k - 1).time_s()) + " s",
                        .elements = {n, k}});
    return;
  }
  const MovingPart::Place& first = part.places(0);
  const MovingPart::Place& last = part.places(part.places_size() - 1);
  const double period = part.period_s();
  if (period == 0.0) return;
  std::string text;
  if (period < last.time_s()) {
    text = "must be at least the time of its last place, " + NumberText(last.time_s()) + " s, or 0";
  } else if (period <= last.time_s() - first.time_s() && !Same(first, last)) {
    text = "which leaves no time to go back from its last place to its first, another one";
  }
  if (text.empty()) return;
  mistakes.push_back({.field = PathOfMoving("period_s"),
                      .text = name + "is " + NumberText(period) + ", " + text,
                      .elements = {n}});
}

void CheckMoving(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const World& world = scenario.world();
  for (int n = 0; n < world.moving_size(); ++n) CheckMovingPart(world.moving(n), n, mistakes);
}

void CheckBounds(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const World& world = scenario.world();
  const FieldPath min = PathOf("world", "bounds_min_m");
  const FieldPath max = PathOf("world", "bounds_max_m");
  if (world.has_bounds_min_m() != world.has_bounds_max_m()) {
    mistakes.push_back({world.has_bounds_min_m() ? min : max, "needs both bounds_min_m and bounds_max_m"});
  }
  if (!world.has_bounds_min_m() || !world.has_bounds_max_m()) return;
  const Vector3& low = world.bounds_min_m();
  const Vector3& high = world.bounds_max_m();
  if (low.x() >= high.x() || low.y() >= high.y() || low.z() >= high.z()) {
    mistakes.push_back({max, "is " + VectorText(high) + ", must be greater than bounds_min_m, " +
                                 VectorText(low) + ", on each axis"});
    return;
  }
  if (!scenario.simulator().has_start_position_m()) return;
  const Vector3& start = scenario.simulator().start_position_m();
  const auto within = [](double lower, double value, double upper) {
    return value >= lower && value <= upper;
  };
  if (!within(low.x(), start.x(), high.x()) || !within(low.y(), start.y(), high.y()) ||
      !within(low.z(), start.z(), high.z())) {
    mistakes.push_back({PathOf("simulator", "start_position_m"),
                        "is " + VectorText(start) + ", must be inside the world's bounds, " +
                            VectorText(low) + " to " + VectorText(high) + " m",
                        max});
  }
}

void CheckRanges(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const Mapper& mapper = scenario.mapper();
  const FieldPath min = PathOf("mapper", "min_range_m");
  const auto must_be_less = [&](const FieldPath& max, double range) {
    if (mapper.min_range_m() < range) return;
    mistakes.push_back({min,
                        "is " + NumberText(mapper.min_range_m()) + ", must be less than " + ToString(max) +
                            ", " + NumberText(range) + " m",
                        max});
  };
  if (!mapper.has_min_range_m()) return;
  if (mapper.has_max_range_m()) must_be_less(PathOf("mapper", "max_range_m"), mapper.max_range_m());
  must_be_less(PathOf("depth_sensor", "max_range_m"), DepthSensorFrom(scenario).max_range);
}

/// Checks what the sources of clouds and poses require.
void CheckSources(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const FieldPath depth = PathOf("depth_source");
  const FieldPath odometry = PathOf("odometry_source");
  const FieldPath camera = PathOf("stereo_camera", "enabled");
  const bool images = scenario.stereo_camera().enabled();
  const bool depth_from_images = scenario.depth_source() == DepthSource::STEREO;
  if (depth_from_images && !images) {
    mistakes.push_back({depth, "is STEREO, which needs stereo_camera.enabled: true", camera});
  }
  if (scenario.odometry_source() == OdometrySource::VISUAL_ODOMETRY &&
      scenario.visual_odometry().source() == VisualOdometry::STEREO && !images) {
    mistakes.push_back(
        {odometry,
         "is VISUAL_ODOMETRY with visual_odometry.source STEREO, which needs stereo_camera.enabled: true",
         camera});
  }
  if (scenario.depth_sensor().no_return_is_free() && depth_from_images) {
    mistakes.push_back(
        {PathOf("depth_sensor", "no_return_is_free"),
         "is true, but depth comes from stereo images, where a pixel without depth does not mean free space",
         depth});
  }
}

std::string DriveName(const Scenario& scenario) {
  return Robot::Drive_Name(scenario.robot().drive());
}

void CheckRobot(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const RobotModel robot = RobotFrom(scenario);
  if (!robot.drives && robot.drive != Drive::kOmni) {
    const FieldPath drives = PathOf("robot", "drives");
    mistakes.push_back({PathOf("robot", "drive"),
                        "is " + DriveName(scenario) + ", which needs " + ToString(drives) + ": true",
                        drives});
  }
  if (!robot.drives || robot.height > 0.0) return;
  const FieldPath height = PathOf("robot", "height_m");
  mistakes.push_back(
      {PathOf("robot", "drives"),
       "is true, which needs " + ToString(height) +
           " > 0: a driving robot is an upright cylinder and explores the heights that it sweeps",
       height});
}

/// Checks that a robot that turns only in curves knows how tight they may be, and is not to turn otherwise.
void CheckSteering(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const RobotModel robot = RobotFrom(scenario);
  const bool steers = robot.drive == Drive::kAckermann;
  const FieldPath drive = PathOf("robot", "drive");
  const FieldPath radius = PathOf("robot", "min_turning_radius_m");
  if (steers && robot.min_turning_radius <= 0.0)
    mistakes.push_back({drive, "is ACKERMANN, which needs " + ToString(radius) + " > 0", radius});
  if (!steers && robot.min_turning_radius > 0.0) {
    mistakes.push_back({radius,
                        "is " + NumberText(robot.min_turning_radius) + ", must be 0 for a robot whose " +
                            ToString(drive) + " is " + DriveName(scenario) + ": it turns on the spot",
                        drive});
  }
  if (steers && scenario.controller().type() == Controller::STOP_AND_TURN) {
    mistakes.push_back({PathOf("controller", "type"),
                        "is STOP_AND_TURN, but a robot whose " + ToString(drive) +
                            " is ACKERMANN cannot turn on the spot",
                        drive});
  }
}

void CheckGimbal(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const RobotModel robot = RobotFrom(scenario);
  if (!robot.gimballed()) return;
  const FieldPath attitude = PathOf("robot", "attitude");
  if (robot.gimbal_lowest > robot.gimbal_highest) {
    const FieldPath highest = PathOf("robot", "gimbal_max_pitch_deg");
    mistakes.push_back({PathOf("robot", "gimbal_min_pitch_deg"),
                        "is " + NumberText(robot.gimbal_lowest / kDegree) + ", must be at most " +
                            ToString(highest) + ", " + NumberText(robot.gimbal_highest / kDegree),
                        highest});
  }
  if (!robot.T_BC.translation().isZero()) {
    mistakes.push_back({PathOf("robot", "camera_position_m"),
                        "must be 0 for a robot whose " + ToString(attitude) +
                            " is GIMBAL: base_link is at the gimbal's axis",
                        attitude});
  }
}

/// Checks that a smoothed motion stays on its path, which it leaves in curves by a^3 / (6 j^2) at most.
void CheckJerk(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  constexpr double kMostCut = 0.01;  // [m]
  const RobotModel robot = RobotFrom(scenario);
  if (robot.max_jerk == 0.0) return;
  if (robot.faces_travel()) {
    const FieldPath drive = PathOf("robot", "drive");
    mistakes.push_back({PathOf("robot", "max_jerk_mps3"),
                        "is " + NumberText(robot.max_jerk) + ", must be 0 for a robot whose " +
                            ToString(drive) + " is " + DriveName(scenario) +
                            ": smoothed, it would slide sideways",
                        drive});
    return;
  }
  const double a = robot.max_acceleration;
  const double least = std::sqrt(a * a * a / (6.0 * kMostCut));
  if (robot.max_jerk >= least) return;
  const FieldPath acceleration = PathOf("robot", "max_acceleration_mps2");
  mistakes.push_back({PathOf("robot", "max_jerk_mps3"),
                      "is " + NumberText(robot.max_jerk) + ", must be 0 or at least " +
                          NumberText(std::ceil(least * 10.0) / 10.0) + " for " + ToString(acceleration) +
                          ", " + NumberText(a) + ": else curves are cut by more than 1 cm",
                      acceleration});
}

/// Checks for values that are too fine or too coarse for the voxel size.
void CheckVoxels(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const Mapper& mapper = scenario.mapper();
  if (!mapper.has_voxel_size_m()) return;
  const double voxel = mapper.voxel_size_m();
  const FieldPath size = PathOf("mapper", "voxel_size_m");
  const auto voxels = [&](double length) {
    return NumberText(length) + " m, " + NumberText(length / voxel) + " voxels of " + ToString(size) + " " +
           NumberText(voxel) + " m";
  };
  if (mapper.max_range_m() > kMostVoxelsOfRange * voxel * (1.0 + 1e-9)) {
    mistakes.push_back({PathOf("mapper", "max_range_m"),
                        "is " + voxels(mapper.max_range_m()) + ", must be at most " +
                            std::to_string(kMostVoxelsOfRange) + " voxels",
                        size});
  }
  const FieldPath radius_path = PathOf("robot", "radius_m");
  const double radius = RobotFrom(scenario).radius;
  if (voxel > 2.0 * radius * (1.0 + 1e-9)) {
    mistakes.push_back({size,
                        "is " + NumberText(voxel) + ", must be at most the robot's width, 2 * " +
                            ToString(radius_path) + " = " + NumberText(2.0 * radius) +
                            " m: larger voxels cannot show where the robot fits",
                        radius_path});
  }
  const double clearance = radius + scenario.explorer().safety_margin_m();
  if (clearance > kMostVoxelsOfClearance * voxel * (1.0 + 1e-9)) {
    mistakes.push_back({radius_path,
                        "with explorer.safety_margin_m is " + voxels(clearance) + ", must be at most " +
                            std::to_string(kMostVoxelsOfClearance) + " voxels",
                        size});
  }
}

/// Checks that no two fields of a block of names have the same value.
void CheckDistinct(const Message& names, const char* block, std::vector<Mistake>& mistakes) {
  std::vector<const FieldDescriptor*> present;
  names.GetReflection()->ListFields(names, &present);
  std::map<std::string, const FieldDescriptor*> known;
  for (const FieldDescriptor* field : present) {
    const std::string name = names.GetReflection()->GetString(names, field);
    const auto [other, is_new] = known.emplace(name, field);
    if (is_new) continue;
    mistakes.push_back({PathOf(block, field->name().c_str()),
                        "is \"" + name + "\", which is the name of " + std::string(block) + "." +
                            other->second->name() + " already",
                        PathOf(block, other->second->name().c_str())});
  }
}

void CheckNames(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  CheckDistinct(scenario.topics(), "topics", mistakes);
  CheckDistinct(scenario.frames(), "frames", mistakes);
}

/// A condition between fields, and the fields it reads.
struct Agreement {
  void (*check)(const Scenario&, std::vector<Mistake>&);
  std::vector<FieldPath> reads;
};

std::vector<Agreement> Agreements() {
  return {{CheckBounds,
           {PathOf("world", "bounds_min_m"), PathOf("world", "bounds_max_m"),
            PathOf("simulator", "start_position_m")}},
          {CheckNoGo, {PathOf("world", "no_go")}},
          {CheckMoving, {PathOf("world", "moving")}},
          {CheckRanges,
           {PathOf("mapper", "min_range_m"), PathOf("mapper", "max_range_m"),
            PathOf("depth_sensor", "max_range_m")}},
          {CheckSources, {}},
          {CheckNames, {}},
          {CheckRobot, {PathOf("robot", "height_m")}},
          {CheckSteering, {PathOf("robot", "min_turning_radius_m")}},
          {CheckGimbal, {PathOf("robot", "gimbal_min_pitch_deg"), PathOf("robot", "gimbal_max_pitch_deg")}},
          {CheckJerk, {PathOf("robot", "max_jerk_mps3"), PathOf("robot", "max_acceleration_mps2")}},
          {CheckVoxels,
           {PathOf("mapper", "voxel_size_m"), PathOf("mapper", "max_range_m"), PathOf("robot", "radius_m"),
            PathOf("explorer", "safety_margin_m")}}};
}

}  // namespace

FieldPath PathOf(const char* field) {
  const FieldDescriptor* const found = Scenario::descriptor()->FindFieldByName(field);
  THALWEG_CHECK(found != nullptr);
  return {found};
}

FieldPath PathOf(const char* block, const char* field) {
  const FieldDescriptor* const outer = PathOf(block).front();
  const FieldDescriptor* const inner = outer->message_type()->FindFieldByName(field);
  THALWEG_CHECK(inner != nullptr);
  return {outer, inner};
}

std::vector<Mistake> MistakesIn(const Scenario& scenario) {
  std::vector<Mistake> mistakes;
  FieldPath path;
  std::vector<int> elements;
  Check(scenario, path, elements, mistakes);
  CheckNetwork(scenario.network(), mistakes);
  // A contradiction with a value that is itself invalid is not reported as another mistake.
  std::set<FieldPath> wrong;
  for (const Mistake& mistake : mistakes) {  // the vector as a whole, not its component
    const auto begin = mistake.field.begin();
    wrong.emplace(begin, begin + std::min<std::ptrdiff_t>(std::ssize(mistake.field), 2));
  }
  for (const auto& [check, reads] : Agreements()) {
    if (std::ranges::none_of(reads, [&](const FieldPath& field) { return wrong.count(field) > 0; }))
      check(scenario, mistakes);
  }
  return mistakes;
}

std::vector<Mistake> UnusedBlocksIn(const Scenario& given) {
  std::vector<Mistake> mistakes;
  if (given.has_stereo() && !given.has_depth_source()) {
    mistakes.push_back(
        {PathOf("stereo"),
         "is configured, but depth_source is not set: set it to STEREO to use this block, or to "
         "DEPTH_SENSOR or EXTERNAL to ignore it"});
  }
  if (given.has_visual_odometry() && !given.has_odometry_source()) {
    mistakes.push_back(
        {PathOf("visual_odometry"),
         "is configured, but odometry_source is not set: set it to VISUAL_ODOMETRY to use this "
         "block, or to SIMULATOR or EXTERNAL to ignore it"});
  }
  return mistakes;
}

}  // namespace thalweg
