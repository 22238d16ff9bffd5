#include "services/cli/report/floor_below.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/voxel/voxels_within.h"

namespace thalweg::cli {
namespace {

constexpr double kReach = 3.0;       // [m]
constexpr double kDeepest = 5.0;     // [m]
constexpr std::size_t kFewest = 50;  // columns

}  // namespace

std::optional<double> FloorBelow(const OccupancyGrid& map, double height, const Eigen::Vector3d& p_W) {
  const double voxel = map.voxel_size();
  const Eigen::Vector3d bottom_W = p_W - 0.5 * height * Eigen::Vector3d::UnitZ();
  const int deepest = static_cast<int>(std::ceil(kDeepest / voxel));
  const Eigen::Vector3d reach(kReach, kReach, 0.0);
  const VoxelBox layer = VoxelsWithin({bottom_W - reach, bottom_W + reach}, voxel);
  const int top = VoxelAt(bottom_W, voxel).z;
  std::vector<double> drops;
  for (int y = layer.min.y; y < layer.max.y; ++y) {
    for (int x = layer.min.x; x < layer.max.x; ++x) {
      int z = top;
      while (z > top - deepest && map.State({x, y, z}) == VoxelState::kFree) --z;
      if (z < top && map.State({x, y, z}) == VoxelState::kOccupied)
        drops.push_back(bottom_W.z() - (z + 1) * voxel);
    }
  }
  if (drops.size() < kFewest) return std::nullopt;
  const auto median = drops.begin() + static_cast<std::ptrdiff_t>(drops.size() / 2);
  std::ranges::nth_element(drops, median);
  return *median;
}

std::string FloatingText(const RobotModel& robot, const OccupancyGrid& map, const Eigen::Vector3d& p_W) {
  if (!robot.drives) return "";
  const std::optional<double> drop = FloorBelow(map, robot.height, p_W);
  if (!drop || *drop <= kHighestOfWheels) return "";
  return fmt::format(
      "the robot drives, but the floor around it is {:.2f} m below its body, and it explores only the "
      "heights "
      "that its body sweeps: base_link of odometry must be robot.height_m / 2 and a voxel above the floor",
      *drop);
}

}  // namespace thalweg::cli
