#include "services/explorer/core/map/frontier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "common/base/simd.h"
#include "common/voxel/for_each_voxel.h"

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
    out.push_back({.unknowns = std::move(voxels), .center_W = center});
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
  if ((map.State(i) != VoxelState::kUnknown && !map.Doubtful(i)) || !map.InBounds(i)) return false;
  return std::any_of(std::begin(kFaceNeighbors), std::end(kFaceNeighbors), [&](const VoxelIndex& offset) {
    return map.State(i + offset) == VoxelState::kFree && map.InBounds(i + offset);
  });
}

std::size_t VoxelsOfArea(double area, double voxel_size) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(area / (voxel_size * voxel_size) - 1e-6)));
}

std::vector<VoxelIndex> SpreadSample(const std::vector<VoxelIndex>& voxels, std::size_t count) {
  count = std::min(count, voxels.size());
  std::vector<VoxelIndex> sample;
  for (std::size_t n = 0; n < count; ++n) sample.push_back(voxels[n * voxels.size() / count]);
  return sample;
}

std::vector<std::vector<VoxelIndex>> ConnectedComponents(const std::vector<VoxelIndex>& voxels) {
  if (voxels.empty()) return {};
  VoxelBox box{voxels.front(), voxels.front()};
  for (const VoxelIndex& i : voxels) {
    box.min = {std::min(box.min.x, i.x), std::min(box.min.y, i.y), std::min(box.min.z, i.z)};
    box.max = {std::max(box.max.x, i.x), std::max(box.max.y, i.y), std::max(box.max.z, i.z)};
  }
  // A margin of one voxel on each side lets neighbors be found by offsets alone.
  DenseGrid<std::uint8_t> left({box.min - VoxelIndex{1, 1, 1}, box.max + VoxelIndex{2, 2, 2}}, 0);
  for (const VoxelIndex& i : voxels) left[i] = 1;
  std::vector<std::vector<VoxelIndex>> components;
  for (const VoxelIndex& seed : voxels) {
    if (left[seed] == 0) continue;
    left[seed] = 0;
    std::vector<VoxelIndex> component = {seed};
    for (std::size_t n = 0; n < component.size(); ++n) {
      const VoxelIndex at = component[n];
      ForEachVoxel(CubeAround(at, 1), [&](const VoxelIndex& neighbor) {
        std::uint8_t& is_left = left[neighbor];
        if (is_left == 0) return;
        is_left = 0;
        component.push_back(neighbor);
      });
    }
    components.push_back(std::move(component));
  }
  return components;
}

namespace {

/// Marks the voxels of a row that are unknown, not set aside, and next to a free voxel.
THALWEG_SIMD_CLONES
void MarkUnknownsBesideFree(const VoxelState* states, const std::uint8_t* set_aside, std::ptrdiff_t stride_y,
                            std::ptrdiff_t stride_z, std::span<std::uint8_t> marks) {
  const auto is = [](VoxelState a, VoxelState b) { return static_cast<std::uint8_t>(a == b); };
  for (std::size_t k = 0; k < marks.size(); ++k) {
    const VoxelState* const at = states + k;
    const auto beside_free =
        static_cast<std::uint8_t>(is(at[1], VoxelState::kFree) | is(at[-1], VoxelState::kFree) |
                                  is(at[stride_y], VoxelState::kFree) | is(at[-stride_y], VoxelState::kFree) |
                                  is(at[stride_z], VoxelState::kFree) | is(at[-stride_z], VoxelState::kFree));
    marks[k] = static_cast<std::uint8_t>(is(at[0], VoxelState::kUnknown) & beside_free &
                                         static_cast<std::uint8_t>(set_aside[k] == 0));
  }
}

/// The unknown target voxels that are not set aside.
std::vector<VoxelIndex> FindUnknownTargets(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside) {
  std::vector<VoxelIndex> targets;
  const DenseGrid<VoxelState>& states = map.states();
  const VoxelBox& box = states.box();
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(std::max(0, box.size_x() - 2)));
  VoxelIndex i;
  for (i.z = box.min.z + 1; i.z < box.max.z - 1; ++i.z) {
    for (i.y = box.min.y + 1; i.y < box.max.y - 1; ++i.y) {
      const std::size_t first = states.Offset({box.min.x + 1, i.y, i.z});
      MarkUnknownsBesideFree(states.data() + first, set_aside.data() + first, states.stride_y(),
                             states.stride_z(), marks);
      for (auto mark = std::ranges::find(marks, 1); mark != marks.end();
           mark = std::find(mark + 1, marks.end(), 1)) {
        i.x = box.min.x + 1 + static_cast<int>(mark - marks.begin());
        if (IsTarget(map, i)) targets.push_back(i);  // also checks the bounds
      }
    }
  }
  return targets;
}

std::vector<VoxelIndex> FindDoubtfulTargets(const PlanningMap& map,
                                            const DenseGrid<std::uint8_t>& set_aside) {
  std::vector<VoxelIndex> targets;
  const DenseGrid<std::uint8_t>& doubtful = map.doubtful();
  for (std::size_t k = 0; k < doubtful.size(); ++k) {
    if (doubtful[k] == 0 || set_aside[k] != 0) continue;
    const VoxelIndex i = doubtful.IndexAt(k);
    if (IsTarget(map, i)) targets.push_back(i);
  }
  return targets;
}

}  // namespace

Frontiers FindFrontiers(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside,
                        const FrontierOptions& options) {
  Frontiers frontiers;
  const std::size_t least = VoxelsOfArea(options.min_area, map.voxel_size());
  const int extent = std::max(1, static_cast<int>(std::lround(options.extent / map.voxel_size())));
  const auto cluster = [&](const std::vector<VoxelIndex>& targets, std::size_t& small_clusters,
                           std::size_t& small_voxels) {
    for (std::vector<VoxelIndex>& component : ConnectedComponents(targets)) {
      if (component.size() < least) {
        ++small_clusters;
        small_voxels += component.size();
      } else {
        Split(std::move(component), extent, map, frontiers.clusters);
      }
    }
  };
  cluster(FindUnknownTargets(map, set_aside), frontiers.small_clusters, frontiers.small_voxels);
  const std::size_t first_doubtful = frontiers.clusters.size();
  cluster(FindDoubtfulTargets(map, set_aside), frontiers.small_doubtful_clusters,
          frontiers.small_doubtful_voxels);
  for (std::size_t n = first_doubtful; n < frontiers.clusters.size(); ++n) {
    frontiers.clusters[n].doubtful = true;
    frontiers.clusters[n].weight = map.options().doubt.weight;
  }
  return frontiers;
}

}  // namespace thalweg::explorer
