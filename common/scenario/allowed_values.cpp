#include "common/scenario/allowed_values.h"

#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>

#include "common/base/check.h"
#include "common/base/nearest_name.h"
#include "common/base/ros_name.h"
#include "common/base/text.h"
#include "scenario.pb.h"

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

/// The unit denoted by the last part of a name; empty if it denotes none.
std::string UnitOf(const std::string& ending) {
  static const std::map<std::string, std::string> kUnits = {
      {"m", "m"},   {"mps", "m/s"}, {"mps2", "m/s^2"}, {"deg", "deg"}, {"dps", "deg/s"}, {"s", "s"},
      {"hz", "Hz"}, {"px", "px"},   {"mb", "MB"},      {"m2", "m^2"},  {"rad", "rad"},
  };
  const auto unit = kUnits.find(ending);
  return unit == kUnits.end() ? "" : unit->second;
}

/// The unit of a field: " m" for radius_m, " m/s" for max_speed_mps, " 1/m" for decay_per_m, " m/m^2" for
/// worth_m_per_m2, empty for width. A vector's component has the unit of the vector.
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

std::vector<std::string> NamesIn(const std::string& names) {
  std::istringstream stream(names);
  std::vector<std::string> list;
  for (std::string name; std::getline(stream, name, '|');) list.push_back(name);
  return list;
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

/// What is wrong with a name of ROS 2; empty if nothing is.
std::string WrongNameText(const Message& message, const FieldDescriptor* field) {
  const std::string& kind = field->options().GetExtension(ros_name);
  if (kind.empty()) return "";
  const std::string name = message.GetReflection()->GetString(message, field);
  if (name.empty() && kind == "prefix") return "";
  if (IsRosName(kind == "topic" && name.starts_with('/') ? name.substr(1) : name)) return "";
  return "is \"" + name + "\", must be " + std::string(kRosNameRule);
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
      return "one of " + Joined(names);
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
    return "one of " + Joined(NamesIn(option));
  }
  return "in " + option + UnitOf(path);
}

std::string NotOneOf(const std::vector<std::string>& names, const std::string& name) {
  return "is \"" + name + "\", must be one of " + Joined(names) + DidYouMean(names, name);
}

bool IsInInterval(double value, const std::string& interval) {
  char open = 0;
  char close = 0;
  double low = 0.0;
  double high = 0.0;
  THALWEG_CHECK(std::sscanf(interval.c_str(), "%c%lf, %lf%c", &open, &low, &high, &close) == 4);
  return (open == '(' ? value > low : value >= low) && (close == ')' ? value < high : value <= high);
}

std::string WrongValueText(const Message& message, const FieldPath& path) {
  const FieldDescriptor* const field = path.back();
  if (!IsAllowed(message, field)) {
    return field->cpp_type() == FieldDescriptor::CPPTYPE_STRING
               ? NotOneOf(NamesIn(field->options().GetExtension(allowed)),
                          message.GetReflection()->GetString(message, field))
               : "is " + ValueText(message, field) + ", must be " + AllowedText(path);
  }
  if (IsOwnOutput(message, field)) {
    return "is " + ValueText(message, field) +
           ", which this service itself publishes: it would read its own output";
  }
  return WrongNameText(message, field);
}

}  // namespace thalweg
