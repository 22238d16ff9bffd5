#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include "services/recorder/core/topic_name.h"

namespace thalweg::recorder {

/// Whether a topic's name matches a pattern, in which * stands for any characters: "stereo/*". A leading
/// slash of either means nothing.
constexpr bool Matches(std::string_view pattern, std::string_view topic) {
  pattern = BusName(pattern);
  topic = BusName(topic);
  // The shortest text for each star but the last suffices: wherever it ends, the rest may begin there or
  // later.
  std::size_t p = 0;
  std::size_t t = 0;
  std::size_t star = std::string_view::npos;
  std::size_t after_star = 0;
  while (t < topic.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after_star = t;
    } else if (p < pattern.size() && pattern[p] == topic[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++after_star;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// Whether it matches one of the patterns.
constexpr bool MatchesAny(std::span<const std::string> patterns, std::string_view topic) {
  return std::ranges::any_of(patterns, [&](const std::string& pattern) { return Matches(pattern, topic); });
}

}  // namespace thalweg::recorder
