#include "services/evaluator/core/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/stage_names.h"
#include "services/explorer/text/outcome_text.h"

namespace thalweg::evaluator {
namespace {

template <class Get>
Figures FiguresBy(const std::vector<const Outcome*>& outcomes, Get&& get) {
  std::vector<double> values;
  for (const Outcome* outcome : outcomes) values.push_back(static_cast<double>(get(*outcome)));
  return FiguresOf(values);
}

std::map<std::string, Summary::StageTime> StagesOf(const std::vector<const Outcome*>& outcomes) {
  std::map<std::string, std::vector<TimingStatistics::Summary>> by_stage;
  for (const Outcome* outcome : outcomes) {
    for (const auto& [stage, timing] : outcome->timings) by_stage[stage].push_back(timing);
  }
  std::map<std::string, Summary::StageTime> stages;
  for (const auto& [stage, timings] : by_stage) {
    std::vector<double> p50;
    std::vector<double> p95;
    Summary::StageTime& time = stages[stage];
    for (const TimingStatistics::Summary& timing : timings) {
      p50.push_back(timing.p50_ms);
      p95.push_back(timing.p95_ms);
      time.max_ms = std::max(time.max_ms, timing.max_ms);
    }
    time.p50_ms = Quantile(p50, 0.5);
    time.p95_ms = Quantile(p95, 0.5);
  }
  return stages;
}

std::map<std::string, Summary::SetAside> SetAsideOf(const std::vector<const Outcome*>& outcomes) {
  std::map<std::string, Summary::SetAside> set_aside;
  const auto runs = static_cast<double>(outcomes.size());
  for (const Outcome* outcome : outcomes) {
    for (const auto& count : outcome->set_aside) {
      Summary::SetAside& mean = set_aside[explorer::AsideText(count.reason, count.doubtful)];
      mean.clusters += static_cast<double>(count.clusters) / runs;
      mean.voxels += static_cast<double>(count.voxels) / runs;
    }
  }
  return set_aside;
}

std::map<std::string, Summary::OfOptimum> OfOptimumOf(const std::vector<const Outcome*>& outcomes) {
  std::map<std::string, Summary::OfOptimum> by_percent;
  if (std::none_of(outcomes.begin(), outcomes.end(), [](const Outcome* o) { return o->optimum.has_value(); }))
    return by_percent;
  for (std::size_t k = 0; k < kTourCoverages.size(); ++k) {
    std::vector<double> logs;
    std::vector<double> tours;
    for (const Outcome* outcome : outcomes) {
      const std::optional<double> ratio = OfOptimumAt(*outcome, k);
      if (!ratio) continue;
      logs.push_back(std::log(*ratio));
      tours.push_back(*outcome->optimum->to.at(k).length);
    }
    by_percent[PercentText(kTourCoverages.at(k))] = {
        .runs = logs.size(), .ratio = std::exp(Mean(logs)), .tour = Mean(tours)};
  }
  return by_percent;
}

std::optional<Summary::TailFigures> TailFiguresOf(const std::vector<const Outcome*>& outcomes) {
  std::vector<double> begins;
  std::vector<double> lengths;
  std::vector<double> counts;
  std::vector<double> journeys;
  std::vector<double> targets;
  double all = 0.0;
  double long_count = 0.0;
  double long_length = 0.0;
  double small_length = 0.0;
  double in_sight_length = 0.0;
  std::map<Tail::Kind, double> by_kind;
  for (const Tail::Kind kind : Tail::kKinds) by_kind[kind] = 0.0;
  bool recorded = false;
  for (const Outcome* outcome : outcomes) {
    recorded = recorded || outcome->tail.has_value();
    if (!outcome->tail || !outcome->tail->begins) continue;
    begins.push_back(*outcome->tail->begins);
    lengths.push_back(outcome->tail->length());
    counts.push_back(static_cast<double>(outcome->tail->journeys.size()));
    all += outcome->tail->length();
    for (const Tail::Journey& journey : outcome->tail->journeys) {
      journeys.push_back(journey.length);
      targets.push_back(static_cast<double>(journey.voxels));
      by_kind[journey.kind] += journey.length;
      if (journey.voxels <= kSmallTarget) small_length += journey.length;
      if (journey.kind == Tail::Kind::kPassedBy && journey.was_in_sight) in_sight_length += journey.length;
      if (journey.length < kLongJourney) continue;
      ++long_count;
      long_length += journey.length;
    }
  }
  if (!recorded) return std::nullopt;
  for (auto& [kind, length] : by_kind) length /= all;
  return Summary::TailFigures{.runs = begins.size(),
                              .begins = Mean(begins),
                              .length = Mean(lengths),
                              .journeys = Mean(counts),
                              .median = Quantile(journeys, 0.5),
                              .long_share = long_count / static_cast<double>(journeys.size()),
                              .long_length_share = long_length / all,
                              .target = Quantile(targets, 0.5),
                              .small_length_share = small_length / all,
                              .length_shares = by_kind,
                              .in_sight_length_share = in_sight_length / all};
}

std::optional<SurfaceFigures> MeanSurfaceOf(const std::vector<const Outcome*>& outcomes) {
  SurfaceFigures mean;
  double count = 0.0;
  for (const Outcome* outcome : outcomes) count += outcome->surface ? 1.0 : 0.0;
  if (count == 0.0) return std::nullopt;
  for (const Outcome* outcome : outcomes) {
    if (!outcome->surface) continue;
    for (double SurfaceFigures::*figure :
         {&SurfaceFigures::observable, &SurfaceFigures::seen, &SurfaceFigures::inspected,
          &SurfaceFigures::fine, &SurfaceFigures::mesh_area, &SurfaceFigures::mesh_to_truth,
          &SurfaceFigures::truth_to_mesh, &SurfaceFigures::f_near, &SurfaceFigures::f_voxel}) {
      mean.*figure += (*outcome->surface).*figure / count;
    }
  }
  return mean;
}

MotionFigures GreatestOf(const std::vector<const Outcome*>& outcomes) {
  MotionFigures most;
  for (const Outcome* outcome : outcomes) {
    const MotionFigures& of = outcome->motion;
    most.most_speed = std::max(most.most_speed, of.most_speed);
    most.most_acceleration = std::max(most.most_acceleration, of.most_acceleration);
    most.most_jerk = std::max(most.most_jerk, of.most_jerk);
    most.most_sideways_speed = std::max(most.most_sideways_speed, of.most_sideways_speed);
    most.most_turn_rate = std::max(most.most_turn_rate, of.most_turn_rate);
    most.most_turn_acceleration = std::max(most.most_turn_acceleration, of.most_turn_acceleration);
  }
  return most;
}

void CountEnd(const RunEnd& end, std::vector<Summary::EndCount>& ends) {
  const auto same = std::ranges::find_if(ends, [&](const Summary::EndCount& count) {
    return NameOf(count.end) == NameOf(end) &&
           count.end.ending.home_within_budget == end.ending.home_within_budget &&
           count.end.ending.why == end.ending.why;
  });
  ++(same != ends.end() ? *same : ends.emplace_back(Summary::EndCount{.end = end})).runs;
}

/// @param horizon  [m] Length over which mean coverage is computed.
Summary SummaryOf(const std::vector<const Outcome*>& outcomes, double horizon) {
  Summary summary;
  summary.scenario = outcomes.front()->scenario;
  summary.strategy = outcomes.front()->strategy;
  summary.runs = outcomes.size();
  summary.least_clearance = outcomes.front()->least_clearance;
  for (const Outcome* outcome : outcomes) {
    summary.completed += outcome->complete() ? 1 : 0;
    summary.collisions += outcome->collisions;
    summary.least_clearance = std::min(summary.least_clearance, outcome->least_clearance);
    CountEnd(outcome->end, summary.ends);
  }
  summary.stages = StagesOf(outcomes);
  summary.set_aside = SetAsideOf(outcomes);
  summary.of_optimum = OfOptimumOf(outcomes);
  summary.tail = TailFiguresOf(outcomes);
  summary.surface = MeanSurfaceOf(outcomes);
  summary.horizon = horizon;
  summary.area = FiguresBy(outcomes, [&](const Outcome& o) { return AreaUnderCoverage(o, horizon); });
  summary.path = FiguresBy(outcomes, [](const Outcome& o) { return o.distance; });
  summary.coverage = FiguresBy(outcomes, [](const Outcome& o) { return o.coverage; });
  summary.agreement = FiguresBy(outcomes, [](const Outcome& o) { return o.agreement; });
  std::vector<double> likenesses;
  for (const Outcome* outcome : outcomes) {
    if (outcome->likeness) likenesses.push_back(*outcome->likeness);
  }
  summary.likeness = FiguresOf(likenesses);
  for (std::size_t n = 0; n < kDoubtfulLogOdds.size(); ++n) {
    summary.doubtful[fmt::format("{:g}", kDoubtfulLogOdds[n])] =
        FiguresBy(outcomes, [n](const Outcome& o) { return o.doubtful[n]; });
  }
  summary.duration = FiguresBy(outcomes, [](const Outcome& o) { return o.duration; });
  summary.moving = FiguresBy(outcomes, [](const Outcome& o) { return o.motion.moving; });
  summary.turning = FiguresBy(outcomes, [](const Outcome& o) { return o.motion.turning; });
  summary.standing = FiguresBy(outcomes, [](const Outcome& o) { return o.motion.standing; });
  summary.stops = FiguresBy(outcomes, [](const Outcome& o) { return o.motion.stops; });
  summary.speed =
      FiguresBy(outcomes, [](const Outcome& o) { return o.duration > 0.0 ? o.distance / o.duration : 0.0; });
  summary.motion = GreatestOf(outcomes);
  summary.cpu = FiguresBy(outcomes, [](const Outcome& o) { return o.cpu; });
  summary.scans = FiguresBy(outcomes, [](const Outcome& o) { return o.scans; });
  summary.replans = FiguresBy(outcomes, [](const Outcome& o) { return o.replans; });
  summary.reversals = FiguresBy(outcomes, [](const Outcome& o) { return o.reversals; });
  for (const int percent : kCoveragePercents) {
    std::vector<double> paths;
    std::vector<double> times;
    for (const Outcome* outcome : outcomes) {
      if (const auto path = PathTo(*outcome, 0.01 * percent)) paths.push_back(*path);
      if (const auto time = TimeTo(*outcome, 0.01 * percent)) times.push_back(*time);
    }
    summary.path_to[percent] = FiguresOf(paths);
    summary.time_to[percent] = FiguresOf(times);
  }
  return summary;
}

const Outcome* Find(std::span<const Outcome> outcomes, const std::string& scenario,
                    const std::string& strategy, int run) {
  const auto found = std::find_if(outcomes.begin(), outcomes.end(), [&](const Outcome& o) {
    return o.scenario == scenario && o.strategy == strategy && o.run == run;
  });
  return found == outcomes.end() ? nullptr : &*found;
}

/// The paired log ratios of one world.
struct Pairs {
  std::vector<double> to_95;   ///< log(a / b)
  std::vector<double> to_end;  ///< log(a / b)
};

void AddTo(std::vector<double>& logs, std::optional<double> a, std::optional<double> b) {
  if (a && b && *a > 0.0 && *b > 0.0) logs.push_back(std::log(*a / *b));
}

Pairs PairsOf(std::span<const Outcome> outcomes, const std::string& scenario, const std::string& strategy,
              const std::string& reference) {
  Pairs pairs;
  for (const Outcome& outcome : outcomes) {
    if (outcome.strategy != strategy || outcome.scenario != scenario) continue;
    const Outcome* other = Find(outcomes, scenario, reference, outcome.run);
    if (other == nullptr) continue;
    AddTo(pairs.to_95, PathTo(outcome, 0.95), PathTo(*other, 0.95));
    if (outcome.complete() && other->complete()) AddTo(pairs.to_end, outcome.distance, other->distance);
  }
  return pairs;
}

Comparison::Decided& operator+=(Comparison::Decided& sum, const Comparison::Decided& more) {
  sum.shorter += more.shorter;
  sum.longer += more.longer;
  return sum;
}

Comparison::Decided DecidedBy(const PairedRatio& ratio) {
  if (ratio.pairs < kLeastPairs) return {};
  return {.shorter = ratio.interval.high < 1.0 ? 1U : 0U, .longer = ratio.interval.low > 1.0 ? 1U : 0U};
}

}  // namespace

std::vector<std::string> NamesIn(std::span<const Outcome> outcomes, std::string Outcome::*name) {
  std::vector<std::string> names;
  for (const Outcome& outcome : outcomes) {
    if (std::find(names.begin(), names.end(), outcome.*name) == names.end()) names.push_back(outcome.*name);
  }
  return names;
}

Figures FiguresOf(std::span<const double> values) {
  return {.count = values.size(),
          .mean = Mean(values),
          .deviation = StandardDeviation(values),
          .median = Quantile(values, 0.5),
          .least = Quantile(values, 0.0),
          .greatest = Quantile(values, 1.0),
          .interval = BootstrapOfMean(values)};
}

std::string PercentText(double coverage) {
  return fmt::format("{:.4g}", 100.0 * coverage);
}

std::optional<double> OfOptimumAt(const Outcome& outcome, std::size_t k) {
  if (!outcome.optimum) return std::nullopt;
  const OfflineTour& tour = outcome.optimum->to.at(k);
  const std::optional<double> path = PathTo(outcome, kTourCoverages.at(k));
  if (!path || !tour.length || tour.stops == 0 || !(*path > 0.0)) return std::nullopt;
  return *path / *tour.length;
}

Summary::StageTime Summary::plan() const {
  constexpr double kNotTimed = std::numeric_limits<double>::quiet_NaN();
  const auto found = stages.find(kPlanStage);
  return found == stages.end() ? StageTime{kNotTimed, kNotTimed, kNotTimed} : found->second;
}

std::vector<Summary> Summarize(std::span<const Outcome> outcomes) {
  std::vector<Summary> summaries;
  for (const std::string& scenario : NamesIn(outcomes, &Outcome::scenario)) {
    std::optional<double> horizon;
    for (const std::string& strategy : NamesIn(outcomes, &Outcome::strategy)) {
      std::vector<const Outcome*> of;
      for (const Outcome& outcome : outcomes) {
        if (outcome.scenario == scenario && outcome.strategy == strategy) of.push_back(&outcome);
      }
      if (of.empty()) continue;
      if (!horizon) horizon = FiguresBy(of, [](const Outcome& o) { return o.distance; }).median;
      summaries.push_back(SummaryOf(of, *horizon));
    }
  }
  return summaries;
}

std::vector<Comparison> Compare(std::span<const Outcome> outcomes, const std::string& reference) {
  const std::vector<std::string> scenarios = NamesIn(outcomes, &Outcome::scenario);
  const std::vector<std::string> strategies = NamesIn(outcomes, &Outcome::strategy);
  std::vector<Comparison> comparisons;
  std::map<std::string, Comparison> overall;
  std::map<std::string, std::vector<std::vector<double>>> all_to_95;
  std::map<std::string, std::vector<std::vector<double>>> all_to_end;
  for (const std::string& scenario : scenarios) {
    for (const std::string& strategy : strategies) {
      if (strategy == reference) continue;
      const Pairs pairs = PairsOf(outcomes, scenario, strategy, reference);
      Comparison& comparison = comparisons.emplace_back();
      comparison.scenario = scenario;
      comparison.strategy = strategy;
      comparison.against = reference;
      comparison.to_95 = RatioOver({&pairs.to_95, 1});
      comparison.to_end = RatioOver({&pairs.to_end, 1});
      comparison.decided_to_95 = DecidedBy(comparison.to_95);
      comparison.decided_to_end = DecidedBy(comparison.to_end);
      overall[strategy].decided_to_95 += comparison.decided_to_95;
      overall[strategy].decided_to_end += comparison.decided_to_end;
      all_to_95[strategy].push_back(pairs.to_95);
      all_to_end[strategy].push_back(pairs.to_end);
    }
  }
  if (scenarios.size() < 2) return comparisons;
  for (const std::string& strategy : strategies) {
    if (strategy == reference) continue;
    Comparison comparison = overall[strategy];
    comparison.strategy = strategy;
    comparison.against = reference;
    comparison.to_95 = RatioOver(all_to_95[strategy]);
    comparison.to_end = RatioOver(all_to_end[strategy]);
    comparisons.push_back(std::move(comparison));
  }
  return comparisons;
}

}  // namespace thalweg::evaluator
