#include "services/simulator/core/voxel_sight.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/spread_directions.h"
#include "services/simulator/core/surface_voxels.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

using Box = Eigen::AlignedBox3d;
using Point = Eigen::Vector3d;

/// A room with a wall across most of it and a crate, so that much is hidden from every position.
test::AnalyticRoom DividedRoom() {
  return {Box(Point(0.03, 0.04, 0.05), Point(3.03, 2.04, 1.25)),
          {Box(Point(1.43, 0.04, 0.05), Point(1.56, 1.31, 1.25)),
           Box(Point(2.13, 1.12, 0.05), Point(2.57, 1.55, 0.61))}};
}

struct Scene {
  explicit Scene(TrueMap::Options of_truth = {.voxel_size = 0.1, .robot = {.radius = 0.1}, .view_range = 1.7})
      : options(of_truth),
        world(test::MeshOf(room), room.walls),
        start_W(0.5, 1.0, 0.6),
        truth(world, start_W, options),
        sight(world, truth, start_W, options) {}

  test::AnalyticRoom room = DividedRoom();
  TrueMap::Options options;
  World world;
  Point start_W;
  TrueMap truth;
  VoxelSight sight;
};

TEST(VoxelSight, KnowsTheObservableVoxels) {
  const Scene scene;
  EXPECT_EQ(scene.sight.voxels().size(), scene.truth.observable_count());
  EXPECT_TRUE(std::all_of(scene.sight.voxels().begin(), scene.sight.voxels().end(),
                          [&](const VoxelIndex& i) { return scene.truth.Observable(i); }));
}

TEST(VoxelSight, SeesTheFreeVoxelsToWhichAClosedFormRayIsFree) {
  const Scene scene;
  const auto far = static_cast<double>(scene.options.view_range);
  std::size_t seen = 0;
  std::size_t hidden = 0;
  for (const Point& p_W :
       {Point(0.4571, 0.9513, 0.6527), Point(1.1519, 1.7457, 0.3539), Point(2.7533, 0.5541, 0.9479)}) {
    for (std::size_t n = 0; n < scene.sight.voxels().size(); ++n) {
      const VoxelIndex voxel = scene.sight.voxels()[n];
      if (scene.truth.voxels()[voxel] != TrueVoxel::kFree) continue;
      const Point offset = VoxelCenter(voxel, 0.1) - p_W;
      if (offset.norm() < 1e-9) continue;
      const bool expected =
          offset.norm() <= far && scene.room.CastRay(p_W, offset.normalized()) > offset.norm();
      ASSERT_EQ(scene.sight.Sees(p_W, n), expected) << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
      ++(expected ? seen : hidden);
    }
  }
  EXPECT_GT(seen, 3000U);
  EXPECT_GT(hidden, 3000U);
}

TEST(VoxelSight, SeesTheSurfaceVoxelsThatADenseFanOfClosedFormRaysHits) {
  const Scene scene;
  const Point p_W(1.15, 1.75, 0.35);
  DenseGrid<std::uint8_t> hit(scene.truth.voxels().box(), 0);
  for (const Point& direction : SpreadDirections(400'000)) {
    const double range = scene.room.CastRay(p_W, direction);
    if (range > scene.options.view_range) continue;
    const VoxelIndex voxel = VoxelAt(p_W + range * direction, 0.1);
    if (hit.Contains(voxel)) hit[voxel] = 1;
  }
  std::size_t both = 0;
  std::size_t sight_only = 0;
  std::size_t fan_only = 0;
  for (std::size_t n = 0; n < scene.sight.voxels().size(); ++n) {
    const VoxelIndex voxel = scene.sight.voxels()[n];
    if (scene.truth.voxels()[voxel] != TrueVoxel::kSurface) continue;
    const bool seen = scene.sight.Sees(p_W, n);
    both += seen && hit[voxel] ? 1U : 0U;
    sight_only += seen && !hit[voxel] ? 1U : 0U;
    fan_only += !seen && hit[voxel] ? 1U : 0U;
  }
  EXPECT_GT(both, 500U);
  EXPECT_LE(sight_only, both / 100) << "of slivers that the fan's rays miss";
  EXPECT_LE(fan_only, both / 50) << "of parts between the points that are looked at";
}

/// From all reachable positions together exactly what is observable is seen.
void ExpectAllSeenFromSomewhere(const Scene& scene) {
  const DenseGrid<std::uint8_t>& reachable = scene.truth.reachable();
  std::vector<Point> positions_W;
  for (std::size_t i = 0; i < reachable.size(); ++i) {
    if (reachable[i]) positions_W.push_back(VoxelCenter(reachable.IndexAt(i), 0.1));
  }
  ASSERT_GT(positions_W.size(), 10U);
  for (std::size_t n = 0; n < scene.sight.voxels().size(); ++n) {
    const VoxelIndex voxel = scene.sight.voxels()[n];
    EXPECT_TRUE(std::any_of(positions_W.begin(), positions_W.end(),
                            [&](const Point& p_W) { return scene.sight.Sees(p_W, n); }))
        << voxel.x << ' ' << voxel.y << ' ' << voxel.z;
  }
}

TEST(VoxelSight, AllPositionsTogetherSeeWhatIsObservable) {
  ExpectAllSeenFromSomewhere(Scene());
}

TEST(VoxelSight, AllPositionsOfALevelCameraTogetherSeeWhatIsObservable) {
  const Scene level({.voxel_size = 0.1,
                     .robot = {.radius = 0.1, .height = 0.4, .drives = true},
                     .camera = PinholeCamera::FromFieldOfView(64, 32, 1.2),
                     .view_range = 1.7});
  ExpectAllSeenFromSomewhere(level);
}

TEST(VoxelSight, ALevelCameraSeesOnlyWhatItsImageReaches) {
  const Scene level({.voxel_size = 0.1,
                     .robot = {.radius = 0.1, .height = 0.4, .drives = true},
                     .camera = PinholeCamera::FromFieldOfView(64, 32, 1.2),
                     .view_range = 1.7});
  // The steepest ray in view rises by half the image's height over the focal length.
  const double steepest = 16.0 / level.options.camera.fy;
  const Point p_W(0.45, 0.95, 0.6);
  std::size_t beside = 0;
  for (std::size_t n = 0; n < level.sight.voxels().size(); ++n) {
    const Point offset = VoxelCenter(level.sight.voxels()[n], 0.1) - p_W;
    const double away = offset.head<2>().norm();
    if (level.truth.voxels()[level.sight.voxels()[n]] != TrueVoxel::kFree) continue;
    if (std::abs(offset.z()) <= steepest * away) continue;
    EXPECT_FALSE(level.sight.Sees(p_W, n));
    ++beside;
  }
  EXPECT_GT(beside, 5U);
}

}  // namespace
}  // namespace thalweg::simulator
