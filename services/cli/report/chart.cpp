#include "services/cli/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace thalweg::cli {

std::vector<double> NiceTicks(double low, double high, int count) {
  if (!(high > low) || count < 1) return {low};
  const double rough = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * (1.0 - 1e-9)) {
      step = factor * power;
      break;
    }
  }
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    ticks.push_back(k * step + 0.0);  // avoids -0
  return ticks;
}

std::string TickText(double value, double spacing) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(spacing) - 1e-9)), 0, 6);
  return fmt::format("{:.{}f}", value, digits);
}

void DrawChart(Canvas& canvas, const Area& area, const Chart& chart) {
  constexpr double kLabel = 11.0;
  const Area plot{area.x + 78, area.y + 40, area.width - 96, area.height - 104};
  const auto place = [&](const cv::Point2d& p) {
    return cv::Point2d(plot.x + plot.width * p.x / chart.x_max,
                       plot.bottom() - plot.height * std::min(1.0, p.y / chart.y_max));
  };

  canvas.Text(chart.title, {plot.x, area.y + 20}, 13.0, colors::kInk, Align::kLeft, true);
  const std::vector<double> y_ticks = NiceTicks(0.0, chart.y_max, 5);
  const double y_step = y_ticks.size() > 1 ? y_ticks[1] - y_ticks[0] : 1.0;
  for (const double y : y_ticks) {
    const cv::Point2d at = place({0.0, y});
    canvas.Line(at, {plot.right(), at.y}, colors::kRule, 1.0);
    canvas.Text(TickText(y, y_step), {plot.x - 10, at.y + 0.5 * kLabel}, kLabel, colors::kMuted,
                Align::kRight);
  }
  const std::vector<double> x_ticks = NiceTicks(0.0, chart.x_max, 6);
  const double x_step = x_ticks.size() > 1 ? x_ticks[1] - x_ticks[0] : 1.0;
  for (const double x : x_ticks) {
    const cv::Point2d at = place({x, 0.0});
    canvas.Line(at, {at.x, at.y + 6}, colors::kMuted, 1.0);
    canvas.Text(TickText(x, x_step), {at.x, at.y + 12 + kLabel}, kLabel, colors::kMuted, Align::kCenter);
  }

  double key_y = plot.bottom() - 20.0 * static_cast<double>(chart.series.size());
  for (const Chart::Series& series : chart.series) {
    std::vector<cv::Point2d> curve;
    for (const cv::Point2d& p : series.points) curve.push_back(place(p));
    if (chart.series.size() == 1) canvas.FillBelow(curve, plot.bottom(), series.color, 0.14);
    canvas.Polyline(curve, series.color, 2.5);
    if (!curve.empty()) canvas.Disc(curve.back(), 5.0, series.color);
    if (chart.series.size() == 1) continue;
    canvas.Line({plot.right() - 30, key_y}, {plot.right() - 6, key_y}, series.color, 3.0);
    canvas.Text(series.name, {plot.right() - 38, key_y + 0.5 * kLabel}, kLabel, colors::kInk, Align::kRight);
    key_y += 20.0;
  }
  canvas.Line({plot.x, plot.bottom()}, {plot.right(), plot.bottom()}, colors::kMuted, 1.0);
  canvas.Text(chart.x_label, {plot.x + 0.5 * plot.width, plot.bottom() + 50}, kLabel + 1, colors::kInk,
              Align::kCenter);
  canvas.TextUpwards(chart.y_label, {area.x + 12, plot.y + 0.5 * plot.height}, kLabel + 1, colors::kInk);
}

}  // namespace thalweg::cli
