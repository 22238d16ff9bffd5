#pragma once

#include <rcl_interfaces.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/time.h"

namespace thalweg::dds {

/// As in rcl_interfaces/msg/Log.
enum class LogLevel : std::uint8_t { kDebug = 10, kInfo = 20, kWarning = 30, kError = 40, kFatal = 50 };

struct LogLine {
  Time stamp;  ///< The machine's clock.
  LogLevel level = LogLevel::kInfo;
  std::string text;
};

/// The log lines of a process that are yet to be published. Bounded: of a process that logs faster than they
/// are taken, those beyond kMost are left out and counted.
/// Threading: any thread.
class LogLines {
 public:
  static constexpr std::size_t kMost = 50;
  static constexpr std::size_t kLongest = 2000;  ///< [byte] A longer line is cut off there.

  void Add(LogLine line);
  /// The lines since the last call, oldest first. Where lines were left out, the last one says how many.
  std::vector<LogLine> Take();

 private:
  std::mutex mutex_;
  std::deque<LogLine> lines_;
  std::size_t left_out_ = 0;
};

/// @param service  The name under which the line is published.
rcl_interfaces::msg::Log ToIdl(const LogLine& line, const std::string& service);

}  // namespace thalweg::dds
