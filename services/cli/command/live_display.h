#pragma once

#include <chrono>
#include <ostream>
#include <string>

#include "services/cli/report/live_line.h"

namespace thalweg::cli {

/// Shows progress: on a terminal in a line that is rewritten, elsewhere as a plain line every few seconds.
class LiveDisplay {
 public:
  explicit LiveDisplay(std::ostream& out);
  ~LiveDisplay() { Release(); }
  LiveDisplay(const LiveDisplay&) = delete;
  LiveDisplay& operator=(const LiveDisplay&) = delete;

  void Show(const LiveState& state);        ///< May be called at any rate.
  void PrintLine(const std::string& text);  ///< Prints a permanent line.
  void Release();                           ///< Ends the live line, so that output continues below it.

 private:
  std::ostream& out_;
  bool terminal_;
  bool line_open_ = false;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace thalweg::cli
