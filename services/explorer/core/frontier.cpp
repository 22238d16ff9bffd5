#include "services/explorer/core/frontier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace thalweg::explorer {
namespace {

int Component(const VoxelIndex& i, int axis) {
  return axis == 0 ? i.x : axis == 1 ? i.y : i.z;
}

Eigen::Vector3d MeanOf(const std::vector<VoxelIndex>& voxels, const PlanningMap& map) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const VoxelIndex& i : voxels) sum += map.CenterOf(i);
  return sum / static_cast<double>(voxels.size());
}

/// Halves a component across its longest axis until every part fits into `extent` voxels.
void Split(std::vector<VoxelIndex> voxels, int extent, const PlanningMap& map, std::vector<Cluster>& out) {
  int longest = 0;
  std::array<int, 3> low{};
  std::array<int, 3> size{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, greatest] = std::minmax_element(
        voxels.begin(), voxels.end(),
        [axis](const VoxelIndex& a, const VoxelIndex& b) { return Component(a, axis) < Component(b, axis); });
    const auto n = static_cast<std::size_t>(axis);
    low[n] = Component(*least, axis);
    size[n] = Component(*greatest, axis) - low[n] + 1;
    if (size[n] > size[static_cast<std::size_t>(longest)]) longest = axis;
  }
  const auto n = static_cast<std::size_t>(longest);
  if (size[n] <= extent) {
    const Eigen::Vector3d center = MeanOf(voxels, map);
    out.push_back({std::move(voxels), center});
    return;
  }
  const int middle = low[n] + size[n] / 2;
  std::vector<VoxelIndex> upper;
  std::vector<VoxelIndex> lower;
  for (const VoxelIndex& i : voxels) (Component(i, longest) < middle ? lower : upper).push_back(i);
  for (std::vector<VoxelIndex>* half : {&lower, &upper}) {
    if (!half->empty()) Split(std::move(*half), extent, map, out);
  }
}

}  // namespace

bool IsTarget(const PlanningMap& map, const VoxelIndex& i) {
  if (map.State(i) != VoxelState::kUnknown || !map.InBounds(i)) return false;
  return std::any_of(std::begin(kFaceNeighbours), std::end(kFaceNeighbours), [&](const VoxelIndex& offset) {
    return map.State(i + offset) == VoxelState::kFree && map.InBounds(i + offset);
  });
}

std::size_t VoxelsOfArea(double area, double voxel_size) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(area / (voxel_size * voxel_size) - 1e-6)));
}

std::vector<std::vector<VoxelIndex>> ConnectedComponents(const std::vector<VoxelIndex>& voxels) {
  std::unordered_map<VoxelIndex, bool, VoxelIndexHash> taken;
  taken.reserve(voxels.size());
  for (const VoxelIndex& i : voxels) taken[i] = false;
  std::vector<std::vector<VoxelIndex>> components;
  for (const VoxelIndex& seed : voxels) {
    if (taken[seed]) continue;
    taken[seed] = true;
    std::vector<VoxelIndex> component = {seed};
    for (std::size_t n = 0; n < component.size(); ++n) {
      const VoxelIndex at = component[n];
      for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
          for (int x = -1; x <= 1; ++x) {
            const auto found = taken.find(at + VoxelIndex{x, y, z});
            if (found == taken.end() || found->second) continue;
            found->second = true;
            component.push_back(found->first);
          }
        }
      }
    }
    components.push_back(std::move(component));
  }
  return components;
}

Frontiers FindFrontiers(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside,
                        const FrontierOptions& options) {
  std::vector<VoxelIndex> targets;
  const DenseGrid<VoxelState>& states = map.states();
  const VoxelBox& box = states.box();
  const std::ptrdiff_t steps[6] = {
      1, -1, states.stride_y(), -states.stride_y(), states.stride_z(), -states.stride_z()};
  VoxelIndex i;
  for (i.z = box.min.z + 1; i.z < box.max.z - 1; ++i.z) {
    for (i.y = box.min.y + 1; i.y < box.max.y - 1; ++i.y) {
      std::size_t k = states.Offset({box.min.x + 1, i.y, i.z});
      for (i.x = box.min.x + 1; i.x < box.max.x - 1; ++i.x, ++k) {
        if (states[k] != VoxelState::kUnknown || set_aside[k] != 0) continue;
        const bool beside_free = std::any_of(std::begin(steps), std::end(steps), [&](std::ptrdiff_t step) {
          return states[k + static_cast<std::size_t>(step)] == VoxelState::kFree;
        });
        if (beside_free && IsTarget(map, i)) targets.push_back(i);
      }
    }
  }
  Frontiers frontiers;
  const std::size_t least = VoxelsOfArea(options.min_area, map.voxel_size());
  const int extent = std::max(1, static_cast<int>(options.extent / map.voxel_size() + 0.5));
  for (std::vector<VoxelIndex>& component : ConnectedComponents(targets)) {
    if (component.size() < least) {
      ++frontiers.small_clusters;
      frontiers.small_voxels += component.size();
    } else {
      Split(std::move(component), extent, map, frontiers.clusters);
    }
  }
  return frontiers;
}

}  // namespace thalweg::explorer
