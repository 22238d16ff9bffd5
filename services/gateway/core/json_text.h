#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace thalweg::gateway {

/// Reads a JSON object that a client has sent; nothing if the text is none.
std::optional<nlohmann::json> ParseObject(std::string_view text);

/// Names from the wire may hold bytes that are not UTF-8, which must not throw when they are quoted.
std::string Dump(const nlohmann::json& value);

}  // namespace thalweg::gateway
