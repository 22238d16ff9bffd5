#include "services/cli/report/evaluation_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "services/cli/report/chart.h"
#include "services/cli/report/map_picture.h"

namespace thalweg::cli {
namespace {

using evaluator::Comparison;
using evaluator::Figures;
using evaluator::Outcome;
using evaluator::PairedRatio;
using evaluator::Summary;

// Told apart with any eyes [Okabe, Ito: Color universal design, 2008]; blue, green, red.
const std::array<cv::Scalar, 7> kStrategyColors = {
    cv::Scalar{178, 114, 0}, {0, 94, 213},   {115, 158, 0}, {167, 121, 204},
    {0, 159, 230},           {233, 180, 86}, {0, 0, 0}};

template <class... Values>
std::string Format(const char* format, Values... values) {
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string Number(double value, int digits) {
  return std::isfinite(value) ? Format("%.*f", digits, value) : "-";
}

std::string Ratio(const PairedRatio& ratio) {
  if (ratio.pairs == 0) return "-";
  return Format("%.3f [%.3f, %.3f], p %.3f, n %zu", ratio.mean, ratio.interval.low, ratio.interval.high,
                ratio.p, ratio.pairs);
}

std::vector<std::string> StrategiesOf(std::span<const Outcome> outcomes, const std::string& scenario) {
  std::vector<std::string> names;
  for (const Outcome& outcome : outcomes) {
    if (outcome.scenario != scenario) continue;
    if (std::find(names.begin(), names.end(), outcome.strategy) == names.end())
      names.push_back(outcome.strategy);
  }
  return names;
}

double CoverageAt(const Outcome& outcome, double distance) {
  double coverage = 0.0;
  for (const Outcome::Progress& progress : outcome.progress) {
    if (progress.distance > distance) break;
    coverage = progress.coverage;
  }
  return coverage;
}

using Row = std::vector<std::string>;

Row SummaryHeader() {
  return {"scenario",      "strategy",   "runs",    "complete", "path [m]",  "sd",       "median",
          "95 % interval", "to 50 %",    "to 90 %", "to 95 %",  "to 99 %",   "coverage", "least",
          "agreement",     "collisions", "nearest", "time [s]", "reversals", "plan p50", "p95 [ms]"};
}

Row RowOf(const Summary& summary) {
  const auto to = [&](int percent) { return Number(summary.path_to.at(percent).mean, 1); };
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
          Number(100.0 * summary.coverage.mean, 2) + " %",
          Number(100.0 * summary.coverage.least, 2) + " %",
          Number(100.0 * summary.agreement.mean, 2) + " %",
          std::to_string(summary.collisions),
          Number(summary.least_clearance, 3) + " m",
          Number(summary.duration.mean, 0),
          Number(summary.reversals.mean, 1),
          Number(summary.plan_ms_p50, 1),
          Number(summary.plan_ms_p95, 1)};
}

std::vector<Row> ComparisonRows(std::span<const Outcome> outcomes) {
  std::vector<Row> rows;
  if (outcomes.empty()) return rows;
  for (const Comparison& comparison : Compare(outcomes, outcomes.front().strategy)) {
    rows.push_back({comparison.scenario.empty() ? "all" : comparison.scenario,
                    comparison.strategy + " / " + comparison.against, Ratio(comparison.to_95),
                    Ratio(comparison.to_end)});
  }
  return rows;
}

const Row kComparisonHeader = {"scenario", "path of", "to 95 %: ratio [95 % interval]", "to the end"};

std::string TextTable(const Row& header, const std::vector<Row>& rows,
                      const std::vector<std::size_t>& columns) {
  std::string text;
  std::vector<std::size_t> widths;
  for (const std::size_t column : columns) {
    std::size_t width = header[column].size();
    for (const Row& row : rows) width = std::max(width, row[column].size());
    widths.push_back(width);
  }
  const auto add = [&](const Row& row) {
    for (std::size_t n = 0; n < columns.size(); ++n) {
      const std::string& cell = row[columns[n]];
      const std::string space(widths[n] - cell.size(), ' ');
      const bool left = columns[n] < 2;
      text += (n == 0 ? "" : "  ") + (left ? cell + space : space + cell);
    }
    text += '\n';
  };
  add(header);
  for (const Row& row : rows) add(row);
  return text;
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<') {
      escaped += "&lt;";
    } else if (c == '&') {
      escaped += "&amp;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string HtmlTable(const Row& header, const std::vector<Row>& rows) {
  std::string html = "<table>\n";
  const auto add = [&](const Row& row, const char* tag) {
    html += "<tr>";
    for (const std::string& cell : row) html += Format("<%s>", tag) + Escaped(cell) + Format("</%s>", tag);
    html += "</tr>\n";
  };
  add(header, "th");
  for (const Row& row : rows) add(row, "td");
  return html + "</table>\n";
}

std::string Base64(const std::vector<std::uint8_t>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - n);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? bytes[n + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= left ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::vector<Row> SetAsideRows(std::span<const Outcome> outcomes) {
  std::map<std::array<std::string, 3>, std::array<std::size_t, 3>> sums;  // clusters, voxels, runs
  for (const Outcome& outcome : outcomes) {
    for (const auto& count : outcome.set_aside) {
      auto& sum = sums[{outcome.scenario, outcome.strategy, count.reason}];
      sum[0] += count.clusters;
      sum[1] += count.voxels;
      ++sum[2];
    }
  }
  std::vector<Row> rows;
  for (const auto& [of, sum] : sums) {
    rows.push_back({of[0], of[1], of[2], std::to_string(sum[2]),
                    Number(static_cast<double>(sum[0]) / static_cast<double>(sum[2]), 1),
                    Number(static_cast<double>(sum[1]) / static_cast<double>(sum[2]), 1)});
  }
  return rows;
}

}  // namespace

cv::Mat DrawCoverageCurves(std::span<const Outcome> outcomes, const std::string& scenario) {
  Canvas canvas(1100, 620);
  Chart chart;
  chart.title = scenario + ": mean coverage over distance";
  chart.x_label = "distance [m]";
  chart.y_label = "coverage [%]";
  chart.y_max = 100.0;
  const std::vector<std::string> strategies = StrategiesOf(outcomes, scenario);
  for (std::size_t n = 0; n < strategies.size(); ++n) {
    std::vector<const Outcome*> of;
    double longest = 0.0;
    for (const Outcome& outcome : outcomes) {
      if (outcome.scenario != scenario || outcome.strategy != strategies[n]) continue;
      of.push_back(&outcome);
      longest = std::max(longest, outcome.distance);
    }
    Chart::Series series{strategies[n], kStrategyColors[n % kStrategyColors.size()], {}};
    constexpr int kPoints = 300;
    for (int k = 0; k <= kPoints; ++k) {
      const double distance = longest * k / kPoints;
      double sum = 0.0;
      for (const Outcome* outcome : of) sum += CoverageAt(*outcome, distance);
      series.points.emplace_back(distance, 100.0 * sum / static_cast<double>(of.size()));
    }
    chart.x_max = std::max(chart.x_max, longest);
    chart.series.push_back(std::move(series));
  }
  DrawChart(canvas, {30, 10, 1040, 600}, chart);
  return canvas.Picture();
}

cv::Mat DrawPaths(std::span<const Outcome> outcomes, const std::string& scenario, int run,
                  const OccupancyGrid& truth) {
  const MapFromAbove map = LookFromAbove(truth);
  std::vector<const Outcome*> of;
  for (const Outcome& outcome : outcomes) {
    if (outcome.scenario == scenario && outcome.run == run) of.push_back(&outcome);
  }
  constexpr int kWidth = 560;
  constexpr int kHeight = 560;
  const int columns = std::max(1, std::min(3, static_cast<int>(of.size())));
  const int rows = (static_cast<int>(of.size()) + columns - 1) / columns;
  Canvas canvas(columns * kWidth, std::max(1, rows) * kHeight);
  for (std::size_t n = 0; n < of.size(); ++n) {
    const double x = kWidth * (static_cast<int>(n) % columns);
    const double y = kHeight * (static_cast<int>(n) / columns);
    canvas.Text(of[n]->strategy + Format(", start %d: %.1f m, %s", of[n]->seed, of[n]->distance,
                                         of[n]->stop_reason.c_str()),
                {x + 30, y + 30}, 13.0, colors::kInk, Align::kLeft, true);
    std::vector<TrajectoryPose> path;
    for (const Outcome::Progress& progress : of[n]->progress) {
      path.push_back(
          {Time{} + FromSeconds(progress.time), MakeTransform(Eigen::Matrix3d::Identity(), progress.p_W)});
    }
    DrawMap(canvas, {x + 20, y + 44, kWidth - 40.0, kHeight - 60.0}, map, path);
  }
  return canvas.Picture();
}

std::string EvaluationText(std::span<const Outcome> outcomes) {
  std::vector<Row> rows;
  for (const Summary& summary : Summarize(outcomes)) rows.push_back(RowOf(summary));
  std::string text = TextTable(SummaryHeader(), rows, {0, 1, 2, 3, 4, 5, 10, 12, 13, 15, 16, 20});
  const std::vector<Row> comparisons = ComparisonRows(outcomes);
  if (!comparisons.empty()) text += '\n' + TextTable(kComparisonHeader, comparisons, {0, 1, 2, 3});
  return text;
}

std::string EvaluationHtml(std::span<const Outcome> outcomes,
                           const std::map<std::string, std::vector<std::vector<std::uint8_t>>>& pictures) {
  std::vector<Row> rows;
  std::vector<std::string> scenarios;
  for (const Summary& summary : Summarize(outcomes)) {
    rows.push_back(RowOf(summary));
    if (std::find(scenarios.begin(), scenarios.end(), summary.scenario) == scenarios.end()) {
      scenarios.push_back(summary.scenario);
    }
  }
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>thalweg: "
      "evaluation</title>\n<style>"
      "body{font:15px/1.5 sans-serif;color:#222a34;margin:2em auto;max-width:100em;padding:0 2em}"
      "table{border-collapse:collapse;margin:1em 0;font-size:13px}th,td{padding:.3em .7em;text-align:right;"
      "border-bottom:1px solid #d8dde2}th:nth-child(-n+2),td:nth-child(-n+2){text-align:left}"
      "img{max-width:100%;margin:.5em 0}p{max-width:50em}</style></head><body>\n<h1>Evaluation</h1>\n"
      "<p>Runs in lock step. Coverage: the known share of all that this robot could see from anywhere it can "
      "reach; "
      "agreement: the share of it that the map has right; both against the simulator's truth. Paths to a "
      "coverage are "
      "means of the runs that reached it. Nearest: least distance from the robot's sphere to a true "
      "surface.</p>\n";
  html += HtmlTable(SummaryHeader(), rows);
  if (const std::vector<Row> comparisons = ComparisonRows(outcomes); !comparisons.empty()) {
    html +=
        "<h2>Start by start</h2>\n<p>Geometric mean of the ratios of paths from the same start, bootstrap "
        "interval, "
        "sign-flip test; to the end: where both completed.</p>\n" +
        HtmlTable(kComparisonHeader, comparisons);
  }
  for (const std::string& scenario : scenarios) {
    html += "<h2>" + Escaped(scenario) + "</h2>\n";
    const auto found = pictures.find(scenario);
    if (found == pictures.end()) continue;
    for (const auto& png : found->second) {
      html += "<img alt=\"" + Escaped(scenario) + "\" src=\"data:image/png;base64," + Base64(png) + "\">\n";
    }
  }
  html += "<h2>Frontiers set aside, a run</h2>\n" +
          HtmlTable({"scenario", "strategy", "reason", "runs", "clusters", "voxels"}, SetAsideRows(outcomes));
  return html + "</body></html>\n";
}

}  // namespace thalweg::cli
