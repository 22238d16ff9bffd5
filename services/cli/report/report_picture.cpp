#include "services/cli/report/report_picture.h"

#include <fmt/format.h>

#include <algorithm>

#include "services/cli/report/chart.h"
#include "services/cli/report/live_line.h"
#include "services/cli/report/map_picture.h"

namespace thalweg::cli {
namespace {

constexpr int kReportWidth = 1920;
constexpr int kReportHeight = 1200;
constexpr double kReportMargin = 56.0;

struct Figure {
  std::string value;
  std::string meaning;
  cv::Scalar color = colors::kInk;
};

std::vector<Figure> FiguresOf(const RunRecord& record) {
  std::vector<Figure> figures;
  figures.push_back({record.stop_reason.empty() ? "running" : record.stop_reason, "stop reason",
                     record.succeeded ? colors::kGood : colors::kBad});
  figures.push_back({fmt::format("{:.1f} m", record.distance), "distance"});
  figures.push_back({ClockText(record.duration), "duration"});
  figures.push_back({fmt::format("{:.1f} m³", record.free_volume + record.occupied_volume), "explored"});
  if (record.coverage) figures.push_back({fmt::format("{:.1f} %", 100.0 * *record.coverage), "coverage"});
  if (record.agreement) figures.push_back({fmt::format("{:.1f} %", 100.0 * *record.agreement), "agreement"});
  if (record.true_collisions) {
    figures.push_back({std::to_string(*record.true_collisions), "collisions",
                       *record.true_collisions == 0 ? colors::kGood : colors::kBad});
  }
  return figures;
}

void DrawHeader(Canvas& canvas, const RunRecord& record) {
  std::string line = "scenario " + record.scenario;
  if (!record.strategy.empty()) line += ", strategy " + record.strategy;
  if (record.plans > 0) line += ", " + std::to_string(record.plans) + " plans";
  canvas.Text(line, {kReportMargin, 112}, 13.0, colors::kMuted);

  double right = kReportWidth - kReportMargin;
  const std::vector<Figure> figures = FiguresOf(record);
  for (auto figure = figures.rbegin(); figure != figures.rend(); ++figure) {
    const double width =
        std::max(Canvas::TextWidth(figure->value, 20.0, true), Canvas::TextWidth(figure->meaning, 11.0));
    canvas.Text(figure->value, {right, 78}, 20.0, figure->color, Align::kRight, true);
    canvas.Text(figure->meaning, {right, 112}, 11.0, colors::kMuted, Align::kRight);
    right -= width + 44;
  }
  const std::string title = record.title.empty() ? record.scenario : record.title;
  constexpr double kTitle = 27.0;
  const double fits = kTitle * (right - kReportMargin) / Canvas::TextWidth(title, kTitle, true);
  canvas.Text(title, {kReportMargin, 78}, std::clamp(fits, 12.0, kTitle), colors::kInk, Align::kLeft, true);
  canvas.Line({kReportMargin, 140}, {kReportWidth - kReportMargin, 140}, colors::kRule, 1.5);
}

void DrawCurves(Canvas& canvas, const Area& area, const RunRecord& record) {
  const bool covered = std::any_of(record.progress.begin(), record.progress.end(),
                                   [](const ProgressSample& sample) { return sample.coverage.has_value(); });
  Chart over_distance;
  Chart over_time;
  over_distance.series.resize(1);
  over_time.series.resize(1);
  double highest = 0.0;
  for (const ProgressSample& sample : record.progress) {
    const double y = covered ? 100.0 * sample.coverage.value_or(0.0) : sample.explored;
    over_distance.series[0].points.emplace_back(sample.distance, y);
    over_time.series[0].points.emplace_back(sample.time, y);
    highest = std::max(highest, y);
  }
  const std::string what = covered ? "Coverage" : "Explored volume";
  over_distance.title = what + " over distance";
  over_time.title = what + " over time";
  over_distance.x_label = "distance [m]";
  over_time.x_label = "time [s]";
  over_distance.y_label = over_time.y_label = covered ? "coverage [%]" : "explored [m³]";
  over_distance.y_max = over_time.y_max = covered ? 100.0 : std::max(1.0, 1.08 * highest);
  over_distance.x_max = std::max(1.0, record.distance);
  over_time.x_max = std::max(1.0, record.duration);
  const double half = 0.5 * (area.height - 20);
  DrawChart(canvas, {area.x, area.y, area.width, half}, over_distance);
  DrawChart(canvas, {area.x, area.y + half + 20, area.width, half}, over_time);
}

void DrawFooter(Canvas& canvas, const RunRecord& record) {
  canvas.Text(FrontiersInWords(record), {kReportMargin, kReportHeight - 28}, 11.0, colors::kMuted);
}

}  // namespace

std::vector<TimedPose> PathUntilEnd(const RunRecord& record) {
  constexpr double kRounding = 1e-6;  // [s]
  std::vector<TimedPose> poses;
  for (const TimedPose& pose : record.trajectory) {
    if (Seconds(pose.stamp - record.trajectory.front().stamp) > record.duration + kRounding) break;
    poses.push_back(pose);
  }
  return poses;
}

std::string FrontiersInWords(const RunRecord& record) {
  std::string line = record.frontiers_left == 1
                         ? "1 frontier (a place where the unknown begins) left to see"
                         : std::to_string(record.frontiers_left) +
                               " frontiers (places where the unknown begins) left to see";
  for (const FrontiersSetAside& entry : record.set_aside) {
    line += (&entry == &record.set_aside.front() ? "; set aside: " : ", ") + std::to_string(entry.clusters) +
            " " + entry.reason;
  }
  return line;
}

cv::Mat DrawReport(const RunRecord& record, const OccupancyGrid* map) {
  Canvas canvas(kReportWidth, kReportHeight);
  DrawHeader(canvas, record);
  const double top = 164.0;
  const double height = kReportHeight - top - 62;
  const Area left{kReportMargin, top, 1060, height};
  const Area right{left.right() + 36, top, kReportWidth - kReportMargin - left.right() - 36, height};
  const std::vector<TimedPose> path = PathUntilEnd(record);
  DrawMap(canvas, left, map ? LookFromAbove(*map, path) : MapFromAbove{}, path);
  DrawCurves(canvas, right, record);
  DrawFooter(canvas, record);
  return canvas.Picture();
}

}  // namespace thalweg::cli
