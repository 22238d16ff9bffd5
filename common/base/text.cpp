#include "common/base/text.h"

#include <array>
#include <cstdint>
#include <cstdio>

namespace thalweg {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD
constexpr std::string_view kEllipsis = "\xE2\x80\xA6";     // U+2026

std::uint32_t ByteAt(std::string_view text, std::size_t k) {
  return static_cast<unsigned char>(text[k]);
}

bool IsSpaceControl(std::uint32_t code) {
  return code == '\t' || code == '\n' || code == '\r';
}

}  // namespace

Character FirstCharacter(std::string_view text) {
  const std::uint32_t lead = ByteAt(text, 0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  // A code below this one has a shorter form, which makes the longer one ill-formed.
  const std::uint32_t least = bytes == 4 ? 0x10000 : bytes == 3 ? 0x800 : 0x80;
  if (lead < 0xC0 || lead > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0xFFU >> (bytes + 1));
  for (std::size_t k = 1; k < bytes; ++k) {
    const std::uint32_t next = ByteAt(text, k);
    if ((next & 0xC0U) != 0x80) return {};
    code = code << 6 | (next & 0x3FU);
  }
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < least || code > 0x10FFFF || surrogate) return {};
  return {code, bytes};
}

bool IsControlCharacter(std::uint32_t code) {
  const auto within = [code](std::uint32_t first, std::uint32_t last) {
    return code >= first && code <= last;
  };
  return code < 0x20 || within(0x7F, 0x9F) || code == 0xAD || code == 0x61C || within(0x200B, 0x200F) ||
         within(0x2028, 0x202E) || within(0x2060, 0x206F) || code == 0xFEFF || within(0xFFF9, 0xFFFB) ||
         within(0xE0000, 0xE007F);
}

std::string CleanText(std::string_view text, std::size_t most) {
  std::string clean;
  std::size_t last_begins = 0;  // where the last character of `clean` begins, which an ellipsis would replace
  for (std::size_t count = 0; !text.empty(); ++count) {
    if (count == most) {
      clean.resize(last_begins);
      if (most > 0) clean += kEllipsis;
      break;
    }
    last_begins = clean.size();
    const Character first = FirstCharacter(text);
    if (first.bytes == 0) {
      clean += kReplacement;
      text.remove_prefix(1);
      continue;
    }
    if (IsSpaceControl(first.code)) {
      clean += ' ';
    } else if (IsControlCharacter(first.code)) {
      clean += kReplacement;
    } else {
      clean += text.substr(0, first.bytes);
    }
    text.remove_prefix(first.bytes);
  }
  return clean;
}

std::string NumberText(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

std::string_view FirstCharacters(std::string_view text, std::size_t most) {
  std::size_t end = 0;
  for (std::size_t count = 0; count < most && end < text.size(); ++count) {
    const std::size_t bytes = FirstCharacter(text.substr(end)).bytes;
    end += bytes == 0 ? 1 : bytes;
  }
  return text.substr(0, end);
}

}  // namespace thalweg
