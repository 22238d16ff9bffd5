#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "services/inspector/core/schema.h"

namespace thalweg::inspector {

/// One number, as wide as any: bool and unsigned numbers are std::uint64_t, signed ones std::int64_t, float32
/// stays float, so that it is printed with its own digits.
using Number = std::variant<std::uint64_t, std::int64_t, float, double>;

/// Bytes of a number on the wire; 0 for what is no number.
constexpr std::size_t SizeOf(Kind kind) {
  switch (kind) {
    case Kind::kBool:
    case Kind::kInt8:
    case Kind::kUint8:
      return 1;
    case Kind::kInt16:
    case Kind::kUint16:
      return 2;
    case Kind::kInt32:
    case Kind::kUint32:
    case Kind::kFloat32:
      return 4;
    case Kind::kInt64:
    case Kind::kUint64:
    case Kind::kFloat64:
      return 8;
    default:
      return 0;
  }
}

/// Calls `use` with a value of the C++ type that holds a number of this kind.
template <class Use>
void WithTypeOf(Kind kind, Use&& use) {
  switch (kind) {
    case Kind::kBool:
    case Kind::kUint8:
      return use(std::uint8_t{});
    case Kind::kInt8:
      return use(std::int8_t{});
    case Kind::kInt16:
      return use(std::int16_t{});
    case Kind::kUint16:
      return use(std::uint16_t{});
    case Kind::kInt32:
      return use(std::int32_t{});
    case Kind::kUint32:
      return use(std::uint32_t{});
    case Kind::kInt64:
      return use(std::int64_t{});
    case Kind::kUint64:
      return use(std::uint64_t{});
    case Kind::kFloat32:
      return use(float{});
    case Kind::kFloat64:
      return use(double{});
    default:
      return;
  }
}

/// Numbers of one kind, as many as an array or a sequence holds, in the bytes and byte order of this machine,
/// so that an image costs no more than its pixels.
class Numbers {
 public:
  explicit Numbers(Kind kind) : kind_(kind) {}

  Kind kind() const { return kind_; }
  std::size_t size() const { return bytes_.size() / SizeOf(kind_); }
  std::vector<std::uint8_t>& bytes() { return bytes_; }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

  Number At(std::size_t k) const {
    Number number;
    WithTypeOf(kind_, [&]<class T>(T value) {
      std::memcpy(&value, bytes_.data() + k * sizeof value, sizeof value);
      if constexpr (std::is_floating_point_v<T>) {
        number = value;
      } else if constexpr (std::is_signed_v<T>) {
        number = static_cast<std::int64_t>(value);
      } else {
        number = static_cast<std::uint64_t>(value);
      }
    });
    return number;
  }
  /// Appends a number, which must be within the range of the kind.
  void Append(const Number& number) {
    WithTypeOf(kind_, [&]<class T>(T value) {
      value = std::visit([](const auto content) { return static_cast<T>(content); }, number);
      const std::size_t before = bytes_.size();
      bytes_.resize(before + sizeof value);
      std::memcpy(bytes_.data() + before, &value, sizeof value);
    });
  }

  bool operator==(const Numbers&) const = default;

 private:
  Kind kind_;
  std::vector<std::uint8_t> bytes_;
};

/// A value of any type of a schema, which alone knows its names: a number, a text, numbers, or several
/// values: the fields of a message in their order, or messages or texts in an array or sequence.
struct Value {
  std::variant<Number, std::string, Numbers, std::vector<Value>> content;

  bool operator==(const Value&) const = default;

  const Number& number() const { return std::get<Number>(content); }
  const std::string& text() const { return std::get<std::string>(content); }
  const Numbers& numbers() const { return std::get<Numbers>(content); }
  const std::vector<Value>& values() const { return std::get<std::vector<Value>>(content); }

  /// Number of elements of an array or sequence.
  std::size_t size() const {
    const auto* const packed = std::get_if<Numbers>(&content);
    return packed != nullptr ? packed->size() : values().size();
  }
  /// One element of an array or sequence.
  Value At(std::size_t k) const {
    const auto* const packed = std::get_if<Numbers>(&content);
    return packed != nullptr ? Value{packed->At(k)} : values()[k];
  }
};

/// The value that a message holds where nothing else is said: zeros, empty texts and sequences, arrays of
/// zeros.
Value ZeroOf(const Schema& schema, const FieldType& type);

}  // namespace thalweg::inspector
