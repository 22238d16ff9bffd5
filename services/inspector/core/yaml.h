#pragma once

#include <limits>
#include <string>

#include "common/base/result.h"
#include "common/base/time.h"
#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

struct PrintOptions {
  /// Elements of an array or sequence beyond these are only counted.
  std::size_t most_elements = 128;
  bool arrays = true;  ///< Whether elements are shown at all, rather than an array's type and length.

  /// All that the message holds, so that ParseYaml returns the same value.
  static PrintOptions Everything() { return {.most_elements = std::numeric_limits<std::size_t>::max()}; }
};

/// The value in YAML 1.2, laid out as `ros2 topic echo` prints it. Characters that a terminal would obey are
/// escaped; a text that is not UTF-8 is base64 with the tag !!binary. Ends with a line break.
std::string ToYaml(const Schema& schema, const FieldType& type, const Value& value,
                   const PrintOptions& options = {});

/// A number as YAML writes it: 1.0, 1.0e-12, .nan, -.inf, 7; the shortest that reads back as the same.
std::string YamlNumber(const Number& number);

/// The inverse. Fields that the text leaves out are as ZeroOf makes them. A number may be given as the name
/// of one of its constants, and a time as `now`. Fails with the path of the field that is wrong.
Result<Value> ParseYaml(const Schema& schema, const std::string& text, Time now);

}  // namespace thalweg::inspector
