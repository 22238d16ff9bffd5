#include "services/cli/report/evaluation_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/angles.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::cli {
namespace {

using evaluator::Comparison;
using evaluator::Outcome;
using evaluator::PairedRatio;
using evaluator::Summary;
using Row = Table::Row;

std::string Number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

std::string Percent(double share) {
  return std::isfinite(share) ? Number(100.0 * share, 2) + " %" : "-";
}

std::string Ratio(const PairedRatio& ratio) {
  if (ratio.pairs == 0) return "-";
  return fmt::format("{:.3f} [{:.3f}, {:.3f}], p {:.2g}, n {}", ratio.mean, ratio.interval.low,
                     ratio.interval.high, ratio.p, ratio.pairs);
}

/// "shorter in 8, longer in 1 of 12"
std::string Decided(const Comparison::Decided& decided, const PairedRatio& ratio) {
  return fmt::format("; shorter in {}, longer in {} of {}", decided.shorter, decided.longer, ratio.worlds);
}

Row RowOf(const Summary& summary) {
  const auto to = [&](int percent) { return Number(summary.path_to.at(percent).mean, 1); };
  const Summary::StageTime plan = summary.plan();
  return {summary.scenario,
          summary.strategy,
          std::to_string(summary.runs),
          std::to_string(summary.completed),
          Number(summary.path.mean, 1),
          Number(summary.path.deviation, 1),
          Number(summary.path.median, 1),
          Number(summary.path.interval.low, 1) + " - " + Number(summary.path.interval.high, 1),
          to(50),
          to(90),
          to(95),
          to(99),
          Number(summary.area.mean, 3),
          Percent(summary.coverage.mean),
          Percent(summary.coverage.least),
          Percent(summary.agreement.mean),
          std::to_string(summary.collisions),
          summary.least_clearance < evaluator::ContactMeter::kNone ? Number(summary.least_clearance, 3) + " m"
                                                                   : "-",
          Number(summary.duration.mean, 0),
          Number(summary.replans.mean, 1),
          Number(summary.reversals.mean, 1),
          Number(plan.p50_ms, 1),
          Number(plan.p95_ms, 1),
          Number(summary.cpu.mean, 1)};
}

}  // namespace

Table SummaryTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario", "strategy",      "runs",      "complete",      "path [m]",      "sd",
                  "median",   "95 % interval", "to 50 %",   "to 90 %",       "to 95 %",       "to 99 %",
                  "area",     "coverage",      "least",     "agreement",     "collisions",    "nearest",
                  "time [s]", "replans",       "reversals", "plan p50 [ms]", "plan p95 [ms]", "CPU [s]"};
  table.terminal_columns = {0, 1, 2, 3, 4, 5, 10, 12, 13, 14, 15, 16, 17, 22};
  for (const Summary& summary : Summarize(outcomes)) table.rows.push_back(RowOf(summary));
  return table;
}

Table TimeTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario",   "strategy",    "time [s]",    "s to 95 %",    "s to 99 %",
                  "moving [s]", "turning [s]", "standing",    "stops",        "speed [m/s]",
                  "most [m/s]", "most [m/s2]", "most [m/s3]", "most [deg/s]", "most [deg/s2]"};
  for (std::size_t n = 0; n < table.header.size(); ++n) table.terminal_columns.push_back(n);
  for (const Summary& summary : Summarize(outcomes)) {
    table.rows.push_back({summary.scenario, summary.strategy, Number(summary.duration.mean, 1),
                          Number(summary.time_to.at(95).mean, 1), Number(summary.time_to.at(99).mean, 1),
                          Number(summary.moving.mean, 1), Number(summary.turning.mean, 1),
                          Number(summary.standing.mean, 1), Number(summary.stops.mean, 1),
                          Number(summary.speed.mean, 2), Number(summary.motion.most_speed, 2),
                          Number(summary.motion.most_acceleration, 2), Number(summary.motion.most_jerk, 0),
                          Number(summary.motion.most_turn_rate / kDegree, 0),
                          Number(summary.motion.most_turn_acceleration / kDegree, 0)});
  }
  return table;
}

std::vector<std::string> NotesOn(std::span<const std::string> columns) {
  struct Note {
    const char* column;  ///< The note is shown if this column is.
    const char* text;
  };
  static const std::vector<Note> kNotes = {
      {"complete", "complete: runs that ended because nothing reachable was left to see"},
      {"path [m]",
       "path, sd: length of the path to the end of a run, mean and standard deviation of all runs"},
      {"95 % interval", "95 % interval: of the mean path, by bootstrap over the runs"},
      {"to 95 %", "to 95 %: path length [m] until that share was covered, mean of the runs that reached it"},
      {"area",
       "area: mean coverage over an initial stretch as long as the first strategy's median path in that "
       "scenario"},
      {"coverage",
       "coverage, least: known share, at the end, of all space and surfaces that this robot can see from any "
       "position it can reach; mean and worst run"},
      {"agreement",
       "agreement: share of the same that the map classifies correctly; unknown counts as wrong"},
      {"nearest", "collisions, nearest: contacts with true surfaces in all runs; smallest distance to one"},
      {"s to 95 %",
       "s to 95 %, s to 99 %: simulated time until that share was covered, mean of the runs that reached it"},
      {"turning [s]",
       "moving, turning, standing: the robot moved; stood and turned; did neither; stops: times that it came "
       "to stand"},
      {"most [m/s]",
       "speed: path / time; most: greatest speed, acceleration, jerk, turn rate and turn acceleration of "
       "all runs, from the poses; accelerations and jerk over 0.1 s, which mean nothing in kinematic motion"},
      {"replans", "replans: paths abandoned as unsafe, mean of the runs"},
      {"reversals", "reversals: paths that start against the direction of travel, mean of the runs"},
      {"plan p95 [ms]", "plan: time of one complete decision; median over the runs of each run's percentile"},
      {"CPU [s]", "CPU: processor time of a run, mean of the runs"},
      {"drift [m]",
       "drift, of the path: position error at the end, mean of the runs, and as a share of the path length; "
       "greatest: of all runs"},
      {"losses",
       "tracking, degraded, lost: shares of all frames; losses: how often the pose was lost in all runs"},
      {"tour [m] 95 %",
       "tour: length of the shortest tour found for a robot that knows the world and sees all around; an "
       "upper bound of the optimum, so what is given as of the optimum is at most the true ratio; means over "
       "the runs that got there"},
      {"95 % at [m]",
       "tail: path after 95 % coverage; journeys: paths to one target each, their median length, the share "
       "of those of 2 m and more, and of the tail's length in them; target: median size, and share of the "
       "length to targets of <= 20 voxels"},
      {"95 % at [m]",
       "passed by: share of the tail's length to targets that had been known within 2 m and were left; in "
       "sight: to those of them that a turn would have shown; new: that had never been near; in vain: of "
       "which nothing became known; at hand: that had been near and were not left"},
      {"surface [m2]",
       "surface: area of all that this robot can see from any position it can reach; seen: share that was in "
       "view of a scan; inspected: by one scan from within 2 m and 60 degrees of the normal; at 5 mm: with "
       "pixels no farther apart on it"},
      {"surface [m2]",
       "mesh to truth, truth to mesh: mean distances, where at most 500 mm count; F: harmonic mean of the "
       "share of the mesh that is within 2 cm (a voxel of the map) of a true surface and of the surface that "
       "is within that of the mesh"},
      {"as without noise",
       "as without noise: share of all voxels of the world's box that are unknown, free or occupied just as "
       "in the map that a sensor without noise would have made from the same poses; mean and worst run"},
      {"path of",
       "ratio: path lengths of the two strategies from the same start, geometric mean [95 % interval by "
       "bootstrap], p of a sign-flip test, n pairs of starts; to the end: where both completed"},
      {"path of",
       "all: each world has the same weight; shorter, longer: worlds with at least six pairs whose interval "
       "lies entirely below or above 1"}};
  std::vector<std::string> notes;
  for (const Note& note : kNotes) {
    if (std::find(columns.begin(), columns.end(), note.column) != columns.end()) {
      notes.emplace_back(note.text);
    }
  }
  return notes;
}

Table ComparisonTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario", "path of", "to 95 %: ratio", "to the end: ratio"};
  table.terminal_columns = {0, 1, 2, 3};
  if (outcomes.empty()) return table;
  for (const Comparison& comparison : Compare(outcomes, outcomes.front().strategy)) {
    const bool all = comparison.scenario.empty();
    table.rows.push_back(
        {all ? "all" : comparison.scenario, comparison.strategy + " / " + comparison.against,
         Ratio(comparison.to_95) + (all ? Decided(comparison.decided_to_95, comparison.to_95) : ""),
         Ratio(comparison.to_end) + (all ? Decided(comparison.decided_to_end, comparison.to_end) : "")});
  }
  return table;
}

Table StageTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario", "strategy", "stage", "p50 [ms]", "p95 [ms]", "max [ms]"};
  for (const Summary& summary : Summarize(outcomes)) {
    for (const auto& [stage, time] : summary.stages) {
      table.rows.push_back({summary.scenario, summary.strategy, stage, Number(time.p50_ms, 2),
                            Number(time.p95_ms, 2), Number(time.max_ms, 1)});
    }
  }
  return table;
}

Table EndTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario", "strategy", "end", "runs"};
  for (const Summary& summary : Summarize(outcomes)) {
    for (const Summary::EndCount& count : summary.ends) {
      table.rows.push_back(
          {summary.scenario, summary.strategy, ToText(count.end), std::to_string(count.runs)});
    }
  }
  return table;
}

Table OdometryTable(std::span<const Outcome> outcomes) {
  struct Sums {
    std::string scenario, strategy;
    std::vector<double> drift, greatest, share;
    double frames = 0.0, degraded = 0.0, lost = 0.0;
    std::size_t losses = 0;
  };
  std::vector<Sums> rows;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.own_pose) continue;
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Sums& sums) {
      return sums.scenario == outcome.scenario && sums.strategy == outcome.strategy;
    });
    if (row == rows.end()) {
      rows.push_back({.scenario = outcome.scenario,
                      .strategy = outcome.strategy,
                      .drift = {},
                      .greatest = {},
                      .share = {}});
      row = rows.end() - 1;
    }
    row->drift.push_back(outcome.own_pose->drift);
    row->greatest.push_back(outcome.own_pose->greatest_drift);
    row->share.push_back(outcome.own_pose->drift / std::max(1e-9, outcome.distance));
    row->frames += static_cast<double>(outcome.own_pose->frames);
    row->degraded += static_cast<double>(outcome.own_pose->degraded);
    row->lost += static_cast<double>(outcome.own_pose->lost);
    row->losses += outcome.own_pose->losses;
  }
  Table table;
  table.header = {"scenario", "strategy", "drift [m]", "greatest [m]", "of the path",
                  "tracking", "degraded", "lost",      "losses"};
  table.terminal_columns = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  for (const Sums& row : rows) {
    const double frames = std::max(1.0, row.frames);
    table.rows.push_back({row.scenario, row.strategy, Number(evaluator::FiguresOf(row.drift).mean, 3),
                          Number(evaluator::FiguresOf(row.greatest).greatest, 3),
                          Percent(evaluator::FiguresOf(row.share).mean),
                          Percent((row.frames - row.degraded - row.lost) / frames),
                          Percent(row.degraded / frames), Percent(row.lost / frames),
                          std::to_string(row.losses)});
  }
  return table;
}

Table OptimumTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario", "strategy"};
  const auto column = [](const char* what, double coverage) {
    return what + evaluator::PercentText(coverage) + " %";
  };
  for (const double to : evaluator::kTourCoverages) table.header.push_back(column("tour [m] ", to));
  for (const double to : evaluator::kTourCoverages) table.header.push_back(column("of optimum ", to));
  for (std::size_t n = 0; n < table.header.size(); ++n) table.terminal_columns.push_back(n);
  for (const Summary& summary : Summarize(outcomes)) {
    if (summary.of_optimum.empty()) continue;
    Row row = {summary.scenario, summary.strategy};
    for (const double to : evaluator::kTourCoverages) {
      row.push_back(Number(summary.of_optimum.at(evaluator::PercentText(to)).tour, 1));
    }
    for (const double to : evaluator::kTourCoverages) {
      const Summary::OfOptimum& of = summary.of_optimum.at(evaluator::PercentText(to));
      row.push_back(Number(of.ratio, 2) +
                    (of.runs < summary.runs && of.runs > 0 ? fmt::format(" ({} runs)", of.runs) : ""));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table TailTable(std::span<const Outcome> outcomes) {
  constexpr int kInSightColumn = 11;  // after "passed by", of which it is a part
  Table table;
  table.header = {"scenario",   "strategy", "95 % at [m]", "tail [m]",        "journeys",
                  "median [m]", ">= 2 m",   "their path",  "target [voxels]", "path to <= 20"};
  for (const evaluator::Tail::Kind kind : evaluator::Tail::kKinds) table.header.emplace_back(NameOf(kind));
  table.header.insert(table.header.begin() + kInSightColumn, "in sight");
  for (std::size_t n = 0; n < table.header.size(); ++n) table.terminal_columns.push_back(n);
  const auto percent = [](double share) {
    return std::isfinite(share) ? Number(100.0 * share, 0) + " %" : "-";
  };
  for (const Summary& summary : Summarize(outcomes)) {
    if (!summary.tail) continue;
    const Summary::TailFigures& tail = *summary.tail;
    Row row = {summary.scenario,         summary.strategy,
               Number(tail.begins, 1),   Number(tail.length, 1),
               Number(tail.journeys, 1), Number(tail.median, 2),
               percent(tail.long_share), percent(tail.long_length_share),
               Number(tail.target, 0),   percent(tail.small_length_share)};
    for (const evaluator::Tail::Kind kind : evaluator::Tail::kKinds) {
      row.push_back(percent(tail.length_shares.at(kind)));
    }
    row.insert(row.begin() + kInSightColumn, percent(tail.in_sight_length_share));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table SurfaceTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario",  "strategy",           "surface [m2]",       "seen",   "inspected", "at 5 mm",
                  "mesh [m2]", "mesh to truth [mm]", "truth to mesh [mm]", "F 2 cm", "F voxel"};
  for (std::size_t n = 0; n < table.header.size(); ++n) table.terminal_columns.push_back(n);
  const auto percent = [](double share) { return Number(100.0 * share, 1) + " %"; };
  for (const Summary& summary : Summarize(outcomes)) {
    if (!summary.surface) continue;
    const evaluator::SurfaceFigures& surface = *summary.surface;
    table.rows.push_back({summary.scenario, summary.strategy, Number(surface.observable, 1),
                          percent(surface.seen), percent(surface.inspected), percent(surface.fine),
                          Number(surface.mesh_area, 1), Number(1e3 * surface.mesh_to_truth, 1),
                          Number(1e3 * surface.truth_to_mesh, 1), Number(surface.f_near, 3),
                          Number(surface.f_voxel, 3)});
  }
  return table;
}

Table NoiseTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario", "strategy", "as without noise", "sd", "worst"};
  for (std::size_t n = 0; n < table.header.size(); ++n) table.terminal_columns.push_back(n);
  for (const Summary& summary : Summarize(outcomes)) {
    const evaluator::Figures& likeness = summary.likeness;
    if (likeness.count == 0) continue;
    table.rows.push_back({summary.scenario, summary.strategy, Percent(likeness.mean),
                          Percent(likeness.deviation), Percent(likeness.least)});
  }
  return table;
}

Table SetAsideTable(std::span<const Outcome> outcomes) {
  Table table;
  table.header = {"scenario", "strategy", "reason", "clusters", "voxels"};
  for (const Summary& summary : Summarize(outcomes)) {
    for (const auto& [reason, mean] : summary.set_aside) {
      table.rows.push_back(
          {summary.scenario, summary.strategy, reason, Number(mean.clusters, 1), Number(mean.voxels, 1)});
    }
  }
  return table;
}

std::string ToText(const Table& table) {
  std::string text;
  std::vector<std::size_t> widths;
  for (const std::size_t column : table.terminal_columns) {
    std::size_t width = table.header[column].size();
    for (const Row& row : table.rows) width = std::max(width, row[column].size());
    widths.push_back(width);
  }
  const auto add = [&](const Row& row) {
    for (std::size_t n = 0; n < widths.size(); ++n) {
      const std::string& cell = row[table.terminal_columns[n]];
      const std::string space(widths[n] - cell.size(), ' ');
      const bool left = n < 2;
      text += (n == 0 ? "" : "  ") + (left ? cell + space : space + cell);
    }
    text += '\n';
  };
  add(table.header);
  for (const Row& row : table.rows) add(row);
  return text;
}

}  // namespace thalweg::cli
