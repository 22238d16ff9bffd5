#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "services/cli/report/live_line.h"

namespace thalweg::cli {

/// Shows progress. On a terminal in a line that is rewritten, in color unless NO_COLOR is set; elsewhere, and
/// where TERM is "dumb", as a plain line every few seconds; for programs as one JSON object a line, every
/// second.
class LiveDisplay {
 public:
  enum class Style { kTerminal, kPlain, kJson };
  enum class Tone { kPlain, kGood, kWarning, kError };

  /// The style that fits standard output and the environment.
  static Style StyleFor(bool json);
  static bool WantsColor(Style style);

  LiveDisplay(std::ostream& out, Style style, bool color)
      : out_(out), style_(style), color_(color && style == Style::kTerminal) {}
  explicit LiveDisplay(std::ostream& out, bool json = false)
      : LiveDisplay(out, StyleFor(json), WantsColor(StyleFor(json))) {}
  ~LiveDisplay() { Release(); }
  LiveDisplay(const LiveDisplay&) = delete;
  LiveDisplay& operator=(const LiveDisplay&) = delete;

  void ShowHeading();
  void Show(const LiveState& state);  ///< May be called at any rate.
  /// Prints a permanent line; in JSON a "message" whose "level" is info, warning or error.
  void PrintLine(const std::string& text, Tone tone = Tone::kPlain);
  /// Prints an object {"event": NAME, ...}; nothing in the other styles.
  void PrintEvent(const std::string& name, const nlohmann::ordered_json& fields);
  void Release();  ///< Ends the live line, so that output continues below it.

 private:
  std::ostream& out_;
  Style style_;
  bool color_;
  bool line_open_ = false;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace thalweg::cli
