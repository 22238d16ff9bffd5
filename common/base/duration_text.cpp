#include "common/base/duration_text.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace thalweg {
namespace {

std::string Rounded(double value, int digits, const char* unit) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.*f %s", digits, value, unit);
  return text.data();
}

}  // namespace

std::string DurationText(double seconds) {
  constexpr double kMinute = 60.0;
  constexpr double kHour = 60.0 * kMinute;
  constexpr double kDay = 24.0 * kHour;
  constexpr double kYear = 365.25 * kDay;
  const double s = std::abs(seconds);
  if (s < 10.0) return Rounded(s, 2, "s");
  if (s < 2.0 * kMinute) return Rounded(s, 0, "s");
  if (s < 2.0 * kHour) return Rounded(s / kMinute, 0, "min");
  if (s < 2.0 * kDay) return Rounded(s / kHour, 0, "h");
  if (s < 2.0 * kYear) return Rounded(s / kDay, 0, "days");
  return Rounded(s / kYear, 0, "years");
}

}  // namespace thalweg
