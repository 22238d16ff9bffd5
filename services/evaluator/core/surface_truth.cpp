#include "services/evaluator/core/surface_truth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "common/base/parallel.h"
#include "common/voxel/for_each_voxel.h"

namespace thalweg::evaluator {
namespace {

/// Both sides of points of all triangles, in no_go and beyond bounds, too.
std::vector<SurfaceTruth::Point> SidesOf(const simulator::Mesh& mesh) {
  std::vector<SurfaceTruth::Point> sides;
  std::mt19937 random(1);
  const auto share = [&] {
    return std::ldexp(static_cast<double>(random()), -32);
  };  // [0, 1), on any machine
  for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto [a, b, c] = simulator::TriangleOf(mesh, k);
    const Eigen::Vector3d across = (b - a).cross(c - a);
    const double area = 0.5 * across.norm();
    if (!(area > 0.0)) continue;
    const Eigen::Vector3d normal = across.normalized();
    const auto count = static_cast<int>(std::floor(area * SurfaceTruth::kDensity + share()));
    for (int n = 0; n < count; ++n) {
      const double root = std::sqrt(share());  // uniform over the triangle
      const double along = share();
      const Eigen::Vector3d p_W = (1.0 - root) * a + root * (1.0 - along) * b + root * along * c;
      sides.push_back({p_W, normal});
      sides.push_back({p_W, -normal});
    }
  }
  return sides;
}

}  // namespace

SurfaceTruth SurfaceTruth::Of(const simulator::World& world, const simulator::TrueMap& truth,
                              const simulator::TrueMap::Options& options, const Eigen::Vector3d& start_W) {
  const simulator::Visibility visibility(world, truth.reachable(), options.voxel_size, options.view_range,
                                         simulator::TrueMap::CameraOf(options, start_W));
  const std::vector<Point> sides = SidesOf(world.mesh());
  std::vector<std::uint8_t> observable(sides.size(), 0);
  const auto near_observable = [&](const Eigen::Vector3d& p_W) {
    return !ForEachVoxel(CubeAround(VoxelAt(p_W, options.voxel_size), 1),
                         [&](const VoxelIndex& voxel) { return !truth.Observable(voxel); });
  };
  ParallelFor(sides.size(), 64, [&](std::size_t k) {
    const Eigen::Vector3d before_W = sides[k].before_W();
    const auto excludes = [&](const Eigen::AlignedBox3d& box) { return box.contains(sides[k].p_W); };
    if (!world.bounds().contains(before_W) || std::ranges::any_of(world.no_go(), excludes)) return;
    observable[k] = near_observable(before_W) && visibility.SeesPoint(before_W) ? 1 : 0;
  });
  SurfaceTruth surface;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    if (observable[k]) surface.points.push_back(sides[k]);
  }
  return surface;
}

}  // namespace thalweg::evaluator
