#pragma once

#include <string>
#include <vector>

#include "common/drawing/canvas.h"

namespace thalweg::cli {

/// Round numbers within [low, high], about `count` of them, spaced by 1, 2 or 5 times a power of ten.
std::vector<double> NiceTicks(double low, double high, int count);

/// The shortest text that distinguishes ticks of the given spacing.
std::string TickText(double value, double spacing);

struct Chart {
  std::string title;
  std::string x_label;
  std::string y_label;
  double y_max = 1.0;  ///< The axes begin at 0.
  double x_max = 1.0;
  struct Series {
    std::string name;  ///< For the key; a single series has none.
    cv::Scalar color = colors::kAccent;
    std::vector<cv::Point2d> points;  ///< In data units, x ascending.
  };
  std::vector<Series> series;
};

/// Draws curves with axes, ticks, grid, labels and, if there are several, a key.
void DrawChart(Canvas& canvas, const Area& area, const Chart& chart);

}  // namespace thalweg::cli
