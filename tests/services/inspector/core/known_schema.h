#pragma once

#include <string>

#include "common/dds/schema.h"
#include "services/inspector/core/schema.h"

namespace thalweg::inspector {

/// The schema of a type that one of our topics has.
inline Schema SchemaOf(const std::string& type) {
  return *Schema::Parse(type, dds::Ros2MsgSchema(type));
}

}  // namespace thalweg::inspector
