#include "services/simulator/tools/random_world.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/core/reachable.h"

namespace thalweg::simulator {
namespace {

World Loaded(const RandomWorld& world) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("thalweg_random_world_" + std::to_string(getpid()) + ".obj");
  std::ofstream(file) << world.boxes.Obj();
  World loaded(LoadObj(file, UpAxis::kZ, kUnscaled).mesh,
               {world.boxes.origin(), world.boxes.origin() + world.size});
  std::filesystem::remove(file);
  return loaded;
}

TEST(RandomWorld, TheSeedDecides) {
  const RandomWorld world = MakeRandomWorld({.seed = 7});
  EXPECT_EQ(world.boxes.Obj(), MakeRandomWorld({.seed = 7}).boxes.Obj());
  EXPECT_NE(world.boxes.Obj(), MakeRandomWorld({.seed = 11}).boxes.Obj());
  EXPECT_NE(world.boxes.Obj(), MakeRandomWorld({.seed = 7, .clutter = 0.5}).boxes.Obj());
  EXPECT_EQ(world.boxes.name(), "random_7");
}

TEST(RandomWorld, ARobotGetsFromTheStartIntoEveryRoom) {
  constexpr double kVoxel = 0.1;
  const RobotModel robot{.radius = 0.2};
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    for (const double clutter : {0.05, 0.25, 1.0}) {
      const RandomWorld random = MakeRandomWorld({.seed = seed, .clutter = clutter});
      const Eigen::Vector3d& origin = random.boxes.origin();
      const DenseGrid<std::uint8_t> reachable =
          ReachableVoxels(Loaded(random), origin + random.start, robot, kVoxel);
      for (const RandomWorld::Room& room : random.rooms) {
        bool reached = false;
        for (std::size_t k = 0; k < reachable.size() && !reached; ++k) {
          if (reachable[k] == 0) continue;
          const Eigen::Vector3d p = VoxelCenter(reachable.IndexAt(k), kVoxel) - origin;
          reached = (p.head<2>().array() > room.low.array()).all() &&
                    (p.head<2>().array() < room.high.array()).all();
        }
        EXPECT_TRUE(reached) << "seed " << seed << ", clutter " << clutter << ", room from "
                             << room.low.transpose() << " to " << room.high.transpose();
      }
    }
  }
}

TEST(RandomWorld, MoreClutterIsMoreFurnitureAndALargerScaleMoreRooms) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const auto faces = [&](double clutter) {
      return Loaded(MakeRandomWorld({.seed = seed, .clutter = clutter})).mesh().triangles.size();
    };
    EXPECT_LT(faces(0.0), faces(0.1));
    EXPECT_LT(faces(0.1), faces(0.4));
    const RandomWorld small = MakeRandomWorld({.seed = seed});
    const RandomWorld large = MakeRandomWorld({.seed = seed, .scale = 2.0});
    EXPECT_NEAR(large.size.head<2>().prod(), 4.0 * small.size.head<2>().prod(), 1e-9);
    EXPECT_GE(large.rooms.size(), small.rooms.size());
  }
}

TEST(RandomWorld, OptionsOutOfRangeAreNamed) {
  for (const double clutter : {-0.1, 2.1, std::nan("")})
    EXPECT_THROW(MakeRandomWorld({.clutter = clutter}), std::invalid_argument);
  for (const double scale : {0.9, 5.1})
    EXPECT_THROW(MakeRandomWorld({.scale = scale}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::simulator
