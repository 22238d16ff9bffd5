#include "services/inspector/core/value.h"

namespace thalweg::inspector {

Value ZeroOf(const Schema& schema, const FieldType& type) {
  if (type.arity != Arity::kOne) {
    const std::size_t count = type.arity == Arity::kArray ? type.length : 0;
    if (IsNumber(type.kind)) {
      Numbers zeros(type.kind);
      zeros.bytes().resize(count * SizeOf(type.kind));
      return {std::move(zeros)};
    }
    return {std::vector<Value>(count, ZeroOf(schema, type.element()))};
  }
  if (type.kind == Kind::kString) return {std::string()};
  if (type.kind == Kind::kMessage) {
    std::vector<Value> values;
    for (const Field& field : schema.message(type).fields) values.push_back(ZeroOf(schema, field.type));
    return {std::move(values)};
  }
  Numbers zero(type.kind);
  zero.Append(std::uint64_t{0});
  return {zero.At(0)};
}

}  // namespace thalweg::inspector
