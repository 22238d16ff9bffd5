#include "common/scenario/mistakes.h"

#include <arpa/inet.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cstdio>
#include <regex>
#include <sstream>

#include "common/base/check.h"

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

bool IsOneOf(const std::string& value, const std::string& names) {
  std::istringstream stream(names);
  for (std::string name; std::getline(stream, name, '|');) {
    if (name == value) return true;
  }
  return false;
}

std::string ValueText(const Message& message, const FieldDescriptor* field) {
  std::string text;
  google::protobuf::TextFormat::PrintFieldValueToString(message, field, -1, &text);
  return text;
}

bool IsAllowed(const Message& message, const FieldDescriptor* field) {
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
    case FieldDescriptor::CPPTYPE_ENUM:
      return true;
    case FieldDescriptor::CPPTYPE_STRING: {
      const std::string& names = field->options().GetExtension(allowed);
      return names.empty() || IsOneOf(message.GetReflection()->GetString(message, field), names);
    }
    default:
      return IsInInterval(NumberIn(message, field), field->options().GetExtension(allowed));
  }
}

void Check(const Message& message, FieldPath& path, std::vector<Mistake>& mistakes) {
  std::vector<const FieldDescriptor*> present;
  message.GetReflection()->ListFields(message, &present);
  for (const FieldDescriptor* field : present) {
    path.push_back(field);
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      Check(message.GetReflection()->GetMessage(message, field), path, mistakes);
    } else if (!IsAllowed(message, field)) {
      mistakes.push_back(
          {path, "is " + ValueText(message, field) + ", must be " + field->options().GetExtension(allowed)});
    }
    path.pop_back();
  }
}

FieldPath PathOf(const char* outer, const char* inner) {
  const FieldDescriptor* const first = Scenario::descriptor()->FindFieldByName(outer);
  THALWEG_CHECK(first != nullptr);
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

void CheckBounds(const World& world, std::vector<Mistake>& mistakes) {
  if (world.has_bounds_min_m() != world.has_bounds_max_m()) {
    mistakes.push_back({PathOf("world", world.has_bounds_min_m() ? "bounds_min_m" : "bounds_max_m"),
                        "needs both bounds_min_m and bounds_max_m"});
  }
  if (!world.has_bounds_min_m() || !world.has_bounds_max_m()) return;
  const Vector3& low = world.bounds_min_m();
  const Vector3& high = world.bounds_max_m();
  if (low.x() >= high.x() || low.y() >= high.y() || low.z() >= high.z()) {
    mistakes.push_back({PathOf("world", "bounds_max_m"), "must be greater than bounds_min_m on each axis"});
  }
}

}  // namespace

std::string ToString(const FieldPath& path) {
  std::string text;
  for (const FieldDescriptor* field : path) text += (text.empty() ? "" : ".") + field->name();
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
  Check(scenario, path, mistakes);
  CheckNetwork(scenario.network(), mistakes);
  CheckBounds(scenario.world(), mistakes);
  const Mapper& mapper = scenario.mapper();
  if (mapper.has_min_range_m() && mapper.has_max_range_m() && mapper.min_range_m() >= mapper.max_range_m()) {
    mistakes.push_back({PathOf("mapper", "min_range_m"), "must be less than max_range_m"});
  }
  return mistakes;
}

}  // namespace thalweg
