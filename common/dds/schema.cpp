#include "common/dds/schema.h"

#include <algorithm>
#include <array>

namespace thalweg::dds {
namespace {

struct Schema {
  std::string_view type;
  std::string_view text;
  std::string_view description;
};

// constexpr Schema kSchemas[] = {{"pkg/msg/Name", R"schema(...)schema", R"schema({...})schema"}, ...};
#include "schema_table.inc"

}  // namespace

std::string_view Ros2MsgSchema(std::string_view type) {
  const auto* const found = std::ranges::find(kSchemas, type, &Schema::type);
  return found == std::end(kSchemas) ? std::string_view() : found->text;
}

std::string_view TypeDescription(std::string_view type) {
  const auto* const found = std::ranges::find(kSchemas, type, &Schema::type);
  return found == std::end(kSchemas) ? std::string_view() : found->description;
}

std::string Ros2TypeName(std::string_view wire_name) {
  constexpr std::string_view kMiddle = "::msg::dds_::";
  const std::size_t middle = wire_name.find(kMiddle);
  if (middle == std::string_view::npos || !wire_name.ends_with('_')) return std::string(wire_name);
  const std::string_view name = wire_name.substr(middle + kMiddle.size());
  return std::string(wire_name.substr(0, middle)) + "/msg/" + std::string(name.substr(0, name.size() - 1));
}

std::string WireTypeName(std::string_view ros2_name) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t middle = ros2_name.find(kMiddle);
  if (middle == std::string_view::npos) return std::string(ros2_name);
  return std::string(ros2_name.substr(0, middle)) +
         "::msg::dds_::" + std::string(ros2_name.substr(middle + kMiddle.size())) + "_";
}

}  // namespace thalweg::dds
