#pragma once

#include <cstddef>
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

/// The first `most` characters of a text in UTF-8; never splits a character.
std::string_view FirstCharacters(std::string_view text, std::size_t most);

}  // namespace thalweg
