#include "services/inspector/core/one_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/angles.h"
#include "common/base/text.h"
#include "services/inspector/core/yaml.h"

namespace thalweg::inspector {
namespace {

constexpr auto kAll = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kShortList = 9;
constexpr std::size_t kFewMessages = 4;
constexpr std::size_t kShortText = 400;  // of the messages of a list

double AsDouble(const Number& number) {
  return std::visit([](const auto value) { return static_cast<double>(value); }, number);
}

/// A number of a quantity: at most three decimals, no zeros at the end.
std::string Short(const Number& number) {
  if (!std::holds_alternative<float>(number) && !std::holds_alternative<double>(number))
    return YamlNumber(number);
  const double value = AsDouble(number);
  if (std::isnan(value)) return "nan";
  const double size = std::abs(value);
  if (value != 0.0 && (size < 1e-3 || size >= 1e7)) return fmt::format("{:.3g}", value);
  std::string text = fmt::format("{:.3f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

/// The part that all constants' names share, up to the last underscore: "EXPLORATION_".
std::size_t PrefixOf(const std::vector<Constant>& constants) {
  std::string_view shared = constants[0].name;
  for (const Constant& constant : constants) {
    const auto end = std::ranges::mismatch(shared, constant.name).in1;
    shared = shared.substr(0, static_cast<std::size_t>(end - shared.begin()));
  }
  const std::size_t underscore = shared.rfind('_');
  return constants.size() < 2 || underscore == std::string_view::npos ? 0 : underscore + 1;
}

bool IsPoint(const MessageType& message) {
  constexpr std::size_t kMostCoordinates = 4;
  return message.fields.size() > 1 && message.fields.size() <= kMostCoordinates &&
         std::ranges::all_of(message.fields, [](const Field& field) {
           return field.type.arity == Arity::kOne &&
                  (field.type.kind == Kind::kFloat32 || field.type.kind == Kind::kFloat64);
         });
}

/// Roll, pitch and yaw of REP 103, in degrees.
std::string Angles(const std::vector<Value>& xyzw) {
  const double x = AsDouble(xyzw[0].number()), y = AsDouble(xyzw[1].number());
  const double z = AsDouble(xyzw[2].number()), w = AsDouble(xyzw[3].number());
  const double roll = std::atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  const double pitch = std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0));
  const double yaw = std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  const auto text = [&](double angle) { return Short(std::round(angle / kDegree * 10) / 10); };
  if (std::abs(roll) + std::abs(pitch) < 1e-3) return "yaw " + text(yaw) + " deg";
  return fmt::format("roll {} pitch {} yaw {} deg", text(roll), text(pitch), text(yaw));
}

class Liner {
 public:
  explicit Liner(const Schema& schema) : schema_(schema) {}

  void Add(const std::string& name, const FieldType& type, const std::vector<Constant>& constants,
           const Value& value) {
    if (type.arity != Arity::kOne) return AddList(name, type, value);
    if (type.kind == Kind::kMessage) return AddMessage(name, type, value);
    if (type.kind == Kind::kString) {
      if (!value.text().empty()) Append(name, Text(value.text()));
    } else if (type.kind == Kind::kBool) {
      Append(name, value.number() == Number(std::uint64_t{0}) ? "no" : "yes");
    } else {
      Append(name, Named(constants, value.number()));
    }
  }

  std::string Take() { return std::move(out_); }

 private:
  static std::string Text(const std::string& text) {
    const std::string clean = CleanText(text);
    return clean.find(' ') == std::string::npos ? clean : '"' + clean + '"';
  }
  static std::string Named(const std::vector<Constant>& constants, const Number& number) {
    const auto* const whole = std::get_if<std::uint64_t>(&number);
    if (whole == nullptr || constants.empty()) return Short(number);
    const auto found = std::ranges::find(constants, *whole, &Constant::value);
    return found == constants.end() ? Short(number) : found->name.substr(PrefixOf(constants));
  }
  void Append(const std::string& name, const std::string& text) {
    if (!out_.empty()) out_ += "  ";
    out_ += name.empty() ? text : name + '=' + text;
  }

  void AddList(const std::string& name, const FieldType& type, const Value& value) {
    if (value.size() == 0) return;
    if (type.kind == Kind::kMessage && value.size() <= kFewMessages) {
      std::string text;
      for (std::size_t k = 0; k < value.size(); ++k) {
        Liner element(schema_);
        element.Add("", type.element(), {}, value.At(k));
        text += (k == 0 ? "" : "; ") + element.Take();
      }
      if (text.size() <= kShortText) return Append(name, '[' + text + ']');
    }
    if (type.kind == Kind::kMessage || value.size() > kShortList) {
      const std::string full = schema_.NameOf(type.element());
      return Append(name, fmt::format("[{} {}]", value.size(), full.substr(full.rfind('/') + 1)));
    }
    std::string text;
    for (std::size_t k = 0; k < value.size(); ++k) {
      const Value element = value.At(k);
      text += (k == 0 ? "" : ", ") + (IsNumber(type.kind) ? Short(element.number()) : Text(element.text()));
    }
    Append(name, '[' + text + ']');
  }

  void AddMessage(const std::string& name, const FieldType& type, const Value& value) {
    const MessageType& message = schema_.message(type);
    const std::vector<Value>& values = value.values();
    if (message.name == "std_msgs/Header") {
      std::string text = Stamp(values[0].values());
      if (!values[1].text().empty()) text += ' ' + Text(values[1].text());
      return Append(name == "header" ? "" : name, text);
    }
    if (message.name == "builtin_interfaces/Time") return Append(name, Stamp(values));
    if (message.name == "geometry_msgs/Quaternion") return Append(name, Angles(values));
    if (IsPoint(message)) {
      std::string text;
      for (const Value& each : values) text += (text.empty() ? "" : ", ") + Short(each.number());
      return Append(name, '(' + text + ')');
    }
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Field& field = message.fields[k];
      // pose.pose.position, as in Odometry, says no more than pose.position.
      const bool repeats = name == field.name || name.ends_with('.' + field.name);
      const std::string full = name.empty() ? field.name : repeats ? name : name + '.' + field.name;
      Add(full, field.type, field.constants, values[k]);
    }
  }

  static std::string Stamp(const std::vector<Value>& time) {
    return fmt::format("{:.3f}", AsDouble(time[0].number()) + 1e-9 * AsDouble(time[1].number()));
  }

  const Schema& schema_;
  std::string out_;
};

class CsvWriter {
 public:
  CsvWriter(const Schema& schema, Arrays arrays) : schema_(schema), arrays_(arrays) {}

  void Add(const FieldType& type, const Value& value) {
    if (type.arity != Arity::kOne) {
      if (arrays_ == Arrays::kLeftOut) return;
      for (std::size_t k = 0; k < value.size(); ++k) Add(type.element(), value.At(k));
    } else if (type.kind == Kind::kMessage) {
      const std::vector<Field>& fields = schema_.message(type).fields;
      for (std::size_t k = 0; k < fields.size(); ++k) Add(fields[k].type, value.values()[k]);
    } else if (type.kind == Kind::kString) {
      Append(Quoted(CleanText(value.text(), kAll)));
    } else if (type.kind == Kind::kBool) {
      Append(value.number() == Number(std::uint64_t{0}) ? "False" : "True");
    } else {
      Append(Plain(value.number()));
    }
  }

  std::string Take() { return std::move(out_); }

 private:
  static std::string Quoted(const std::string& text) {
    if (text.find_first_of(",\" ") == std::string::npos) return text;
    std::string quoted;
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return '"' + quoted + '"';
  }
  /// As Python writes them, whose readers of CSV know no ".nan".
  static std::string Plain(const Number& number) {
    std::string text = YamlNumber(number);
    if (text == ".nan" || text == ".inf") text.erase(0, 1);
    return text == "-.inf" ? "-inf" : text;
  }
  void Append(const std::string& text) {
    if (!empty_) out_ += ',';
    empty_ = false;
    out_ += text;
  }

  const Schema& schema_;
  Arrays arrays_;
  std::string out_;
  bool empty_ = true;
};

}  // namespace

std::string ToLine(const Schema& schema, const FieldType& type, const Value& value) {
  Liner liner(schema);
  liner.Add("", type, {}, value);
  return liner.Take();
}

std::string ToCsv(const Schema& schema, const FieldType& type, const Value& value, Arrays arrays) {
  CsvWriter writer(schema, arrays);
  writer.Add(type, value);
  return writer.Take();
}

}  // namespace thalweg::inspector
