#include "services/cli/report/map_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "services/cli/report/chart.h"
#include "services/cli/report/live_line.h"

namespace thalweg::cli {
namespace {

constexpr int kEdge = OccupancyGrid::kBlockEdge;
constexpr int kNowhere = std::numeric_limits<int>::min();

/// The blocks of one column of blocks, from the top down.
struct Tile {
  std::vector<std::pair<int, const OccupancyGrid::Block*>> blocks;  ///< With their z.
  int columns = 0;                                                  ///< Columns with known voxels.
  int part = -1;                                                    ///< Index of its part.
};

/// By block index with z = 0.
using Tiles = std::unordered_map<VoxelIndex, Tile, VoxelIndexHash>;

/// What is known in one column of voxels.
struct Column {
  ColumnKind kind = ColumnKind::kUnknown;
  int top = kNowhere;  ///< z of the surface.
};

Column LookAt(const Tile& tile, int x, int y) {
  Column column;
  bool under_free = false;
  for (const auto& [block_z, block] : tile.blocks) {
    for (int z = kEdge - 1; z >= 0; --z) {
      const float log_odds = (*block)[OccupancyGrid::OffsetInBlock({x, y, z})];
      const VoxelState state = OccupancyGrid::StateOf(log_odds);
      if (state == VoxelState::kUnknown) continue;
      if (state == VoxelState::kFree) {
        under_free = true;
        column.kind = ColumnKind::kHollow;
      } else if (under_free) {
        return {ColumnKind::kSurface, block_z * kEdge + z};
      } else {
        column.kind = ColumnKind::kWall;
      }
    }
  }
  return column;
}

template <class Visitor>
void ForEachColumn(const VoxelIndex& at, const Tile& tile, Visitor&& visit) {
  for (int y = 0; y < kEdge; ++y) {
    for (int x = 0; x < kEdge; ++x) {
      const Column column = LookAt(tile, x, y);
      if (column.kind != ColumnKind::kUnknown) visit(at.x * kEdge + x, at.y * kEdge + y, column);
    }
  }
}

Tiles TilesOf(const OccupancyGrid& grid) {
  Tiles tiles;
  grid.ForEachBlock([&](const VoxelIndex& index, const OccupancyGrid::Block& block) {
    tiles[{index.x, index.y, 0}].blocks.emplace_back(index.z, &block);
  });
  for (auto& [at, tile] : tiles) {
    std::sort(tile.blocks.begin(), tile.blocks.end(), std::greater());
    ForEachColumn(at, tile, [&columns = tile.columns](int, int, const Column&) { ++columns; });
  }
  std::erase_if(tiles, [](const auto& entry) { return entry.second.columns == 0; });
  return tiles;
}

/// A rectangle of tiles or columns, both ends included.
struct Extent {
  VoxelIndex min{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), 0};
  VoxelIndex max{kNowhere, kNowhere, 0};

  void Include(const VoxelIndex& i) {
    min = {std::min(min.x, i.x), std::min(min.y, i.y), 0};
    max = {std::max(max.x, i.x), std::max(max.y, i.y), 0};
  }
  Extent With(const Extent& other) const {
    Extent both = *this;
    both.Include(other.min);
    both.Include(other.max);
    return both;
  }
  std::int64_t width() const { return static_cast<std::int64_t>(max.x) - min.x + 1; }
  std::int64_t height() const { return static_cast<std::int64_t>(max.y) - min.y + 1; }
  bool Contains(const VoxelIndex& i) const {
    return i.x >= min.x && i.x <= max.x && i.y >= min.y && i.y <= max.y;
  }
};

/// Tiles that touch each other, also at corners.
struct Part {
  Extent extent;
  std::int64_t columns = 0;
  std::size_t poses = 0;  ///< How many the path has.
};

std::vector<Part> PartsOf(Tiles& tiles) {
  std::vector<Part> parts;
  std::vector<VoxelIndex> open;
  for (auto& [seed, seed_tile] : tiles) {
    if (seed_tile.part >= 0) continue;
    const int number = static_cast<int>(parts.size());
    Part& part = parts.emplace_back();
    seed_tile.part = number;
    open.push_back(seed);
    while (!open.empty()) {
      const VoxelIndex at = open.back();
      open.pop_back();
      part.extent.Include(at);
      part.columns += tiles.at(at).columns;
      for (int k = 0; k < 9; ++k) {
        const VoxelIndex beside = at + VoxelIndex{k % 3 - 1, k / 3 - 1, 0};
        const auto found = tiles.find(beside);
        if (found == tiles.end() || found->second.part >= 0) continue;
        found->second.part = number;
        open.push_back(beside);
      }
    }
  }
  return parts;
}

void CountPoses(const Tiles& tiles, const std::vector<TimedPose>& path, double voxel_size,
                std::vector<Part>& parts) {
  for (const TimedPose& pose : path) {
    const Eigen::Vector3d tile = pose.T.translation() / (voxel_size * kEdge);
    if (!(tile.cwiseAbs().maxCoeff() <= kMaxVoxelIndex)) continue;
    const auto found =
        tiles.find({static_cast<int>(std::floor(tile.x())), static_cast<int>(std::floor(tile.y())), 0});
    if (found != tiles.end()) ++parts[static_cast<std::size_t>(found->second.part)].poses;
  }
}

/// The tiles to be drawn: the most important part, and the others in the order of their importance as far as
/// the picture stays small enough.
Extent ChooseExtent(Tiles& tiles, const std::vector<TimedPose>& path, double voxel_size) {
  std::vector<Part> parts = PartsOf(tiles);
  CountPoses(tiles, path, voxel_size, parts);
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    const auto rank = [](const Part& part) {
      return std::tuple(part.poses, part.columns, part.extent.min.x, part.extent.min.y);
    };
    return rank(a) > rank(b);
  });
  Extent chosen = parts.front().extent;
  const std::int64_t most_wide = std::max(std::int64_t{kMostEdge / kEdge}, chosen.width());
  const std::int64_t most_high = std::max(std::int64_t{kMostEdge / kEdge}, chosen.height());
  for (const Part& part : parts) {
    const Extent larger = chosen.With(part.extent);
    if (larger.width() <= most_wide && larger.height() <= most_high) chosen = larger;
  }
  return chosen;
}

int VoxelsPerPixel(const Extent& columns) {
  int edge = 1;
  const auto pixels = [&] {
    return (columns.width() + edge - 1) / edge * ((columns.height() + edge - 1) / edge);
  };
  while (pixels() > std::int64_t{kMostEdge} * kMostEdge) ++edge;
  return edge;
}

/// Which of several columns a pixel shows.
int RankOf(ColumnKind kind) {
  switch (kind) {
    case ColumnKind::kWall:
      return 3;
    case ColumnKind::kSurface:
      return 2;
    case ColumnKind::kHollow:
      return 1;
    case ColumnKind::kUnknown:
      break;
  }
  return 0;
}

using Gradient = std::vector<cv::Vec3d>;  // blue, green, red

// From the floor up: warm white to deep blue-green.
const Gradient kHeights{{232, 240, 243}, {200, 222, 214}, {176, 192, 150}, {150, 150, 92}, {104, 96, 44}};
// Over time: violet to orange to yellow.
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

/// Light from the upper left: higher surfaces cast a short, soft shadow to the lower right.
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

/// Draws a bar with the gradient, its meaning above and a text at either end. If the two texts are equal, the
/// bar has only one color, the lowest.
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

MapFromAbove LookFromAbove(const OccupancyGrid& grid, const std::vector<TimedPose>& path) {
  MapFromAbove map;
  map.voxel_size = grid.voxel_size();
  Tiles tiles = TilesOf(grid);
  if (tiles.empty()) return map;
  const Extent chosen = ChooseExtent(tiles, path, map.voxel_size);
  Extent drawn;
  int beyond = 0;  // [tiles]
  for (const auto& [at, tile] : tiles) {
    map.columns += static_cast<std::size_t>(tile.columns);
    if (chosen.Contains(at)) {
      ForEachColumn(at, tile, [&](int x, int y, const Column&) { drawn.Include({x, y, 0}); });
      continue;
    }
    map.columns_left_out += static_cast<std::size_t>(tile.columns);
    beyond = std::max(
        {beyond, chosen.min.x - at.x, at.x - chosen.max.x, chosen.min.y - at.y, at.y - chosen.max.y});
  }
  map.left_out_beyond = beyond * kEdge * map.voxel_size;
  map.min_x = drawn.min.x;
  map.min_y = drawn.min.y;
  map.voxels_per_pixel = VoxelsPerPixel(drawn);
  const int edge = map.voxels_per_pixel;
  map.kind.create(static_cast<int>((drawn.height() + edge - 1) / edge),
                  static_cast<int>((drawn.width() + edge - 1) / edge));
  map.kind.setTo(static_cast<double>(ColumnKind::kUnknown));
  map.height.create(map.kind.size());
  map.height.setTo(0.0);

  for (const auto& [at, tile] : tiles) {
    if (!chosen.Contains(at)) continue;
    ForEachColumn(at, tile, [&](int x, int y, const Column& column) {
      const int row = map.kind.rows - 1 - (y - map.min_y) / edge;
      const int pixel = (x - map.min_x) / edge;
      std::uint8_t& kind = map.kind(row, pixel);
      float& height = map.height(row, pixel);
      const int rank = RankOf(column.kind) - RankOf(static_cast<ColumnKind>(kind));
      const bool surface = column.kind == ColumnKind::kSurface;
      const auto top = surface ? static_cast<float>((column.top + 1) * map.voxel_size) : 0.0F;
      if (rank < 0 || (rank == 0 && !(surface && top > height))) return;
      kind = static_cast<std::uint8_t>(column.kind);
      height = top;
    });
  }
  std::vector<float> heights;
  for (int row = 0; row < map.kind.rows; ++row) {
    for (int pixel = 0; pixel < map.kind.cols; ++pixel) {
      if (map.kind(row, pixel) == static_cast<std::uint8_t>(ColumnKind::kSurface))
        heights.push_back(map.height(row, pixel));
    }
  }
  if (!heights.empty()) {
    std::sort(heights.begin(), heights.end());
    map.lowest = heights[heights.size() / 100];
    map.highest = heights[heights.size() - 1 - heights.size() / 100];
  }
  return map;
}

std::string LeftOutText(const MapFromAbove& map) {
  if (map.columns_left_out == 0) return "";
  return fmt::format("{} of {} known columns are not drawn: they lie up to {:.0f} m outside",
                     map.columns_left_out, map.columns, map.left_out_beyond);
}

cv::Mat PixelsOf(const MapFromAbove& map) {
  const cv::Mat_<cv::Vec3b> colored = Colored(map);
  cv::Mat_<cv::Vec4b> pixels(map.kind.size());
  for (int row = 0; row < pixels.rows; ++row) {
    for (int column = 0; column < pixels.cols; ++column) {
      const cv::Vec3b& color = colored(row, column);
      const bool known = map.kind(row, column) != static_cast<std::uint8_t>(ColumnKind::kUnknown);
      pixels(row, column) = {color[0], color[1], color[2], static_cast<std::uint8_t>(known ? 255 : 0)};
    }
  }
  return pixels;
}

MapColors ColorsOfMap() {
  const auto hex = [](const cv::Vec3d& color) {
    return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(color[2]), static_cast<int>(color[1]),
                       static_cast<int>(color[0]));
  };
  MapColors colors{.heights = {}, .wall = hex(kWallColor), .hollow = hex(kHollowColor)};
  for (const cv::Vec3d& color : kHeights) colors.heights.push_back(hex(color));
  return colors;
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
  const double px_per_cell = std::min(room.width / map.kind.cols, room.height / map.kind.rows);
  const double width = px_per_cell * map.kind.cols;
  const double height = px_per_cell * map.kind.rows;
  const Area place{room.x + 0.5 * (room.width - width), room.y + 0.5 * (room.height - height), width, height};
  canvas.Image(place, Colored(map));

  const std::string left_out = LeftOutText(map);
  canvas.Text(left_out, {area.x + 0.5 * area.width, area.y + 16}, 10.0, colors::kBad, Align::kCenter);

  const double px_per_meter = px_per_cell / (map.voxel_size * map.voxels_per_pixel);
  std::vector<cv::Point2d> path;
  std::vector<double> shares;
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& p_W = pose.T.translation();
    const cv::Point2d at(place.x + (p_W.x() - map.min_x * map.voxel_size) * px_per_meter,
                         place.bottom() - (p_W.y() - map.min_y * map.voxel_size) * px_per_meter);
    const bool inside = at.x >= room.x && at.x <= room.right() && at.y >= room.y && at.y <= room.bottom();
    if (!inside || (!path.empty() && cv::norm(at - path.back()) < 1.0)) continue;
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
  x = canvas.Swatch({x, swatches}, ScalarOf(kWallColor), "solid over its whole height");
  x = canvas.Swatch({x, swatches}, ScalarOf(kHollowColor), "free, the surface below not seen");
  x = canvas.Swatch({x, swatches}, ScalarOf(kUnknownColor), "unknown");
  canvas.Text("S start, E end of the path", {area.right() - 28, swatches + 5}, 10.0, colors::kInk,
              Align::kRight);
}

}  // namespace thalweg::cli
