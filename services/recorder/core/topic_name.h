#pragma once

#include <string_view>

namespace thalweg::recorder {

/// A topic's name on the bus. Recordings and people often begin a name with a slash, which means nothing.
constexpr std::string_view BusName(std::string_view topic) {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  return topic;
}

}  // namespace thalweg::recorder
