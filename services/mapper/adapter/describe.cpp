#include "services/mapper/adapter/describe.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/base/text.h"

namespace thalweg::mapper {
namespace {

std::string BoundsText(const Eigen::AlignedBox3d& bounds_W) {
  const Eigen::Vector3d low_W = bounds_W.min();
  const Eigen::Vector3d high_W = bounds_W.max();
  return fmt::format("  bounds    x {:.2f} to {:.2f}, y {:.2f} to {:.2f}, z {:.2f} to {:.2f} m\n", low_W.x(),
                     high_W.x(), low_W.y(), high_W.y(), low_W.z(), high_W.z());
}

}  // namespace

std::string Describe(const LoadedMap& loaded) {
  const double voxel_size = loaded.map.grid.voxel_size();
  const auto volume = [&](std::size_t voxels) {
    return static_cast<double>(voxels) * std::pow(voxel_size, 3);
  };
  const MapSummary summary = Summarize(loaded.map);
  std::string text = fmt::format(
      "  format    {}\n  voxels    {} m, {} free, {} occupied, {} of these colored\n",
      CleanText(loaded.format), NumberText(voxel_size), summary.free, summary.occupied, summary.colored);
  text += fmt::format("  volume    {:.2f} m3 free, {:.2f} m3 occupied\n", volume(summary.free),
                      volume(summary.occupied));
  return summary.bounds_W ? text + BoundsText(*summary.bounds_W) : text;
}

std::string Describe(const PlyFile& ply) {
  Eigen::AlignedBox3d bounds_W;
  for (const Eigen::Vector3d& point_W : ply.points) bounds_W.extend(point_W);
  const std::string text =
      fmt::format("  format    {}\n  holds     {} points, {} triangles, {}\n", FormatOf(ply),
                  ply.points.size(), ply.triangles.size(), ply.colors.empty() ? "without colors" : "colored");
  return text + BoundsText(bounds_W) +
         "  voxels    none: `thalweg map convert` with --voxel-size makes a map of it\n";
}

std::string Describe(const MapDifference& difference) {
  constexpr std::array kStates = {"unknown", "free", "occupied"};
  std::string text = fmt::format("voxels, by their state in the first map (rows) and the second\n{:<10}", "");
  for (const char* state : kStates) text += fmt::format("{:>12}", state);
  for (std::size_t row = 0; row < kStates.size(); ++row) {
    text += fmt::format("\n{:<10}", kStates.at(row));
    for (std::size_t column = 0; column < kStates.size(); ++column) {
      const std::size_t count = difference.counts.at(row).at(column);
      text += fmt::format("{:>12}", row + column == 0 ? "-" : std::to_string(count));
    }
  }
  const auto agreement = difference.agreement();
  if (!agreement) return text + "\nno voxel is known to both\n";
  return text + fmt::format("\n{:.3f} % of the {} voxels known to both agree\n", 100.0 * *agreement,
                            difference.known_to_both());
}

}  // namespace thalweg::mapper
