#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/angles.h"
#include "common/base/check.h"
#include "common/base/time.h"

namespace thalweg {

/// Visits the options of an algorithm, each under the name of its field in a scenario.
///
/// An options struct that a scenario configures is accompanied by one function,
///   void Visit(OptionVisitor& visitor, Options& options);
/// which passes every option to the visitor. It is the only place that maps members to fields, for every
/// purpose: a visitor that reads sets the members whose fields are present (OptionReader), one that writes
/// fills the fields that are absent (OptionWriter). Members have the units of core (meters, seconds,
/// radians), fields those that their names end in.
///
/// Each function returns whether it changed the option.
class OptionVisitor {
 public:
  virtual ~OptionVisitor() = default;

  template <std::floating_point Value>
  bool Number(const char* field, Value& value) {
    double number = value;
    const bool changed = VisitNumber(field, number);
    if (changed) value = static_cast<Value>(number);
    return changed;
  }

  template <std::integral Value>
  bool Whole(const char* field, Value& value) {
    auto number = static_cast<std::int64_t>(value);
    const bool changed = VisitWhole(field, number);
    if (changed) value = static_cast<Value>(number);
    return changed;
  }

  /// @param radians  [rad] or [rad/s]; the field is in degrees.
  bool Degrees(const char* field, double& radians) {
    double degrees = radians / kDegree;
    const bool changed = VisitNumber(field, degrees);
    if (changed) radians = degrees * kDegree;
    return changed;
  }

  bool Seconds(const char* field, Duration& duration) {
    double seconds = thalweg::Seconds(duration);
    const bool changed = VisitNumber(field, seconds);
    if (changed) duration = FromSeconds(seconds);
    return changed;
  }

  bool Switch(const char* field, bool& value) { return VisitSwitch(field, value); }

  bool Text(const char* field, std::string& value) { return VisitText(field, value); }

  /// @param names  Names of all values, as in the schema.
  template <class Value>
  bool Choice(const char* field, Value& value,
              std::initializer_list<std::pair<std::string_view, Value>> names) {
    std::string name;
    for (const auto& [known, its_value] : names) {
      if (its_value == value) name = known;
    }
    THALWEG_CHECK(!name.empty());
    if (!VisitText(field, name)) return false;
    for (const auto& [known, its_value] : names) {
      if (known != name) continue;
      value = its_value;
      return true;
    }
    THALWEG_CHECK(!"the schema has a name that the binding lacks");
    return false;
  }

  /// @param value  Three numbers x, y, z, accessed by index.
  template <class Value>
  bool Vector(const char* field, Value& value) {
    std::array<double, 3> numbers = {value[0], value[1], value[2]};
    const bool changed = VisitVector(field, numbers);
    for (int k = 0; changed && k < 3; ++k) value[k] = numbers[static_cast<std::size_t>(k)];
    return changed;
  }

  /// Options for which the scenario has a block of its own.
  void Block(const char* field, const std::function<void(OptionVisitor&)>& visit) {
    VisitBlock(field, visit);
  }

 private:
  virtual bool VisitNumber(const char* field, double& value) = 0;
  virtual bool VisitWhole(const char* field, std::int64_t& value) = 0;
  virtual bool VisitSwitch(const char* field, bool& value) = 0;
  /// Free text, or the name of a choice.
  virtual bool VisitText(const char* field, std::string& value) = 0;
  virtual bool VisitVector(const char* field, std::array<double, 3>& value) = 0;
  virtual void VisitBlock(const char* field, const std::function<void(OptionVisitor&)>& visit) = 0;
};

}  // namespace thalweg
