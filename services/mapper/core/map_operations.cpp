#include "services/mapper/core/map_operations.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/base/text.h"

namespace thalweg::mapper {
namespace {

constexpr float kLeast = kFreeOfBt;
constexpr float kMost = kOccupiedOfBt;

/// Sizes that a file states with six digits are the same.
void CheckSameVoxels(const OccupancyGrid& a, const OccupancyGrid& b) {
  constexpr double kTolerance = 1e-5;
  if (std::abs(a.voxel_size() - b.voxel_size()) <= kTolerance * a.voxel_size()) return;
  throw std::invalid_argument("the maps' voxels have different sizes, " + NumberText(a.voxel_size()) +
                              " and " + NumberText(b.voxel_size()) + " m");
}

void CopyColor(const VoxelColors& from, const VoxelIndex& at, VoxelColors& to, const VoxelIndex& target) {
  if (const auto color = from.At(at)) to.Add(target, *color);
}

bool IsOccupied(float log_odds) {
  return OccupancyGrid::StateOf(log_odds) == VoxelState::kOccupied;
}

}  // namespace

MapSummary Summarize(const ColoredMap& map) {
  MapSummary summary;
  Eigen::AlignedBox3d centers_W;
  map.grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    centers_W.extend(map.grid.CenterOf(voxel));
    if (!IsOccupied(log_odds)) {
      ++summary.free;
      return;
    }
    ++summary.occupied;
    if (map.colors.At(voxel)) ++summary.colored;
  });
  if (summary.known() > 0) {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * map.grid.voxel_size());
    summary.bounds_W.emplace(centers_W.min() - half, centers_W.max() + half);
  }
  return summary;
}

ColoredMap Crop(const ColoredMap& map, const Eigen::AlignedBox3d& box_W) {
  ColoredMap cropped{.grid = OccupancyGrid(map.grid.voxel_size()), .colors = {}};
  map.grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    if (!box_W.contains(map.grid.CenterOf(voxel))) return;
    cropped.grid.Set(voxel, log_odds);
    CopyColor(map.colors, voxel, cropped.colors, voxel);
  });
  return cropped;
}

void Merge(const ColoredMap& from, ColoredMap& into) {
  CheckSameVoxels(into.grid, from.grid);
  from.grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    const float before = into.grid.LogOdds(voxel);
    if (IsOccupied(log_odds) && !IsOccupied(before)) CopyColor(from.colors, voxel, into.colors, voxel);
    into.grid.Set(voxel, std::isnan(before) ? log_odds : std::clamp(before + log_odds, kLeast, kMost));
  });
}

ColoredMap Coarsen(const ColoredMap& map, int factor) {
  if (factor < 2 || factor > 1024) {
    throw std::invalid_argument("factor must be 2 to 1024, is " + std::to_string(factor));
  }
  const auto divided = [factor](std::int32_t v) { return v >= 0 ? v / factor : -((-v - 1) / factor) - 1; };
  ColoredMap coarse{.grid = OccupancyGrid(map.grid.voxel_size() * factor), .colors = {}};
  map.grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    const VoxelIndex target{divided(voxel.x), divided(voxel.y), divided(voxel.z)};
    const float before = coarse.grid.LogOdds(target);
    if (std::isnan(before) || before < log_odds) coarse.grid.Set(target, log_odds);
    if (IsOccupied(log_odds)) CopyColor(map.colors, voxel, coarse.colors, target);
  });
  return coarse;
}

std::optional<int> CoarseningFactor(double voxel_size, double larger_voxel_size) {
  constexpr double kTolerance = 1e-4;
  constexpr double kMostFactor = 1e6;  // for its type; Coarsen has a limit of its own
  const double ratio = larger_voxel_size / voxel_size;
  const int factor = static_cast<int>(std::lround(std::clamp(ratio, 0.0, kMostFactor)));
  if (factor < 1 || std::abs(ratio - factor) > kTolerance) return std::nullopt;
  return factor;
}

std::size_t MapDifference::differing() const {
  std::size_t sum = 0;
  for (std::size_t first = 0; first < counts.size(); ++first) {
    for (std::size_t second = 0; second < counts.size(); ++second) {
      if (first != second) sum += counts.at(first).at(second);
    }
  }
  return sum;
}

std::size_t MapDifference::known_to_both() const {
  std::size_t sum = 0;
  for (const std::size_t first : {1U, 2U}) {
    for (const std::size_t second : {1U, 2U}) sum += counts.at(first).at(second);
  }
  return sum;
}

std::optional<double> MapDifference::agreement() const {
  if (known_to_both() == 0) return std::nullopt;
  return static_cast<double>(counts[1][1] + counts[2][2]) / static_cast<double>(known_to_both());
}

MapDifference DifferenceOf(const OccupancyGrid& first, const OccupancyGrid& second) {
  CheckSameVoxels(first, second);
  MapDifference difference;
  const auto count = [&](VoxelState a, VoxelState b) {
    ++difference.counts.at(static_cast<std::size_t>(a)).at(static_cast<std::size_t>(b));
  };
  first.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    const VoxelState before = OccupancyGrid::StateOf(log_odds);
    const VoxelState after = second.State(voxel);
    count(before, after);
    if (before == VoxelState::kFree && after == VoxelState::kOccupied) difference.appeared.push_back(voxel);
    if (before == VoxelState::kOccupied && after == VoxelState::kFree) difference.vanished.push_back(voxel);
  });
  second.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    if (first.State(voxel) == VoxelState::kUnknown)
      count(VoxelState::kUnknown, OccupancyGrid::StateOf(log_odds));
  });
  return difference;
}

ColoredMap PaintedDifference(const MapDifference& difference, double voxel_size) {
  ColoredMap painted{.grid = OccupancyGrid(voxel_size), .colors = {}};
  const auto paint = [&](const std::vector<VoxelIndex>& voxels, const Rgb& color) {
    for (const VoxelIndex& voxel : voxels) {
      painted.grid.Set(voxel, kOccupiedOfBt);
      painted.colors.Add(voxel, color);
    }
  };
  paint(difference.appeared, {40, 160, 60});
  paint(difference.vanished, {200, 40, 40});
  return painted;
}

}  // namespace thalweg::mapper
