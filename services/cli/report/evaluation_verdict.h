#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/evaluator/core/summary.h"

namespace thalweg::cli {

/// What an evaluation shows, in a sentence.
struct Verdict {
  enum class Kind { kShorter, kLonger, kUndecided, kTrouble, kFine };
  Kind kind = Kind::kUndecided;
  std::string text;
};

/// The verdict on one comparison of path lengths: shorter or longer if the whole interval says so,
/// the sign-flip test agrees and there are enough pairs; else undecided, and why.
/// @param ratio     Ratio of the strategy's path to that of `against`.
/// @param how_far   "to 95 % coverage" or "to the end".
Verdict VerdictOn(const evaluator::PairedRatio& ratio, const std::string& strategy,
                  const std::string& against, const std::string& how_far);

/// Each strategy against the first, over all scenarios together, to 95 % coverage and to the end; then
/// whether all runs completed without touching anything.
std::vector<Verdict> VerdictsOn(std::span<const evaluator::Outcome> outcomes);

}  // namespace thalweg::cli
