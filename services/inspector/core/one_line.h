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

/// Whether a row of CSV has the elements of arrays and sequences.
enum class Arrays { kWhole, kLeftOut };

/// All single values in their order, separated by commas, as `ros2 topic echo --csv` prints them; quoted
/// where a text holds a comma, a quote or a space [RFC 4180]. Texts are cleaned.
/// Departure: arrays are never cut, which a program that reads the row could not see.
std::string ToCsv(const Schema& schema, const FieldType& type, const Value& value, Arrays arrays);

}  // namespace thalweg::inspector
