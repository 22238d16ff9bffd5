#include "services/gateway/core/json_text.h"

namespace thalweg::gateway {

using nlohmann::json;

std::optional<json> ParseObject(std::string_view text) {
  // Deep nesting is refused before the parser's result is torn down recursively.
  constexpr int kMaxDepth = 16;
  const auto limit = [](int depth, json::parse_event_t, json&) { return depth <= kMaxDepth; };
  json object = json::parse(text, limit, false);
  if (object.is_discarded() || !object.is_object()) return std::nullopt;
  return object;
}

std::string Dump(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace thalweg::gateway
