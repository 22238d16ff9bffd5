#include "services/cli/report/trajectory_picture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/drawing/canvas.h"

namespace thalweg::cli {
namespace {

constexpr int kTrajectoryWidth = 900;
constexpr int kTrajectoryHeight = 760;
constexpr double kTrajectoryMargin = 40.0;
constexpr double kLine = 22.0;

/// A round length of about a fifth of the given one.
double RulerFor(double length) {
  const double wanted = length / 5.0;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double step : {5.0, 2.0, 1.0}) {
    if (step * decade <= wanted) return step * decade;
  }
  return decade;
}

std::string LengthText(double meters) {
  const bool small = meters < 0.1;
  const double value = small ? 1000.0 * meters : meters;
  return fmt::format("{:g} {}", value, small ? "mm" : "m");
}

}  // namespace

cv::Mat Draw(const TrajectoryPicture& picture) {
  Canvas canvas(kTrajectoryWidth, kTrajectoryHeight);
  double y = kTrajectoryMargin + 6.0;
  canvas.Text(picture.title, {kTrajectoryMargin, y}, 15.0, colors::kInk, Align::kLeft, true);
  for (const std::string& line : picture.lines) {
    y += kLine;
    canvas.Text(line, {kTrajectoryMargin, y}, 10.0, colors::kMuted);
  }

  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : picture.path) box.extend(p);
  for (const Eigen::Vector3d& p : picture.true_path) box.extend(p);
  if (box.isEmpty()) return canvas.Picture();
  std::array<Eigen::Index, 3> axes = {0, 1, 2};
  const Eigen::Vector3d sizes = box.sizes();
  std::stable_sort(axes.begin(), axes.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return sizes[a] > sizes[b]; });
  const Area area{kTrajectoryMargin, y + kLine, kTrajectoryWidth - 2 * kTrajectoryMargin,
                  kTrajectoryHeight - y - kLine - 2 * kTrajectoryMargin};
  canvas.Fill(area, colors::kPanel);
  const double across = std::max(sizes[axes[0]], 1e-3);
  const double upward = std::max(sizes[axes[1]], 1e-3);
  const double scale = 0.9 * std::min(area.width / across, area.height / upward);
  const auto place = [&](const std::vector<Eigen::Vector3d>& path) {
    std::vector<cv::Point2d> points;
    for (const Eigen::Vector3d& p : path) {
      const Eigen::Vector3d d = p - box.center();
      points.emplace_back(area.x + 0.5 * area.width + scale * d[axes[0]],
                          area.y + 0.5 * area.height - scale * d[axes[1]]);
    }
    return points;
  };
  if (!picture.true_path.empty()) canvas.Polyline(place(picture.true_path), colors::kGood, 3.0);
  canvas.Polyline(place(picture.path), colors::kAccent, 1.2);
  canvas.Disc(place({picture.path.front()}).front(), 4.0, colors::kInk);

  const double ruler = RulerFor(area.width / scale);
  const double below = kTrajectoryHeight - kTrajectoryMargin;
  canvas.Line({kTrajectoryMargin, below}, {kTrajectoryMargin + scale * ruler, below}, colors::kInk, 2.0);
  canvas.Text(LengthText(ruler), {kTrajectoryMargin + scale * ruler + 8.0, below + 4.0}, 10.0, colors::kInk);
  canvas.Text("estimate", {kTrajectoryWidth - kTrajectoryMargin, below + 4.0}, 10.0, colors::kAccent,
              Align::kRight);
  if (!picture.true_path.empty()) {
    canvas.Text("truth", {kTrajectoryWidth - kTrajectoryMargin - 90.0, below + 4.0}, 10.0, colors::kGood,
                Align::kRight);
  }
  return canvas.Picture();
}

}  // namespace thalweg::cli
