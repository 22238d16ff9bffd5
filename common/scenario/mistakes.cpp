#include "common/scenario/mistakes.h"

#include <arpa/inet.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <numeric>
#include <regex>
#include <set>
#include <sstream>

#include "common/base/check.h"
#include "common/scenario/models.h"

namespace thalweg {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

double NumberIn(const Message& message, const FieldDescriptor* field) {
  const Reflection* const reflection = message.GetReflection();
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_INT32) return reflection->GetInt32(message, field);
  THALWEG_CHECK(field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE);
  return reflection->GetDouble(message, field);
}

std::string ValueText(const Message& message, const FieldDescriptor* field) {
  std::string text;
  google::protobuf::TextFormat::PrintFieldValueToString(message, field, -1, &text);
  return text;
}

std::string NumberText(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string VectorText(const Vector3& v) {
  std::ostringstream text;
  text << '(' << v.x() << ", " << v.y() << ", " << v.z() << ')';
  return text.str();
}

/// The unit that the end of a name stands for; nothing where it stands for none.
std::string UnitOf(const std::string& ending) {
  static const std::map<std::string, std::string> kUnits = {
      {"m", "m"}, {"mps", "m/s"}, {"mps2", "m/s^2"}, {"deg", "deg"}, {"dps", "deg/s"},
      {"s", "s"}, {"hz", "Hz"},   {"px", "px"},      {"mb", "MB"},   {"m2", "m^2"},
  };
  const auto unit = kUnits.find(ending);
  return unit == kUnits.end() ? "" : unit->second;
}

/// " m" for radius_m, " m/s" for max_speed_mps, " 1/m" for decay_per_m, " m/m^2" for worth_m_per_m2, nothing
/// for width; a vector's component has the vector's.
std::string UnitOf(const FieldPath& path) {
  const bool component = path.size() > 1 && path.back()->containing_type() == Vector3::descriptor();
  std::string name = path[path.size() - (component ? 2 : 1)]->name();
  std::string below;
  if (const std::size_t per = name.rfind("_per_"); per != std::string::npos) {
    below = UnitOf(name.substr(per + 5));
    name.resize(per);
  }
  const std::size_t underscore = name.rfind('_');
  std::string unit = underscore == std::string::npos ? "" : UnitOf(name.substr(underscore + 1));
  if (!below.empty()) unit = (unit.empty() ? "1" : unit) + '/' + below;
  return unit.empty() ? "" : ' ' + unit;
}

/// "a, b, c"
template <class Names>
std::string Listed(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> NamesIn(const std::string& names) {
  std::istringstream stream(names);
  std::vector<std::string> list;
  for (std::string name; std::getline(stream, name, '|');) list.push_back(name);
  return list;
}

/// How many letters to insert, remove or replace to make one word of the other [Levenshtein 1966].
std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size());  // of the letters of a so far, to b up to each of its letters
  std::iota(row.begin(), row.end(), std::size_t{1});
  std::size_t before = 0;  // to nothing of b
  for (const char letter : a) {
    std::size_t diagonal = before++;
    std::size_t left = before;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (letter == b[j] ? 0 : 1);
      diagonal = row[j];
      left = row[j] = std::min({replaced, left + 1, diagonal + 1});
    }
  }
  return b.empty() ? before : row[b.size() - 1];
}

bool IsAllowed(const Message& message, const FieldDescriptor* field) {
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
    case FieldDescriptor::CPPTYPE_ENUM:
      return true;
    case FieldDescriptor::CPPTYPE_STRING: {
      const std::string& names = field->options().GetExtension(allowed);
      if (names.empty()) return true;
      const std::vector<std::string> list = NamesIn(names);
      return std::ranges::count(list, message.GetReflection()->GetString(message, field)) > 0;
    }
    default:
      return IsInInterval(NumberIn(message, field), field->options().GetExtension(allowed));
  }
}

bool IsOwnOutput(const Message& message, const FieldDescriptor* field) {
  const std::string& names = field->options().GetExtension(own_outputs);
  return !names.empty() &&
         std::ranges::count(NamesIn(names), message.GetReflection()->GetString(message, field)) > 0;
}

/// @param element  Of the repeated field on the path.
void Check(const Message& message, FieldPath& path, int element, std::vector<Mistake>& mistakes) {
  std::vector<const FieldDescriptor*> present;
  message.GetReflection()->ListFields(message, &present);
  for (const FieldDescriptor* field : present) {
    path.push_back(field);
    if (field->is_repeated()) {  // of messages; there are no others
      const int count = message.GetReflection()->FieldSize(message, field);
      for (int n = 0; n < count; ++n) {
        Check(message.GetReflection()->GetRepeatedMessage(message, field, n), path, n, mistakes);
      }
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      Check(message.GetReflection()->GetMessage(message, field), path, element, mistakes);
    } else if (!IsAllowed(message, field)) {
      const bool name = field->cpp_type() == FieldDescriptor::CPPTYPE_STRING;
      const std::string text = name ? NotOneOf(NamesIn(field->options().GetExtension(allowed)),
                                               message.GetReflection()->GetString(message, field))
                                    : "is " + ValueText(message, field) + ", must be " + AllowedText(path);
      mistakes.push_back({.field = path, .text = text, .element = element});
    } else if (IsOwnOutput(message, field)) {
      const std::string text = "is " + ValueText(message, field) +
                               ", which this service itself publishes: it would read its own output";
      mistakes.push_back({.field = path, .text = text, .element = element});
    }
    path.pop_back();
  }
}

FieldPath PathOf(const char* outer) {
  const FieldDescriptor* const field = Scenario::descriptor()->FindFieldByName(outer);
  THALWEG_CHECK(field != nullptr);
  return {field};
}

FieldPath PathOf(const char* outer, const char* inner) {
  const FieldDescriptor* const first = PathOf(outer).front();
  const FieldDescriptor* const second = first->message_type()->FindFieldByName(inner);
  THALWEG_CHECK(second != nullptr);
  return {first, second};
}

void CheckNetwork(const Network& network, std::vector<Mistake>& mistakes) {
  in_addr parsed{};
  const std::string& address = network.network_interface();
  if (!address.empty() && inet_pton(AF_INET, address.c_str(), &parsed) != 1) {
    mistakes.push_back(
        {PathOf("network", "network_interface"), "is \"" + address + "\", must be an IPv4 address"});
  }
  static const std::regex kHostAndPort("[^:\\s]+:[0-9]{1,5}");
  const std::string& server = network.discovery_server();
  if (!server.empty() && !std::regex_match(server, kHostAndPort)) {
    mistakes.push_back({PathOf("network", "discovery_server"), "is \"" + server + "\", must be HOST:PORT"});
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
                        .element = n});
  }
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

/// What the sources of clouds and poses need.
void CheckSources(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const FieldPath depth = PathOf("depth_source");
  const FieldPath odometry = PathOf("odometry_source");
  const FieldPath camera = PathOf("stereo_camera", "enabled");
  const bool images = scenario.stereo_camera().enabled();
  const bool depth_from_images = scenario.depth_source() == DepthSource::STEREO;
  if (depth_from_images && !images) {
    mistakes.push_back({depth, "is STEREO, needs stereo_camera.enabled: true", camera});
  }
  if (scenario.odometry_source() == OdometrySource::VISUAL_ODOMETRY &&
      scenario.visual_odometry().source() == VisualOdometry::STEREO && !images) {
    mistakes.push_back(
        {odometry, "is VISUAL_ODOMETRY with visual_odometry.source STEREO, needs stereo_camera.enabled: true",
         camera});
  }
  if (scenario.depth_sensor().no_return_is_free() && depth_from_images) {
    mistakes.push_back(
        {PathOf("depth_sensor", "no_return_is_free"),
         "is true, but depth comes from images: where a stereo camera has none, anything may be", depth});
  }
}

void CheckRobot(const Scenario& scenario, std::vector<Mistake>& mistakes) {
  const RobotModel robot = RobotFrom(scenario);
  if (!robot.drives || robot.height > 0.0) return;
  const FieldPath height = PathOf("robot", "height_m");
  mistakes.push_back({PathOf("robot", "drives"),
                      "is true, needs " + ToString(height) +
                          " > 0: a robot that drives is an upright cylinder, and explores as high as that",
                      height});
}

/// What is too fine or too coarse for the size of the voxels.
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
                            " m: in wider voxels it cannot be told whether the robot fits",
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

/// What must hold between fields, and which it reads.
struct Agreement {
  void (*check)(const Scenario&, std::vector<Mistake>&);
  std::vector<FieldPath> reads;
};

std::vector<Agreement> Agreements() {
  return {{CheckBounds,
           {PathOf("world", "bounds_min_m"), PathOf("world", "bounds_max_m"),
            PathOf("simulator", "start_position_m")}},
          {CheckNoGo, {PathOf("world", "no_go")}},
          {CheckRanges,
           {PathOf("mapper", "min_range_m"), PathOf("mapper", "max_range_m"),
            PathOf("depth_sensor", "max_range_m")}},
          {CheckSources, {}},
          {CheckRobot, {PathOf("robot", "height_m")}},
          {CheckVoxels,
           {PathOf("mapper", "voxel_size_m"), PathOf("mapper", "max_range_m"), PathOf("robot", "radius_m"),
            PathOf("explorer", "safety_margin_m")}}};
}

}  // namespace

std::string ToString(const FieldPath& path) {
  std::string text;
  for (const FieldDescriptor* field : path) text += (text.empty() ? "" : ".") + field->name();
  return text;
}

std::string TypeText(const FieldDescriptor* field) {
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return "true or false";
    case FieldDescriptor::CPPTYPE_ENUM: {
      std::vector<std::string> names;
      for (int k = 0; k < field->enum_type()->value_count(); ++k) {
        names.push_back(field->enum_type()->value(k)->name());
      }
      return "one of " + Listed(names);
    }
    case FieldDescriptor::CPPTYPE_STRING:
      return "text in quotes";
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return "{ ... }";
    case FieldDescriptor::CPPTYPE_INT32:
      return "a whole number";
    default:
      return "a number";
  }
}

std::string AllowedText(const FieldPath& path) {
  const std::string& option = path.back()->options().GetExtension(allowed);
  if (path.back()->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    return "one of " + Listed(NamesIn(option));
  }
  return "in " + option + UnitOf(path);
}

std::string NotOneOf(const std::vector<std::string>& names, const std::string& name) {
  std::string text = "is \"" + name + "\", must be one of " + Listed(names);
  const auto nearest = std::ranges::min_element(
      names, {}, [&](const std::string& known) { return EditDistance(known, name); });
  const std::size_t most = std::max<std::size_t>(1, name.size() / 3);  // else it is another word altogether
  if (nearest != names.end() && EditDistance(*nearest, name) <= most) {
    text += "; did you mean " + *nearest + '?';
  }
  return text;
}

bool IsInInterval(double value, const std::string& interval) {
  char open = 0;
  char close = 0;
  double low = 0.0;
  double high = 0.0;
  THALWEG_CHECK(std::sscanf(interval.c_str(), "%c%lf, %lf%c", &open, &low, &high, &close) == 4);
  return (open == '(' ? value > low : value >= low) && (close == ')' ? value < high : value <= high);
}

std::vector<Mistake> MistakesIn(const Scenario& scenario) {
  std::vector<Mistake> mistakes;
  FieldPath path;
  Check(scenario, path, 0, mistakes);
  CheckNetwork(scenario.network(), mistakes);
  // What a value that is wrong by itself contradicts is not another mistake.
  std::set<FieldPath> wrong;
  for (const Mistake& mistake : mistakes) {  // of a vector as a whole, not of its component
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
    mistakes.push_back({PathOf("stereo"),
                        "is configured, but nothing says whether depth comes from it: give depth_source: "
                        "STEREO, or DEPTH_SENSOR where it does not"});
  }
  if (given.has_visual_odometry() && !given.has_odometry_source()) {
    mistakes.push_back({PathOf("visual_odometry"),
                        "is configured, but nothing says whether poses come from it: give odometry_source: "
                        "VISUAL_ODOMETRY, or SIMULATOR where they do not"});
  }
  return mistakes;
}

}  // namespace thalweg
