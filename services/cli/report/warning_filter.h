#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

namespace thalweg::cli {

/// Chooses which warnings of a run are shown: each once, and of those that quote what others sent, a limited
/// number. A peer, or a client of the gateway, can cause a new text each time; it must not fill the screen,
/// nor use up what others have to say.
class WarningFilter {
 public:
  static constexpr std::size_t kMostOfAKind = 3;  ///< Texts that are the same up to the first ": ".
  static constexpr std::size_t kMost = 100;

  /// Whether to show what a service reports.
  bool AdmitReported(const std::string& text);
  /// Whether to show what this process has found itself.
  bool AdmitOwn(const std::string& text) { return shown_.insert(text).second; }

 private:
  std::set<std::string> shown_;
  std::map<std::string, std::size_t> of_kind_;
  std::size_t reported_ = 0;
};

}  // namespace thalweg::cli
