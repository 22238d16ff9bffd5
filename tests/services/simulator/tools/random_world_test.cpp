#include "services/simulator/tools/random_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "common/base/angles.h"
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

/// Expects that a robot 0.4 m wide gets from the start to all of the rooms that it fits into.
void ExpectReachable(const RandomWorld& random, double voxel_size) {
  const RobotModel robot{.radius = 0.2};
  const World world = Loaded(random);
  const Eigen::Vector3d& origin = random.boxes.origin();
  const DenseGrid<std::uint8_t> reachable = ReachableVoxels(world, origin + random.start, robot, voxel_size);
  for (const FloorArea& room : random.rooms) {
    std::size_t reached = 0;
    std::size_t shut = 0;
    for (std::size_t k = 0; k < reachable.size(); ++k) {
      const Eigen::Vector3d p_W = VoxelCenter(reachable.IndexAt(k), voxel_size);
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
        << random.boxes.name() << ", room from " << room.low.transpose() << " to " << room.high.transpose();
  }
}

TEST(RandomWorld, ARobotGetsFromTheStartToAllThatIsFree) {
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    for (const double clutter : {0.05, 0.25, 2.0}) {
      SCOPED_TRACE(clutter);
      ExpectReachable(MakeRandomWorld({.seed = seed, .clutter = clutter}), 0.15);
    }
  }
}

TEST(RandomWorld, ARobotGetsThroughLargeLayoutsToo) {
  for (const auto layout : {Layout::kOffices, Layout::kStoreys}) {
    for (std::uint32_t seed = 0; seed < 3; ++seed)
      ExpectReachable(MakeRandomWorld({.seed = seed, .layout = layout, .clutter = 0.05}), 0.2);
  }
}

/// The middle of each cell between two rings and two corners must be reached.
TEST(RandomWorld, EachCellOfAMazeIsReached) {
  constexpr double kVoxel = 0.2;
  constexpr int kRings = 5;
  for (std::uint32_t seed = 0; seed < 3; ++seed) {
    const RandomWorld random = MakeRandomWorld({.seed = seed, .layout = Layout::kMaze});
    const World world = Loaded(random);
    const Eigen::Vector3d& origin = random.boxes.origin();
    const DenseGrid<std::uint8_t> reachable =
        ReachableVoxels(world, origin + random.start, {.radius = 0.2}, kVoxel);
    const double half = 0.5 * random.size.x();
    for (int ring = 0; ring <= kRings; ++ring) {
      for (int side = 0; side < 8; ++side) {
        const double away = half * ring / (kRings + 0.5);
        const double angle = side * 45.0 * kDegree;
        const Eigen::Vector3d p_W =
            origin + random.start + away * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
        EXPECT_NE(reachable[VoxelAt(p_W, kVoxel)], 0)
            << "seed " << seed << ", ring " << ring << ", side " << side;
      }
    }
  }
}

TEST(RandomWorld, ALayoutIsChosenByNameAndDeterminesTheSize) {
  for (const auto& [name, layout] : LayoutNames()) {
    const RandomWorld world = MakeRandomWorld({.seed = 9, .layout = layout});
    EXPECT_EQ(world.boxes.name(), name + "_9");
  }
  EXPECT_EQ(MakeRandomWorld({.layout = Layout::kOffices}).size, Eigen::Vector3d(30.0, 30.0, 2.0));
  EXPECT_EQ(MakeRandomWorld({.layout = Layout::kMaze, .scale = 2.0}).size, Eigen::Vector3d(70.0, 70.0, 2.0));
  EXPECT_EQ(MakeRandomWorld({.layout = Layout::kStoreys}).size, Eigen::Vector3d(20.0, 20.0, 4.0));
  const RandomWorld by_seed = MakeRandomWorld({.seed = 6});
  const RandomWorld by_name = MakeRandomWorld({.seed = 6, .layout = Layout::kStalls});
  EXPECT_EQ(by_seed.size, by_name.size) << "6 modulo 4 = stalls";
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
