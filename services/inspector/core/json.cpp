#include "services/inspector/core/json.h"

#include <yaml-cpp/binary.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace thalweg::inspector {
namespace {

using nlohmann::ordered_json;

ordered_json JsonOf(const Number& number) {
  return std::visit(
      []<class T>(T value) -> ordered_json {
        if constexpr (std::is_floating_point_v<T>) {
          if (!std::isfinite(value)) return nullptr;
        }
        return value;
      },
      number);
}

ordered_json JsonOf(const Schema& schema, const FieldType& type, const Value& value);

ordered_json ListOf(const Schema& schema, const FieldType& type, const Value& value) {
  if (type.kind == Kind::kUint8) {
    const auto& bytes = value.numbers().bytes();
    return YAML::EncodeBase64(bytes.data(), bytes.size());
  }
  ordered_json list = ordered_json::array();
  for (std::size_t k = 0; k < value.size(); ++k) list.push_back(JsonOf(schema, type.element(), value.At(k)));
  return list;
}

ordered_json JsonOf(const Schema& schema, const FieldType& type, const Value& value) {
  if (type.arity != Arity::kOne) return ListOf(schema, type, value);
  if (type.kind == Kind::kBool) return std::get<std::uint64_t>(value.number()) != 0;
  if (IsNumber(type.kind)) return JsonOf(value.number());
  if (type.kind == Kind::kString) return value.text();
  ordered_json object = ordered_json::object();
  const std::vector<Field>& fields = schema.message(type).fields;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    object[fields[k].name] = JsonOf(schema, fields[k].type, value.values()[k]);
  }
  return object;
}

}  // namespace

std::string ToJson(const Schema& schema, const FieldType& type, const Value& value) {
  return JsonOf(schema, type, value).dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace thalweg::inspector
