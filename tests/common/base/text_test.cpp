#include "common/base/text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace thalweg {
namespace {

constexpr auto kBad = "\uFFFD";

std::string Repeated(std::string_view text, std::size_t times) {
  std::string all;
  for (std::size_t k = 0; k < times; ++k) all += text;
  return all;
}

/// nlohmann's decoder of UTF-8, which throws on text that is not well-formed.
bool IsWellFormed(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

TEST(Trimmed, CutsBlanksAtBothEndsAlone) {
  EXPECT_EQ(Trimmed(" \ta b\r"), "a b");
  EXPECT_EQ(Trimmed(" \t "), "");
}

TEST(Joined, PutsSeparatorsBetweenTextsEvenIfTheFirstIsEmpty) {
  EXPECT_EQ(Joined(std::vector<std::string>{}), "");
  EXPECT_EQ(Joined(std::vector<std::string>{"a", "b"}), "a, b");
  EXPECT_EQ(Joined(std::vector<std::string>{"", "b"}, "; "), "; b");
}

TEST(NumberText, HasNoZerosAtItsEnd) {
  EXPECT_EQ(NumberText(0.15), "0.15");
  EXPECT_EQ(NumberText(6.0), "6");
  EXPECT_EQ(NumberText(-1e-6), "-1e-06");
}

TEST(CleanText, LeavesPlainTextOfAnyLanguageUnchanged) {
  for (const char* text : {"", "moving to a frontier, 3.2 m", "Überlauf – 44 m³", "障害物", "🚪 → 🛋"}) {
    EXPECT_EQ(CleanText(text), text);
  }
}

TEST(CleanText, DisarmsWhatATerminalWouldObey) {
  EXPECT_EQ(CleanText("\x1B[2J\x1B]0;owned\x07"), std::string(kBad) + "[2J" + kBad + "]0;owned" + kBad);
  EXPECT_EQ(CleanText(std::string_view("a\0b\x7F" "c", 5)), std::string("a") + kBad + "b" + kBad + "c");
  EXPECT_EQ(CleanText("\u009B31m"), std::string(kBad) + "31m");  // the C1 form of ESC [
  EXPECT_EQ(CleanText("\x9B" "31m"), std::string(kBad) + "31m");  // the same as a single byte
  EXPECT_EQ(CleanText("complete\r\n[error] forged\tline"), "complete  [error] forged line");
}

TEST(CleanText, DisarmsWhatReordersOrHidesText) {
  for (const char* hidden : {"\u202E", "\u2066", "\u200B", "\u2028", "\uFEFF", "\u00AD", "\U000E0041"}) {
    EXPECT_EQ(CleanText(std::string("a") + hidden + "b"), std::string("a") + kBad + "b");
  }
}

TEST(CleanText, ReplacesEachByteOfIllFormedUtf8) {
  EXPECT_EQ(CleanText("a\xFF" "b"), std::string("a") + kBad + "b");
  EXPECT_EQ(CleanText("\xC0\xAF"), Repeated(kBad, 2));          // "/" in two bytes
  EXPECT_EQ(CleanText("\xE0\x80\xAF"), Repeated(kBad, 3));      // "/" in three
  EXPECT_EQ(CleanText("\xED\xA0\x80"), Repeated(kBad, 3));      // a surrogate
  EXPECT_EQ(CleanText("\xF4\x90\x80\x80"), Repeated(kBad, 4));  // beyond U+10FFFF
  EXPECT_EQ(CleanText("\xE2\x82"), Repeated(kBad, 2));          // cut off
  EXPECT_EQ(CleanText("\x80x"), std::string(kBad) + "x");       // continues nothing
}

TEST(CleanText, ClampsLongTextWithoutSplittingACharacter) {
  const std::string exact = Repeated("ü", kMostCharacters);
  EXPECT_EQ(CleanText(exact), exact);
  EXPECT_EQ(CleanText(exact + "x"), Repeated("ü", kMostCharacters - 1) + "…");
  EXPECT_EQ(CleanText("abcdef", 3), "ab…");
  EXPECT_EQ(CleanText("abcdef", 0), "");
  EXPECT_LE(CleanText(std::string(10'000'000, '\x1B')).size(), 3 * kMostCharacters);
}

TEST(CleanText, AnyBytesBecomeWellFormedTextWithoutControlCharacters) {
  std::mt19937 random(7);
  for (int n = 0; n < 5000; ++n) {
    std::string bytes(random() % 40, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const std::string clean = CleanText(bytes);
    ASSERT_TRUE(IsWellFormed(clean));
    for (const char c : clean) ASSERT_FALSE((c >= 0 && c < 0x20) || c == 0x7F);
    ASSERT_EQ(CleanText(clean), clean);
  }
}

TEST(FirstCharacters, CountsCharactersAndNotBytes) {
  EXPECT_EQ(FirstCharacters("aüb", 2), "aü");
  EXPECT_EQ(FirstCharacters("aüb", 9), "aüb");
  EXPECT_EQ(FirstCharacters("aüb", 0), "");
}

}  // namespace
}  // namespace thalweg
