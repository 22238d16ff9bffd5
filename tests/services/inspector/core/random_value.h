#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <string_view>

#include "services/inspector/core/schema.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

/// Values of any type of a schema, with all that is hard to carry: numbers at the ends of their ranges, NaN,
/// infinities, empty and long sequences, texts with quotes, line breaks, control characters and bytes that
/// are no UTF-8.
class RandomValue {
 public:
  RandomValue(const Schema& schema, unsigned seed) : schema_(schema), random_(seed) {}

  Value Make(const FieldType& type) {
    if (type.arity == Arity::kOne) return MakeOne(type);
    constexpr std::array<std::size_t, 5> kLengths = {0, 1, 2, 5, 17};
    std::size_t count = type.arity == Arity::kArray ? type.length : kLengths[Below(kLengths.size())];
    if (type.arity == Arity::kSequence && IsNumber(type.kind) && Below(4) == 0) count = 3000;
    if (IsNumber(type.kind)) {
      Numbers numbers(type.kind);
      for (std::size_t k = 0; k < count; ++k) numbers.Append(MakeNumber(type.kind));
      return {std::move(numbers)};
    }
    std::vector<Value> values;
    for (std::size_t k = 0; k < count; ++k) values.push_back(MakeOne(type.element()));
    return {std::move(values)};
  }

  /// Whether texts may hold a zero byte, which fastcdr takes for their end.
  bool zero_bytes = true;

 private:
  std::size_t Below(std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random_);
  }

  Value MakeOne(const FieldType& type) {
    if (type.kind == Kind::kString) return {MakeText()};
    if (type.kind != Kind::kMessage) return {MakeNumber(type.kind)};
    std::vector<Value> values;
    for (const Field& field : schema_.message(type).fields) values.push_back(Make(field.type));
    return {std::move(values)};
  }

  Number MakeNumber(Kind kind) {
    Numbers one(kind);
    WithTypeOf(kind, [&]<class T>(T value) {
      using Limits = std::numeric_limits<T>;
      const std::array<T, 8> edges = {T{0},
                                      T{1},
                                      Limits::lowest(),
                                      Limits::max(),
                                      Limits::min(),
                                      Limits::infinity(),
                                      Limits::quiet_NaN(),
                                      Limits::denorm_min()};
      value = edges[Below(edges.size())];
      const std::uint64_t bits = random_();
      if (Below(2) == 0) std::memcpy(&value, &bits, sizeof value);
      if constexpr (std::is_floating_point_v<T>) {
        if (std::isnan(value)) value = Limits::quiet_NaN();  // text keeps no other
        one.Append(std::is_same_v<T, float> ? Number(static_cast<float>(value))
                                            : Number(static_cast<double>(value)));
      } else {
        one.Append(kind == Kind::kBool ? Number(std::uint64_t{bits & 1U}) : ToNumber(value));
      }
    });
    return one.At(0);
  }
  template <class T>
  static Number ToNumber(T value) {
    if constexpr (std::is_signed_v<T>) return static_cast<std::int64_t>(value);
    return static_cast<std::uint64_t>(value);
  }

  std::string MakeText() {
    using std::string_view_literals::operator""sv;
    constexpr std::array kPieces = {"map"sv,
                                    "a b"sv,
                                    " "sv,
                                    "'"sv,
                                    "\""sv,
                                    "\n"sv,
                                    "\t"sv,
                                    "\\"sv,
                                    "\x1b[2J"sv,
                                    "\x7f"sv,
                                    ": "sv,
                                    "# "sv,
                                    "- "sv,
                                    "{"sv,
                                    "]"sv,
                                    "null"sv,
                                    "~"sv,
                                    "1.5"sv,
                                    "\r\n"sv,
                                    "\xc2\x85"sv,
                                    "\xe2\x80\xa8"sv,
                                    "\xef\xbb\xbf"sv,
                                    "\xf0\x9f\xa4\x96"sv,
                                    "gr\xc3\xbc"
                                    "n"sv,
                                    "\xff\xfe"sv,
                                    "%"sv,
                                    "!"sv,
                                    "&"sv,
                                    "*"sv,
                                    "@"sv,
                                    "|"sv,
                                    ">"sv,
                                    "---"sv,
                                    "..."sv,
                                    ","sv};
    std::string text;
    for (std::size_t pieces = Below(5); pieces > 0; --pieces) text += kPieces[Below(kPieces.size())];
    if (zero_bytes && Below(10) == 0) text += '\0';
    return text;
  }

  const Schema& schema_;
  std::mt19937_64 random_;
};

}  // namespace thalweg::inspector
