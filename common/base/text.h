#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace thalweg {

/// Characters that remain of a text from outside: enough for every reason and activity of our own services.
inline constexpr std::size_t kMostCharacters = 200;

/// Makes a text from outside, such as a string in a message, safe for a terminal, a log, JSON and a page: one
/// line of valid UTF-8 of at most `most` characters. Replaces by U+FFFD each control character (C0, DEL, C1),
/// each character that reverses, joins or hides its neighbors (bidirectional controls, line separators,
/// zero-width characters) and each byte that is not part of well-formed UTF-8 [The Unicode Standard 15.0,
/// table 3-7]. Tabs and line breaks become spaces. A longer text ends with U+2026, which counts.
std::string CleanText(std::string_view text, std::size_t most = kMostCharacters);

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0 = not well-formed.
};
/// Decodes the first character of a text in UTF-8, which must not be empty.
Character FirstCharacter(std::string_view text);

/// Whether a character controls how a terminal or a page shows others instead of being shown itself: those
/// that CleanText replaces, tabs and line breaks included.
bool IsControlCharacter(std::uint32_t code);

/// Most characters of a name that a message states, such as a strategy's.
inline constexpr std::size_t kLongestName = 64;

/// The text without the spaces, tabs and carriage returns at both ends.
inline std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Joins texts to "a, b, c".
template <class Texts>
std::string Joined(const Texts& texts, std::string_view separator = ", ") {
  std::string joined;
  bool is_first = true;
  for (const auto& text : texts) {
    if (!std::exchange(is_first, false)) joined += separator;
    joined += text;
  }
  return joined;
}

/// Formats a number for a message, with at most six digits and no zeros at the end: "0.15", "1e-06".
std::string NumberText(double value);

/// The first `most` characters of a text in UTF-8; never splits a character.
std::string_view FirstCharacters(std::string_view text, std::size_t most);

}  // namespace thalweg
