#include "common/base/ros_name.h"

namespace thalweg {

bool IsRosName(std::string_view text) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  char before = '/';
  for (const char c : text) {
    const bool begins_word = before == '/';
    const bool may_stand = c == '/'   ? !begins_word
                           : c == '_' ? before != '_'
                                      : is_letter(c) || (c >= '0' && c <= '9' && !begins_word);
    if (!may_stand) return false;
    before = c;
  }
  return before != '/';  // also of an empty text
}

}  // namespace thalweg
