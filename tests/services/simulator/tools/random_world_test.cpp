#include "services/simulator/tools/random_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "common/scenario/models.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/core/reachable.h"

namespace thalweg::simulator {
namespace {

namespace fs = std::filesystem;

World Loaded(const RandomWorld& world) {
  const fs::path file =
      fs::temp_directory_path() / ("thalweg_random_world_" + std::to_string(getpid()) + ".obj");
  std::ofstream(file) << world.boxes.Obj();
  World loaded(LoadObj(file, UpAxis::kZ, WorldOptions().scale).mesh,
               {world.boxes.origin(), world.boxes.origin() + world.size});
  fs::remove(file);
  return loaded;
}

TEST(RandomWorld, TheSeedDecides) {
  const RandomWorld world = MakeRandomWorld({.seed = 7});
  EXPECT_EQ(world.boxes.Obj(), MakeRandomWorld({.seed = 7}).boxes.Obj());
  EXPECT_NE(world.boxes.Obj(), MakeRandomWorld({.seed = 11}).boxes.Obj());
  EXPECT_NE(world.boxes.Obj(), MakeRandomWorld({.seed = 7, .clutter = 0.5}).boxes.Obj());
  EXPECT_EQ(world.boxes.name(), "random_7");
}

/// Draws by hand from the same generator: another order of draws would yield another world.
TEST(RandomWorld, ItIsTheSameWithEveryCompiler) {
  const RandomWorld world = MakeRandomWorld({.seed = 3});
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  Eigen::Vector3d origin;
  for (double& x : origin) x = between(0.01, 0.06);
  Eigen::Vector3d size;
  size.x() = between(6.0, 10.0);
  size.y() = between(8.0, 14.0);
  size.z() = between(2.5, 4.0);
  EXPECT_EQ(world.boxes.origin(), origin);
  EXPECT_EQ(world.size, size);
  random();  // number of pillars
  const double radius = between(0.15, 0.25);
  const double x = between(radius + 0.5, size.x() - radius - 0.5);
  const double y = between(radius + 0.5, size.y() - radius - 0.5);
  ASSERT_GT((Eigen::Vector2d(x, y) - 0.5 * size.head<2>()).norm(), 1.5) << "not where the start is";
  const Eigen::Vector3d inside = origin + Eigen::Vector3d(x, y, 1.0);
  EXPECT_NEAR(Loaded(world).DistanceToSurface(inside, 1.0), radius, 0.05) << "the first pillar's axis";
}

TEST(RandomWorld, ARobotGetsFromTheStartToAllThatIsFree) {
  constexpr double kVoxel = 0.15;
  const RobotModel robot{.radius = 0.2};
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    for (const double clutter : {0.05, 0.25, 2.0}) {
      const RandomWorld random = MakeRandomWorld({.seed = seed, .clutter = clutter});
      const World world = Loaded(random);
      const Eigen::Vector3d& origin = random.boxes.origin();
      const DenseGrid<std::uint8_t> reachable = ReachableVoxels(world, origin + random.start, robot, kVoxel);
      for (const RandomWorld::Room& room : random.rooms) {
        std::size_t reached = 0;
        std::size_t shut = 0;
        for (std::size_t k = 0; k < reachable.size(); ++k) {
          const Eigen::Vector3d p_W = VoxelCenter(reachable.IndexAt(k), kVoxel);
          const Eigen::Array2d p = (p_W - origin).head<2>().array();
          if ((p <= room.low.array()).any() || (p >= room.high.array()).any()) continue;
          if (reachable[k] != 0) {
            ++reached;
          } else if (world.DistanceToSurface(p_W, 1.0) > robot.radius) {
            ++shut;
          }
        }
        // The insides of boxes and pillars count as free, too, except near their surfaces.
        EXPECT_LT(static_cast<double>(shut), 0.05 * static_cast<double>(reached))
            << "seed " << seed << ", clutter " << clutter << ", room from " << room.low.transpose() << " to "
            << room.high.transpose();
      }
    }
  }
}

TEST(RandomWorld, MoreClutterIsMoreFurnitureAndALargerScaleMoreFloor) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const auto faces = [&](double clutter) {
      return Loaded(MakeRandomWorld({.seed = seed, .clutter = clutter})).mesh().triangles.size();
    };
    EXPECT_LT(faces(0.0), faces(0.1));
    EXPECT_LT(faces(0.1), faces(0.4));
    const RandomWorld small = MakeRandomWorld({.seed = seed});
    const RandomWorld large = MakeRandomWorld({.seed = seed, .scale = 2.0});
    EXPECT_NEAR(large.size.head<2>().prod(), 4.0 * small.size.head<2>().prod(), 1e-9);
    if (seed % 4 != 3) {
      EXPECT_GT(large.rooms.size(), small.rooms.size());
    }
  }
}

TEST(RandomWorld, ItsScenarioLoads) {
  const fs::path folder = fs::temp_directory_path() / ("thalweg_random_scenario_" + std::to_string(getpid()));
  fs::create_directory(folder);
  const RandomWorld random = MakeRandomWorld({.seed = 5});
  std::ofstream(folder / "random_5.obj") << random.boxes.Obj();
  std::ofstream(folder / "random_5.mtl") << random.boxes.Mtl();
  std::ofstream(folder / "random_5.txtpb") << ScenarioText(random);
  const Scenario scenario = LoadScenario(folder / "random_5.txtpb");
  const World world = LoadWorld(scenario);
  const RigidTransform T_WB = StartFrom(scenario, world, RobotFrom(scenario));
  fs::remove_all(folder);
  EXPECT_TRUE(T_WB.translation().isApprox(random.boxes.origin() + random.start, 1e-4));
  EXPECT_GT(world.DistanceToSurface(T_WB.translation(), 1.0), 0.5);
  EXPECT_TRUE(world.bounds().contains(random.boxes.origin() + random.size));
}

TEST(RandomWorld, OptionsOutOfRangeAreNamed) {
  const auto refuses = [](const RandomWorldOptions& options, const char* name) {
    EXPECT_THAT([&] { MakeRandomWorld(options); },
                testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr(name)));
  };
  for (const double clutter : {-0.1, 2.1, std::nan("")}) refuses({.clutter = clutter}, "clutter");
  for (const double scale : {0.9, 5.1}) refuses({.scale = scale}, "scale");
}

}  // namespace
}  // namespace thalweg::simulator
