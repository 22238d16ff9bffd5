#pragma once

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "common/base/text.h"

namespace thalweg::mapper {

// What the readers of files with a header of text share.

/// Takes a line from the front of a text, without the spaces at its ends; nothing if no line ends.
inline std::optional<std::string_view> TakeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return Trimmed(line);
}

/// Takes a word from the front of a text; empty if there is none.
inline std::string_view TakeWord(std::string_view& text, std::string_view spaces = " \t\r\n") {
  text.remove_prefix(std::min(text.find_first_not_of(spaces), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(spaces));
  text.remove_prefix(word.size());
  return word;
}

/// The number that a whole text is, nothing if it is none.
template <class Number = double>
std::optional<Number> NumberIn(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace thalweg::mapper
