#pragma once

#include <string>
#include <vector>

#include "services/cli/report/canvas.h"

namespace thalweg::cli {

/// Round numbers, 1, 2 or 5 times a power of ten apart, that lie within [low, high]: about `count` of them.
std::vector<double> NiceTicks(double low, double high, int count);

/// The shortest text that tells ticks of that spacing apart.
std::string TickText(double value, double spacing);

struct Chart {
  std::string title;
  std::string x_label;
  std::string y_label;
  double y_max = 1.0;  ///< The axes begin at 0.
  double x_max = 1.0;
  std::vector<cv::Point2d> points;  ///< In data units, x ascending.
};

/// Draws a curve with axes, ticks, grid and labels.
void DrawChart(Canvas& canvas, const Area& area, const Chart& chart);

}  // namespace thalweg::cli
