#include "services/cli/report/evaluation_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace thalweg::cli {
namespace {

using evaluator::Comparison;
using evaluator::Outcome;
using evaluator::PairedRatio;

constexpr double kLevel = 0.05;  // of significance

std::string InWords(std::size_t count) {
  static const std::array kWords = {"no", "one", "two", "three", "four", "five"};
  return count < kWords.size() ? kWords.at(count) : std::to_string(count);
}

std::string Pairs(std::size_t count) {
  return InWords(count) + (count == 1 ? " pair" : " pairs");
}

/// "7 %", "0.4 %"
std::string ChangeInPercent(double ratio) {
  const double percent = 100.0 * std::abs(1.0 - ratio);
  return fmt::format("{:.{}f} %", percent, percent < 0.95 ? 1 : 0);
}

/// "7 % shorter"
std::string Change(double ratio) {
  return ChangeInPercent(ratio) + (ratio <= 1.0 ? " shorter" : " longer");
}

/// "[3 % to 11 % shorter]", or "[12 % shorter to 2 % longer]"
std::string IntervalText(const PairedRatio& ratio) {
  const auto [low, high] = ratio.interval;
  if (high <= 1.0) return fmt::format("[{} to {} shorter]", ChangeInPercent(high), ChangeInPercent(low));
  if (low >= 1.0) return fmt::format("[{} to {} longer]", ChangeInPercent(low), ChangeInPercent(high));
  return fmt::format("[{} to {}]", Change(low), Change(high));
}

Verdict CompletionOf(std::span<const Outcome> outcomes) {
  const auto complete = std::ranges::count_if(outcomes, [](const Outcome& run) { return run.complete(); });
  const auto touching =
      std::ranges::count_if(outcomes, [](const Outcome& run) { return run.collisions > 0; });
  const std::size_t runs = outcomes.size();
  Verdict verdict;
  verdict.kind = static_cast<std::size_t>(complete) == runs && touching == 0 ? Verdict::Kind::kFine
                                                                             : Verdict::Kind::kTrouble;
  const std::size_t open = runs - static_cast<std::size_t>(complete);
  if (runs == 1) {
    verdict.text = fmt::format("The run {}, and touched {}.", open == 0 ? "completed" : "did not complete",
                               touching == 0 ? "nothing" : "a surface");
    return verdict;
  }
  verdict.text = open == 0 ? fmt::format("All {} runs completed", runs)
                           : fmt::format("{} of {} runs did not complete", open, runs);
  verdict.text +=
      touching == 0 ? ", none touched anything." : fmt::format(", {} touched a surface.", touching);
  return verdict;
}

}  // namespace

Verdict VerdictOn(const PairedRatio& ratio, const std::string& strategy, const std::string& against,
                  const std::string& how_far) {
  if (ratio.pairs == 0) {
    return {Verdict::Kind::kUndecided,
            fmt::format("{} and {} cannot be compared {}: from no start did both get there.", strategy,
                        against, how_far)};
  }
  const bool differs = ratio.interval.high < 1.0 || ratio.interval.low > 1.0;
  const std::string was = fmt::format("{} was {} {} than {}, but {} cannot decide", strategy,
                                      Change(ratio.mean), how_far, against, Pairs(ratio.pairs));
  if (ratio.pairs < evaluator::kLeastPairs) return {Verdict::Kind::kUndecided, was + "."};
  if (differs && ratio.p > kLevel)
    return {Verdict::Kind::kUndecided, was + fmt::format(" (p {:.2f}).", ratio.p)};
  const std::string of = ratio.worlds > 1 ? fmt::format("{} in {} worlds", Pairs(ratio.pairs), ratio.worlds)
                                          : Pairs(ratio.pairs);
  if (differs) {
    return {ratio.mean < 1.0 ? Verdict::Kind::kShorter : Verdict::Kind::kLonger,
            fmt::format("{} is {} {} than {} {}, over {}.", strategy, Change(ratio.mean), how_far, against,
                        IntervalText(ratio), of)};
  }
  return {Verdict::Kind::kUndecided,
          fmt::format("No difference shown between {} and {} {}: {} {}, over {}.", strategy, against, how_far,
                      Change(ratio.mean), IntervalText(ratio), of)};
}

std::vector<Verdict> VerdictsOn(std::span<const Outcome> outcomes) {
  std::vector<Verdict> verdicts;
  if (outcomes.empty()) return {{Verdict::Kind::kUndecided, "No run was made."}};
  const std::vector<Comparison> comparisons = Compare(outcomes, outcomes.front().strategy);
  const bool several =
      std::ranges::any_of(comparisons, [](const Comparison& c) { return c.scenario.empty(); });
  for (const Comparison& comparison : comparisons) {
    if (several && !comparison.scenario.empty()) continue;
    verdicts.push_back(
        VerdictOn(comparison.to_95, comparison.strategy, comparison.against, "to 95 % coverage"));
    verdicts.push_back(VerdictOn(comparison.to_end, comparison.strategy, comparison.against, "to the end"));
  }
  verdicts.push_back(CompletionOf(outcomes));
  return verdicts;
}

}  // namespace thalweg::cli
