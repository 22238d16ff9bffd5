#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

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

/// The first `most` characters of a text in UTF-8; never splits a character.
std::string_view FirstCharacters(std::string_view text, std::size_t most);

}  // namespace thalweg
