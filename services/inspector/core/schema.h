#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace thalweg::inspector {

/// What one value on the wire is.
enum class Kind {
  kBool,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kString,
  kMessage,
};

constexpr bool IsNumber(Kind kind) {
  return kind != Kind::kString && kind != Kind::kMessage;
}

enum class Arity {
  kOne,
  kArray,     ///< A fixed number of values.
  kSequence,  ///< Any number of values.
};

struct FieldType {
  Kind kind = Kind::kMessage;
  std::size_t message = 0;  ///< For Kind::kMessage: index in the schema.
  Arity arity = Arity::kOne;
  std::size_t length = 0;  ///< For Arity::kArray: number of values.

  /// The type of one element of an array or sequence.
  FieldType element() const { return {.kind = kind, .message = message}; }
};

/// A number with a name, such as a value of an enum.
struct Constant {
  std::string name;
  std::uint64_t value = 0;
};

struct Field {
  std::string name;
  FieldType type;
  std::vector<Constant> constants;  ///< Names of its values, those that stand right above it.
};

struct MessageType {
  std::string name;  ///< "geometry_msgs/Point"
  std::vector<Field> fields;
};

/// A message type and all types that it contains, parsed from a definition in the form "ros2msg" of MCAP
/// [https://mcap.dev/spec/registry]: the text of the type, then, each behind a line of "=", "MSG:
/// PACKAGE/NAME" and the text of that type. Bounded strings and sequences and default values are not
/// understood, see Definitions, nor are wide strings.
class Schema {
 public:
  /// @param type  Name of the type, "geometry_msgs/msg/Pose".
  /// Fails, naming the line, for text that is not such a definition, and for types that contain themselves.
  static Result<Schema> Parse(std::string_view type, std::string_view text);

  const MessageType& message(std::size_t index) const { return messages_[index]; }
  const MessageType& message(const FieldType& type) const { return messages_[type.message]; }
  std::size_t size() const { return messages_.size(); }
  FieldType root() const { return {.kind = Kind::kMessage, .message = 0}; }

  /// "float64[36]", "geometry_msgs/Point[]": as a definition writes it.
  std::string NameOf(const FieldType& type) const;

 private:
  std::vector<MessageType> messages_;
};

}  // namespace thalweg::inspector
