#include "services/evaluator/core/summary.h"

#include <algorithm>
#include <utility>

namespace thalweg::evaluator {
namespace {

template <class Get>
Figures FiguresBy(const std::vector<const Outcome*>& outcomes, Get&& get) {
  std::vector<double> values;
  for (const Outcome* outcome : outcomes) values.push_back(static_cast<double>(get(*outcome)));
  return FiguresOf(values);
}

std::vector<std::string> NamesIn(std::span<const Outcome> outcomes, std::string Outcome::*name) {
  std::vector<std::string> names;
  for (const Outcome& outcome : outcomes) {
    if (std::find(names.begin(), names.end(), outcome.*name) == names.end()) names.push_back(outcome.*name);
  }
  return names;
}

Summary SummaryOf(const std::vector<const Outcome*>& outcomes) {
  Summary summary;
  summary.scenario = outcomes.front()->scenario;
  summary.strategy = outcomes.front()->strategy;
  summary.runs = outcomes.size();
  summary.least_clearance = outcomes.front()->least_clearance;
  std::vector<double> p50;
  std::vector<double> p95;
  for (const Outcome* outcome : outcomes) {
    summary.completed += outcome->complete() ? 1 : 0;
    summary.collisions += outcome->collisions;
    summary.least_clearance = std::min(summary.least_clearance, outcome->least_clearance);
    ++summary.stop_reasons[outcome->stop_reason];
    const auto plan = outcome->timings.find("plan");
    if (plan == outcome->timings.end()) continue;
    p50.push_back(plan->second.p50_ms);
    p95.push_back(plan->second.p95_ms);
    summary.plan_ms_max = std::max(summary.plan_ms_max, plan->second.max_ms);
  }
  summary.plan_ms_p50 = Quantile(p50, 0.5);
  summary.plan_ms_p95 = Quantile(p95, 0.5);
  summary.path = FiguresBy(outcomes, [](const Outcome& o) { return o.distance; });
  summary.coverage = FiguresBy(outcomes, [](const Outcome& o) { return o.coverage; });
  summary.agreement = FiguresBy(outcomes, [](const Outcome& o) { return o.agreement; });
  summary.duration = FiguresBy(outcomes, [](const Outcome& o) { return o.duration; });
  summary.scans = FiguresBy(outcomes, [](const Outcome& o) { return o.scans; });
  summary.replans = FiguresBy(outcomes, [](const Outcome& o) { return o.replans; });
  summary.reversals = FiguresBy(outcomes, [](const Outcome& o) { return o.reversals; });
  for (const int percent : kCoveragePercents) {
    std::vector<double> paths;
    for (const Outcome* outcome : outcomes) {
      if (const auto path = PathTo(*outcome, 0.01 * percent)) paths.push_back(*path);
    }
    summary.path_to[percent] = FiguresOf(paths);
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

struct Pairs {
  std::vector<double> a;
  std::vector<double> b;
  void Add(std::optional<double> first, std::optional<double> second) {
    if (!first || !second || *first <= 0.0 || *second <= 0.0) return;
    a.push_back(*first);
    b.push_back(*second);
  }
};

Comparison ComparisonOf(std::span<const Outcome> outcomes, const std::string& scenario,
                        const std::string& strategy, const std::string& reference) {
  Pairs to_95;
  Pairs to_end;
  for (const Outcome& outcome : outcomes) {
    if (outcome.strategy != strategy || (!scenario.empty() && outcome.scenario != scenario)) continue;
    const Outcome* other = Find(outcomes, outcome.scenario, reference, outcome.run);
    if (other == nullptr) continue;
    to_95.Add(PathTo(outcome, 0.95), PathTo(*other, 0.95));
    if (outcome.complete() && other->complete()) to_end.Add(outcome.distance, other->distance);
  }
  return {.scenario = scenario,
          .strategy = strategy,
          .against = reference,
          .to_95 = RatioOf(to_95.a, to_95.b),
          .to_end = RatioOf(to_end.a, to_end.b)};
}

}  // namespace

Figures FiguresOf(std::span<const double> values) {
  return {.count = values.size(),
          .mean = Mean(values),
          .deviation = StandardDeviation(values),
          .median = Quantile(values, 0.5),
          .least = Quantile(values, 0.0),
          .greatest = Quantile(values, 1.0),
          .interval = BootstrapOfMean(values)};
}

std::vector<Summary> Summarize(std::span<const Outcome> outcomes) {
  std::vector<Summary> summaries;
  for (const std::string& scenario : NamesIn(outcomes, &Outcome::scenario)) {
    for (const std::string& strategy : NamesIn(outcomes, &Outcome::strategy)) {
      std::vector<const Outcome*> of;
      for (const Outcome& outcome : outcomes) {
        if (outcome.scenario == scenario && outcome.strategy == strategy) of.push_back(&outcome);
      }
      if (!of.empty()) summaries.push_back(SummaryOf(of));
    }
  }
  return summaries;
}

std::vector<Comparison> Compare(std::span<const Outcome> outcomes, const std::string& reference) {
  std::vector<std::string> scenarios = NamesIn(outcomes, &Outcome::scenario);
  if (scenarios.size() > 1) scenarios.emplace_back();
  std::vector<Comparison> comparisons;
  for (const std::string& scenario : scenarios) {
    for (const std::string& strategy : NamesIn(outcomes, &Outcome::strategy)) {
      if (strategy != reference) {
        comparisons.push_back(ComparisonOf(outcomes, scenario, strategy, reference));
      }
    }
  }
  return comparisons;
}

}  // namespace thalweg::evaluator
