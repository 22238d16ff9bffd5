#pragma once

#include <chrono>
#include <ostream>
#include <string>

#include "services/cli/report/live_line.h"

namespace thalweg::cli {

/// On a terminal one line that is written over and over; elsewhere a plain line every few seconds.
class LiveDisplay {
 public:
  explicit LiveDisplay(std::ostream& out);
  ~LiveDisplay() { Release(); }
  LiveDisplay(const LiveDisplay&) = delete;
  LiveDisplay& operator=(const LiveDisplay&) = delete;

  void Show(const LiveState& state);   ///< As often as one likes.
  void Tell(const std::string& text);  ///< A line that stays.
  void Release();                      ///< Leaves the live line as it is and goes on below.

 private:
  std::ostream& out_;
  bool terminal_;
  bool line_open_ = false;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace thalweg::cli
