#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

/// A part of a message, as a person writes it: "pose.pose.position", "transforms[0].header", "data[12]".
class FieldPath {
 public:
  /// Fails, naming what is wrong and which fields there are, for a path that the schema's type does not have.
  static Result<FieldPath> Parse(const Schema& schema, std::string_view path);

  /// Type of the part.
  const FieldType& type() const { return type_; }
  /// The part of a message of the schema's type. Fails if a sequence is too short.
  Result<Value> In(const Value& message) const;

 private:
  /// Either a field of a message or an element of an array or sequence.
  struct Step {
    std::size_t index;
    std::string name;  ///< Up to and including this step.
  };
  FieldType type_;
  std::vector<Step> steps_;
};

}  // namespace thalweg::inspector
