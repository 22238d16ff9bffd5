#include "services/cli/report/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "common/base/text.h"
#include "services/cli/report/chart.h"
#include "services/cli/report/evaluation_tables.h"
#include "services/cli/report/evaluation_verdict.h"
#include "services/cli/report/map_picture.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::cli {
namespace {

using evaluator::Outcome;

// Distinguishable with any color vision [Okabe, Ito: Color universal design, 2008]; blue, green, red.
const std::array<cv::Scalar, 7> kStrategyColors = {
    cv::Scalar{178, 114, 0}, {0, 94, 213},   {115, 158, 0}, {167, 121, 204},
    {0, 159, 230},           {233, 180, 86}, {0, 0, 0}};

std::vector<std::string> StrategiesOf(std::span<const Outcome> outcomes, const std::string& scenario) {
  std::vector<std::string> names;
  for (const Outcome& outcome : outcomes) {
    if (outcome.scenario != scenario) continue;
    if (std::find(names.begin(), names.end(), outcome.strategy) == names.end())
      names.push_back(outcome.strategy);
  }
  return names;
}

/// An axis over which coverage is drawn: distance or time.
struct Course {
  const char* title;
  const char* label;
  double Outcome::*length;
  double Outcome::Progress::*at;
};
constexpr Course kCourses[] = {{"distance", "distance [m]", &Outcome::distance, &Outcome::Progress::distance},
                               {"time", "time [s]", &Outcome::duration, &Outcome::Progress::time}};

Chart ChartOf(std::span<const Outcome> outcomes, const std::string& scenario, const Course& course) {
  Chart chart;
  chart.title = scenario + ": mean coverage over " + course.title;
  chart.x_label = course.label;
  chart.y_label = "coverage [%]";
  chart.y_max = 100.0;
  const std::vector<std::string> strategies = StrategiesOf(outcomes, scenario);
  for (std::size_t n = 0; n < strategies.size(); ++n) {
    std::vector<const Outcome*> of;
    double longest = 0.0;
    for (const Outcome& outcome : outcomes) {
      if (outcome.scenario != scenario || outcome.strategy != strategies[n]) continue;
      of.push_back(&outcome);
      longest = std::max(longest, outcome.*course.length);
    }
    Chart::Series series{strategies[n], kStrategyColors[n % kStrategyColors.size()], {}};
    constexpr int kPoints = 300;
    for (int k = 0; k <= kPoints; ++k) {
      const double at = longest * k / kPoints;
      double sum = 0.0;
      for (const Outcome* outcome : of) sum += evaluator::CoverageAt(*outcome, course.at, at);
      series.points.emplace_back(at, 100.0 * sum / static_cast<double>(of.size()));
    }
    chart.x_max = std::max(chart.x_max, longest);
    chart.series.push_back(std::move(series));
  }
  return chart;
}

/// Breaks a text into lines of at most 120 characters: the first is indented by two, the others by four.
std::string Wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 120;
  std::string lines;
  std::string line = " ";
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > kWidth) {
      lines += line + '\n';
      line = "   ";
    }
    line += " " + word;
  }
  return lines + line + '\n';
}

}  // namespace

cv::Mat DrawCoverageCurves(std::span<const Outcome> outcomes, const std::string& scenario) {
  constexpr int kWidth = 820;
  constexpr int kHeight = 520;
  Canvas canvas(2 * kWidth, kHeight);
  double x = 30.0;
  for (const Course& course : kCourses) {
    DrawChart(canvas, {x, 10, kWidth - 60.0, kHeight - 20.0}, ChartOf(outcomes, scenario, course));
    x += kWidth;
  }
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
    canvas.Text(fmt::format("{}, start {}: {:.1f} m, {}", of[n]->strategy, of[n]->seed, of[n]->distance,
                            ToText(of[n]->end)),
                {x + 30, y + 30}, 13.0, colors::kInk, Align::kLeft, true);
    std::vector<TimedPose> path;
    for (const Outcome::Progress& progress : of[n]->progress) {
      path.push_back(
          {Time{} + FromSeconds(progress.time), MakeTransform(Eigen::Matrix3d::Identity(), progress.p_W)});
    }
    DrawMap(canvas, {x + 20, y + 44, kWidth - 40.0, kHeight - 60.0}, map, path);
  }
  return canvas.Picture();
}

std::string EvaluationText(std::span<const Outcome> outcomes, std::span<const std::string> overrides) {
  const Table summary = SummaryTable(outcomes);
  const Table comparison = ComparisonTable(outcomes);
  std::string text = overrides.empty() ? "" : "all runs with " + Joined(overrides) + "\n\n";
  text += ToText(summary);
  std::vector<std::string> columns;
  for (const std::size_t column : summary.terminal_columns) columns.push_back(summary.header[column]);
  if (!comparison.rows.empty()) {
    text += '\n' + ToText(comparison);
    columns.insert(columns.end(), comparison.header.begin(), comparison.header.end());
  }
  for (const Table& table : {TimeTable(outcomes), OptimumTable(outcomes), TailTable(outcomes),
                             SurfaceTable(outcomes), NoiseTable(outcomes), OdometryTable(outcomes)}) {
    if (table.rows.empty()) continue;
    text += '\n' + ToText(table);
    columns.insert(columns.end(), table.header.begin(), table.header.end());
  }
  text += '\n';
  for (const std::string& note : NotesOn(columns)) text += Wrapped(note);
  text += '\n';
  for (const Verdict& verdict : VerdictsOn(outcomes)) text += verdict.text + '\n';
  return text;
}

}  // namespace thalweg::cli
