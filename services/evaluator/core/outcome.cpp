#include "services/evaluator/core/outcome.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace thalweg::evaluator {
namespace {

constexpr double kDistanceStep = 0.25;   // [m]
constexpr double kCoverageStep = 0.005;  // share of the whole

bool Passes(double before, double now) {
  const auto passes = [&](double coverage) { return before < coverage && now >= coverage; };
  return std::any_of(std::begin(kCoveragePercents), std::end(kCoveragePercents),
                     [&](int percent) { return passes(0.01 * percent); }) ||
         std::any_of(kTourCoverages.begin(), kTourCoverages.end(), passes);
}

std::array<double, kDoubtfulLogOdds.size()> DoubtfulShares(const OccupancyGrid& map,
                                                           const simulator::TrueMap& truth) {
  std::array<double, kDoubtfulLogOdds.size()> shares{};
  const double one = 1.0 / static_cast<double>(std::max<std::size_t>(1, truth.observable_count()));
  map.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    if (!truth.Observable(i)) return;
    for (std::size_t n = 0; n < shares.size(); ++n) {
      if (std::abs(static_cast<double>(log_odds)) < kDoubtfulLogOdds[n]) shares[n] += one;
    }
  });
  return shares;
}

}  // namespace

Outcome Judge(const LockstepResult& result, const OccupancyGrid& map, const simulator::TrueMap& truth) {
  Outcome outcome;
  outcome.end = result.end;
  outcome.distance = result.distance;
  outcome.duration = result.duration;
  const simulator::TrueMap::Agreement agreement = truth.Compare(map);
  outcome.coverage = agreement.coverage();
  outcome.agreement = agreement.share();
  outcome.doubtful = DoubtfulShares(map, truth);
  outcome.motion = result.motion;
  outcome.collisions = result.collisions;
  outcome.least_clearance = result.least_clearance;
  outcome.scans = result.scans;
  outcome.plans = result.explorer.plans;
  outcome.replans = result.replans;
  outcome.reversals = result.reversals;
  outcome.left_out = result.explorer.left_out;
  outcome.set_aside = result.explorer.set_aside;
  outcome.own_pose = result.own_pose;
  outcome.timings = result.explorer.timings;
  const auto all = static_cast<double>(std::max<std::size_t>(1, truth.observable_count()));
  for (std::size_t n = 0; n < result.samples.size(); ++n) {
    const LockstepResult::Sample& sample = result.samples[n];
    const double coverage = static_cast<double>(sample.observed) / all;
    const bool last = n + 1 == result.samples.size();
    if (outcome.progress.empty() || last ||
        sample.distance - outcome.progress.back().distance >= kDistanceStep ||
        coverage - outcome.progress.back().coverage >= kCoverageStep ||
        Passes(outcome.progress.back().coverage, coverage)) {
      outcome.progress.push_back({sample.time, sample.distance, coverage, sample.p_W});
    }
  }
  return outcome;
}

namespace {

/// The progress when that coverage was reached; null when it never was.
const Outcome::Progress* ProgressTo(const Outcome& outcome, double coverage) {
  const auto found = std::ranges::find_if(
      outcome.progress, [&](const auto& progress) { return progress.coverage >= coverage; });
  return found == outcome.progress.end() ? nullptr : &*found;
}

}  // namespace

std::optional<double> PathTo(const Outcome& outcome, double coverage) {
  const Outcome::Progress* const progress = ProgressTo(outcome, coverage);
  return progress == nullptr ? std::nullopt : std::optional(progress->distance);
}

std::optional<double> TimeTo(const Outcome& outcome, double coverage) {
  const Outcome::Progress* const progress = ProgressTo(outcome, coverage);
  return progress == nullptr ? std::nullopt : std::optional(progress->time);
}

double CoverageAt(const Outcome& outcome, double Outcome::Progress::*along, double at) {
  const auto later = std::ranges::upper_bound(outcome.progress, at, {}, along);
  return later == outcome.progress.begin() ? 0.0 : std::prev(later)->coverage;
}

double AreaUnderCoverage(const Outcome& outcome, double horizon) {
  double area = 0.0;
  double at = 0.0;
  double coverage = 0.0;
  for (const Outcome::Progress& progress : outcome.progress) {
    const double until = std::min(progress.distance, horizon);
    area += coverage * (until - at);
    at = until;
    coverage = progress.coverage;
  }
  area += coverage * std::max(0.0, horizon - at);
  return horizon > 0.0 ? area / horizon : coverage;
}

}  // namespace thalweg::evaluator
