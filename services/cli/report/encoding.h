#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace thalweg::cli {

// How data gets into a page that is a single file.

/// RFC 4648, with padding.
std::string Base64(std::span<const std::uint8_t> bytes);

/// Compresses to the zlib format (RFC 1950), which browsers read with DecompressionStream("deflate").
std::vector<std::uint8_t> Deflated(std::span<const std::uint8_t> bytes);

/// Text with the characters replaced that have a meaning in HTML.
std::string EscapedForHtml(std::string_view text);

/// JSON that may stand within a `<script>` element: no text in it can end the element or begin another, since
/// '<', '>' and '&' only occur as escape sequences. Bytes that are not UTF-8 are replaced.
std::string JsonForScript(const nlohmann::ordered_json& json);

}  // namespace thalweg::cli
