#pragma once

#include <string>

#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

/// The value as one line for a person: "12.340 map  state=MOVING  target=(1.2, 0, 1.5)  set_aside=[3
/// SetAside]". Stamp and frame of a header come first; short records of numbers are points, quaternions
/// angles, numbers with names their names; long arrays are counted; empty texts and lists are left out. Texts
/// are cleaned.
std::string ToLine(const Schema& schema, const FieldType& type, const Value& value);

/// All single values in their order, separated by commas, as `ros2 topic echo --csv` prints them; quoted
/// where a text holds a comma, a quote or a space [RFC 4180]. Texts are cleaned.
/// @param most_elements  Most elements of an array or sequence; more are left out.
std::string ToCsv(const Schema& schema, const FieldType& type, const Value& value, std::size_t most_elements);

}  // namespace thalweg::inspector
