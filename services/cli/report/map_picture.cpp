#include "services/cli/report/map_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <unordered_map>

#include "services/cli/report/chart.h"
#include "services/cli/report/live_line.h"

namespace thalweg::cli {
namespace {

/// One column of voxels: what is known in it, by z.
struct Column {
  std::vector<int> occupied;
  int highest_free = std::numeric_limits<int>::min();
};

using Columns = std::unordered_map<VoxelIndex, Column, VoxelIndexHash>;

Columns ColumnsOf(const OccupancyGrid& grid) {
  Columns columns;
  grid.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    Column& column = columns[{i.x, i.y, 0}];
    if (OccupancyGrid::StateOf(log_odds) == VoxelState::kFree) {
      column.highest_free = std::max(column.highest_free, i.z);
    } else {
      column.occupied.push_back(i.z);
    }
  });
  return columns;
}

using Gradient = std::vector<cv::Vec3d>;  // blue, green, red

// From the floor up: warm white to deep blue-green.
const Gradient kHeights{{232, 240, 243}, {200, 222, 214}, {176, 192, 150}, {150, 150, 92}, {104, 96, 44}};
// Along time: violet to orange to yellow.
const Gradient kTimes{{140, 20, 92}, {120, 50, 190}, {60, 96, 236}, {40, 160, 250}, {60, 214, 252}};
const cv::Vec3b kWallColor{92, 78, 66};
const cv::Vec3b kUnknownColor{246, 244, 242};
const cv::Vec3b kHollowColor{236, 206, 226};

cv::Vec3d ColorAt(const Gradient& gradient, double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(gradient.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), gradient.size() - 2);
  const double rest = at - static_cast<double>(i);
  return (1.0 - rest) * gradient[i] + rest * gradient[i + 1];
}

cv::Scalar ScalarOf(const cv::Vec3d& color) {
  return {color[0], color[1], color[2]};
}

/// Light from the upper left: what is higher throws a short, soft shadow to the lower right.
double Shade(const MapFromAbove& map, int row, int column) {
  const auto rise = [&](int r, int c) {
    const bool inside = r >= 0 && c >= 0;
    const bool surface = inside && map.kind(r, c) == static_cast<std::uint8_t>(ColumnKind::kSurface);
    return surface ? std::clamp<double>(map.height(r, c) - map.height(row, column), 0.0, 0.5) : 0.0;
  };
  const double shadow = 0.5 * rise(row - 1, column) + 0.5 * rise(row, column - 1) +
                        0.5 * rise(row - 1, column - 1) + 0.3 * rise(row - 2, column - 2);
  return 1.0 - 0.35 * std::min(0.5, shadow);
}

cv::Mat Colored(const MapFromAbove& map) {
  cv::Mat_<cv::Vec3b> picture(map.kind.size(), kUnknownColor);
  const double span = std::max(map.voxel_size, map.highest - map.lowest);
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const auto kind = static_cast<ColumnKind>(map.kind(row, column));
      if (kind == ColumnKind::kWall) picture(row, column) = kWallColor;
      if (kind == ColumnKind::kHollow) picture(row, column) = kHollowColor;
      if (kind == ColumnKind::kSurface) {
        const cv::Vec3d color = ColorAt(kHeights, (map.height(row, column) - map.lowest) / span);
        picture(row, column) = color * Shade(map, row, column);
      }
    }
  }
  return picture;
}

void DrawPath(Canvas& canvas, const std::vector<cv::Point2d>& path, const std::vector<double>& shares) {
  canvas.Polyline(path, colors::kPaper, 5.5);
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    canvas.Line(path[i], path[i + 1], ScalarOf(ColorAt(kTimes, shares[i])), 2.6);
  }
}

void DrawMarker(Canvas& canvas, const cv::Point2d& at, const cv::Scalar& color, const std::string& label) {
  canvas.Disc(at, 11.0, colors::kPaper);
  canvas.Disc(at, 8.5, color);
  canvas.Text(label, {at.x, at.y + 4.5}, 9.0, colors::kPaper, Align::kCenter, true);
}

void DrawScaleBar(Canvas& canvas, const cv::Point2d& left, double px_per_meter, double longest_px) {
  double meters = 0.1;
  for (const double length : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
    if (length * px_per_meter <= longest_px) meters = length;
  }
  const double width = meters * px_per_meter;
  canvas.Line(left, {left.x + width, left.y}, colors::kInk, 2.0);
  canvas.Line({left.x, left.y - 5}, {left.x, left.y + 5}, colors::kInk, 2.0);
  canvas.Line({left.x + width, left.y - 5}, {left.x + width, left.y + 5}, colors::kInk, 2.0);
  canvas.Text(TickText(meters, std::min(1.0, meters)) + " m", {left.x + 0.5 * width, left.y + 24}, 11.0,
              colors::kInk, Align::kCenter);
}

/// A square of the color, with its meaning beside it. @return  Where the next one may begin.
double DrawSwatch(Canvas& canvas, const cv::Point2d& at, const cv::Vec3b& color, const std::string& meaning) {
  constexpr double kSide = 13.0;
  constexpr double kText = 10.0;
  const Area square{at.x, at.y - 0.5 * kSide, kSide, kSide};
  canvas.Fill(square,
              {static_cast<double>(color[0]), static_cast<double>(color[1]), static_cast<double>(color[2])});
  canvas.Frame(square, colors::kMuted, 1.0);
  canvas.Text(meaning, {square.right() + 8, at.y + 0.5 * kText}, kText, colors::kInk);
  return square.right() + 8 + Canvas::TextWidth(meaning, kText) + 30;
}

/// A bar with the gradient, its meaning above and text at its ends; where both say the same there is but one
/// color, the lowest.
void DrawKey(Canvas& canvas, const Area& bar, const Gradient& gradient, const std::string& meaning,
             const std::string& low, const std::string& high) {
  canvas.Text(meaning, {bar.x + 0.5 * bar.width, bar.y - 8}, 10.0, colors::kMuted, Align::kCenter);
  if (low == high) {
    const Area swatch{bar.x + 0.5 * bar.width - bar.height, bar.y, 2.0 * bar.height, bar.height};
    canvas.Fill(swatch, ScalarOf(gradient.front()));
    canvas.Frame(swatch, colors::kMuted, 1.0);
    canvas.Text(low, {bar.x + 0.5 * bar.width, bar.bottom() + 18}, 10.0, colors::kInk, Align::kCenter);
    return;
  }
  cv::Mat_<cv::Vec3b> strip(1, 256);
  for (int i = 0; i < strip.cols; ++i) strip(0, i) = ColorAt(gradient, i / 255.0);
  canvas.Image(bar, strip);
  canvas.Text(low, {bar.x, bar.bottom() + 18}, 10.0, colors::kInk);
  canvas.Text(high, {bar.right(), bar.bottom() + 18}, 10.0, colors::kInk, Align::kRight);
}

}  // namespace

MapFromAbove LookFromAbove(const OccupancyGrid& grid) {
  MapFromAbove map;
  map.voxel_size = grid.voxel_size();
  const Columns columns = ColumnsOf(grid);
  if (columns.empty()) return map;
  map.min_x = map.min_y = std::numeric_limits<int>::max();
  int max_x = std::numeric_limits<int>::min();
  int max_y = max_x;
  for (const auto& [i, column] : columns) {
    map.min_x = std::min(map.min_x, i.x);
    map.min_y = std::min(map.min_y, i.y);
    max_x = std::max(max_x, i.x);
    max_y = std::max(max_y, i.y);
  }
  map.kind.create(max_y - map.min_y + 1, max_x - map.min_x + 1);
  map.kind.setTo(static_cast<double>(ColumnKind::kUnknown));
  map.height.create(map.kind.size());
  map.height.setTo(0.0);

  std::vector<double> heights;
  for (const auto& [i, column] : columns) {
    const int row = max_y - i.y;
    const int at = i.x - map.min_x;
    int top = std::numeric_limits<int>::min();
    for (const int z : column.occupied) {
      if (z < column.highest_free) top = std::max(top, z);
    }
    ColumnKind kind = ColumnKind::kHollow;
    if (top > std::numeric_limits<int>::min()) {
      kind = ColumnKind::kSurface;
      map.height(row, at) = static_cast<float>((top + 1) * map.voxel_size);
      heights.push_back(map.height(row, at));
    } else if (column.highest_free == std::numeric_limits<int>::min()) {
      kind = ColumnKind::kWall;
    }
    map.kind(row, at) = static_cast<std::uint8_t>(kind);
  }
  if (!heights.empty()) {
    std::sort(heights.begin(), heights.end());
    map.lowest = heights[heights.size() / 100];
    map.highest = heights[heights.size() - 1 - heights.size() / 100];
  }
  return map;
}

void DrawMap(Canvas& canvas, const Area& area, const MapFromAbove& map,
             const std::vector<TimedPose>& trajectory) {
  constexpr double kFooter = 116.0;
  canvas.Fill(area, colors::kPanel);
  if (map.kind.empty()) {
    canvas.Text("no map", {area.x + 0.5 * area.width, area.y + 0.5 * area.height}, 14.0, colors::kMuted,
                Align::kCenter);
    return;
  }
  const Area room{area.x + 22, area.y + 22, area.width - 44, area.height - 44 - kFooter};
  const double px_per_voxel = std::min(room.width / map.kind.cols, room.height / map.kind.rows);
  const double width = px_per_voxel * map.kind.cols;
  const double height = px_per_voxel * map.kind.rows;
  const Area place{room.x + 0.5 * (room.width - width), room.y + 0.5 * (room.height - height), width, height};
  canvas.Image(place, Colored(map));

  const double px_per_meter = px_per_voxel / map.voxel_size;
  std::vector<cv::Point2d> path;
  std::vector<double> shares;
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& p_W = pose.T.translation();
    const cv::Point2d at(place.x + (p_W.x() - map.min_x * map.voxel_size) * px_per_meter,
                         place.bottom() - (p_W.y() - map.min_y * map.voxel_size) * px_per_meter);
    if (!path.empty() && cv::norm(at - path.back()) < 1.0) continue;
    path.push_back(at);
    const double whole = Seconds(trajectory.back().stamp - trajectory.front().stamp);
    shares.push_back(whole > 0.0 ? Seconds(pose.stamp - trajectory.front().stamp) / whole : 0.0);
  }
  DrawPath(canvas, path, shares);
  if (!path.empty()) {
    DrawMarker(canvas, path.back(), ScalarOf(kTimes.back()), "E");
    DrawMarker(canvas, path.front(), ScalarOf(kTimes[0]), "S");
  }

  const double line = area.bottom() - 88;
  DrawScaleBar(canvas, {area.x + 28, line}, px_per_meter, 0.22 * area.width);
  const double bar = 0.24 * area.width;
  DrawKey(canvas, {area.x + 0.36 * area.width, line - 5, bar, 10}, kHeights, "height of the surface",
          TickText(map.lowest, 0.1) + " m", TickText(map.highest, 0.1) + " m");
  if (trajectory.size() > 1) {
    DrawKey(canvas, {area.right() - 28 - bar, line - 5, bar, 10}, kTimes, "path, by time", "0:00",
            ClockText(Seconds(trajectory.back().stamp - trajectory.front().stamp)));
  }
  constexpr double kLeastForWords = 800.0;
  if (area.width < kLeastForWords) return;
  const double swatches = area.bottom() - 26;
  double x = area.x + 28;
  x = DrawSwatch(canvas, {x, swatches}, kWallColor, "solid over its whole height");
  x = DrawSwatch(canvas, {x, swatches}, kHollowColor, "free, the surface below not seen");
  x = DrawSwatch(canvas, {x, swatches}, kUnknownColor, "unknown");
  canvas.Text("S start, E end of the path", {area.right() - 28, swatches + 5}, 10.0, colors::kInk,
              Align::kRight);
}

}  // namespace thalweg::cli
