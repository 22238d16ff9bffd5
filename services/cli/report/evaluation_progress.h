#pragma once

#include <cstddef>
#include <string>

#include "services/evaluator/core/outcome.h"

namespace thalweg::cli {

/// How far an evaluation is, as text to print: a bar on a terminal, one line per run elsewhere.
class ProgressBar {
 public:
  /// @param total     Number of all runs.
  /// @param resumed   How many of them were made before.
  /// @param terminal  Whether a line can be written over.
  ProgressBar(std::size_t total, std::size_t resumed, bool terminal)
      : total_(total), resumed_(resumed), terminal_(terminal) {}

  /// Before the first run: how many were made before; empty if none.
  std::string Beginning() const;
  /// After each run.
  /// @param made  How many are made now, those made before among them.
  /// @param wall  [s] Since the beginning.
  std::string After(const evaluator::Outcome& outcome, std::size_t made, double wall) const;

 private:
  std::size_t total_;
  std::size_t resumed_;
  bool terminal_;
};

/// What was found for the start of a run: "room start 3: offline tours 30.2 m to 95 %, ...".
/// @param outcome     With offline tours.
/// @param from_cache  Whether an earlier evaluation found them.
std::string TourText(const evaluator::Outcome& outcome, bool from_cache);

}  // namespace thalweg::cli
