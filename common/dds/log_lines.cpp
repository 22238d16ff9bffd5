#include "common/dds/log_lines.h"

#include <iterator>
#include <utility>

#include "common/base/text.h"
#include "common/dds/convert.h"

namespace thalweg::dds {

void LogLines::Add(LogLine line) {
  const std::lock_guard lock(mutex_);
  if (lines_.size() == kMost) {
    ++left_out_;
    return;
  }
  if (line.text.size() > kLongest) line.text.resize(kLongest);
  lines_.push_back(std::move(line));
}

std::vector<LogLine> LogLines::Take() {
  const std::lock_guard lock(mutex_);
  std::vector<LogLine> lines(std::make_move_iterator(lines_.begin()), std::make_move_iterator(lines_.end()));
  lines_.clear();
  if (const std::size_t left_out = std::exchange(left_out_, 0); left_out > 0) {
    lines.push_back({.stamp = lines.back().stamp,
                     .level = LogLevel::kWarning,
                     .text = std::to_string(left_out) + " more lines are only in the log of the process"});
  }
  return lines;
}

rcl_interfaces::msg::Log ToIdl(const LogLine& line, const std::string& service) {
  rcl_interfaces::msg::Log message;
  message.stamp(ToIdl(line.stamp));
  message.level(static_cast<std::uint8_t>(line.level));
  message.name(service);
  message.msg(CleanText(line.text, LogLines::kLongest));
  return message;
}

}  // namespace thalweg::dds
