#pragma once

#include <string>

#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

/// The value as JSON on one line [RFC 8259]: messages are objects, arrays and sequences are lists, but those
/// of uint8, which are base64. Numbers that are not finite are null; bytes of a text that are not UTF-8 are
/// replaced by U+FFFD.
std::string ToJson(const Schema& schema, const FieldType& type, const Value& value);

}  // namespace thalweg::inspector
