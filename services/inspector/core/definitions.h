#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace thalweg::inspector {

/// Definitions of message types, each in the form of a .msg file
/// [https://docs.ros.org/en/humble/Concepts/Basic/ About-Interfaces.html], joined to what Schema::Parse
/// takes.
class Definitions {
 public:
  /// @param text  The definitions, each after a line "MSG: PACKAGE/NAME".
  explicit Definitions(std::string_view text);

  /// The text of a type's .msg file; nothing if there is none.
  using Lookup =
      std::function<std::optional<std::string>(const std::string& package, const std::string& name)>;

  /// The definition of a type and of all types that it contains, with full names and without comments,
  /// default values and bounds, which the wire does not show.
  /// @param type    "sensor_msgs/msg/Imu" or "sensor_msgs/Imu".
  /// @param others  Asked for types that are not here.
  /// Fails for a type that is neither here nor there, naming it and what contains it.
  Result<std::string> Assemble(std::string_view type, const Lookup& others) const;

 private:
  std::map<std::string, std::string> texts_;  ///< By "PACKAGE/NAME".
};

}  // namespace thalweg::inspector
