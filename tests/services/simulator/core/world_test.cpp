#include "services/simulator/core/world.h"

#include <gtest/gtest.h>

#include "services/simulator/core/upright_cylinder.h"
#include "tests/services/simulator/core/simple_scenes.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

using test::RandomDirection;
using test::RandomPoint;

const Eigen::AlignedBox3d kBounds(Eigen::Vector3d(-9, -9, -9), Eigen::Vector3d(9, 9, 9));

TEST(World, RaysEndWhereTheClosedFormOfAFurnishedRoomSays) {
  const auto room = test::AnalyticRoom::Furnished();
  const World world(test::MeshOf(room), kBounds);
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d origin = room.RandomPose(random).translation();
    const Eigen::Vector3d direction = RandomDirection(random);
    const auto hit = world.CastRay(origin, direction, 100.0);
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->distance, room.CastRay(origin, direction), 1e-5) << origin << direction;
    ASSERT_LT(hit->normal_W.dot(direction), 0.0);
    ASSERT_NEAR(hit->normal_W.cwiseAbs().maxCoeff(), 1.0, 1e-6);
  }
}

TEST(World, RaysMeetAFineSphereWhereTheFormulaSays) {
  const Eigen::Vector3d center(0.3, -0.2, 0.1);
  constexpr double kRadius = 1.5;
  constexpr int kRings = 200;
  const World world(test::SphereMesh(center, kRadius, kRings), kBounds);
  const double sagitta = kRadius * (1.0 - std::cos(std::numbers::pi / kRings));
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    // From inside, so that the ray meets the surface steeply enough for the sagitta to bound the error.
    const Eigen::Vector3d origin = center + 0.5 * kRadius * RandomDirection(random);
    const Eigen::Vector3d direction = RandomDirection(random);
    const double along = (center - origin).dot(direction);
    const double expected =
        along + std::sqrt(along * along - (center - origin).squaredNorm() + kRadius * kRadius);
    const auto hit = world.CastRay(origin, direction, 10.0);
    ASSERT_TRUE(hit);
    ASSERT_LE(hit->distance, expected + 1e-5);
    ASSERT_GE(hit->distance, expected - 2.0 * sagitta);
  }
}

TEST(World, RaysEndAtTheirGreatestLength) {
  const World world(test::BoxMesh({-1, -1, -1}, {1, 1, 1}), kBounds);
  EXPECT_FALSE(world.CastRay({0, 0, 0}, Eigen::Vector3d::UnitX(), 0.999));
  EXPECT_TRUE(world.CastRay({0, 0, 0}, Eigen::Vector3d::UnitX(), 1.001));
}

TEST(World, BarycentricWeightsGiveTheMeetingPoint) {
  const auto room = test::AnalyticRoom::Furnished();
  const World world(test::MeshOf(room), kBounds);
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d origin = room.RandomPose(random).translation();
    const Eigen::Vector3d direction = RandomDirection(random);
    const auto hit = world.CastRay(origin, direction, 100.0);
    ASSERT_TRUE(hit);
    const auto [a, b, c] = TriangleOf(world.mesh(), hit->triangle);
    const Eigen::Vector3d p = a + hit->barycentric.x() * (b - a) + hit->barycentric.y() * (c - a);
    ASSERT_LT((p - (origin + hit->distance * direction)).norm(), 1e-5);
  }
}

/// Distance to the nearest point of a fine grid over each triangle: too large by at most one cell of the
/// grid.
double SampledDistance(const Mesh& mesh, const Eigen::Vector3d& p, int cells) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
    const auto [a, b, c] = TriangleOf(mesh, index);
    for (int i = 0; i <= cells; ++i) {
      for (int j = 0; i + j <= cells; ++j) {
        const Eigen::Vector3d q = a + (double(i) / cells) * (b - a) + (double(j) / cells) * (c - a);
        nearest = std::min(nearest, (q - p).norm());
      }
    }
  }
  return nearest;
}

Mesh ScatteredTriangles(std::mt19937& random, std::uint32_t count) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Eigen::Vector3d middle = RandomPoint(random, 2.0);
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back((middle + RandomPoint(random, 0.4)).cast<float>());
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(World, DistanceToSurfaceEqualsBruteForce) {
  std::mt19937 random(4);
  const Mesh mesh = ScatteredTriangles(random, 20);
  const World world(mesh, kBounds);
  constexpr int kCells = 40;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p = RandomPoint(random, 2.5);
    const double sampled = SampledDistance(mesh, p, kCells);
    const double distance = world.DistanceToSurface(p, 10.0);
    ASSERT_LE(distance, sampled + 1e-5);
    ASSERT_GE(distance, sampled - 1.4 / kCells);
    ASSERT_NEAR(world.DistanceToSurface(p, 0.5 * distance), 0.5 * distance, 1e-12);
  }
}

TEST(World, DistanceInABoxIsThatToTheNearestSide) {
  const World world(test::BoxMesh({-1, -2, -3}, {1, 2, 3}), kBounds);
  EXPECT_NEAR(world.DistanceToSurface({0.25, 0, 0}, 10.0), 0.75, 1e-9);
  EXPECT_NEAR(world.DistanceToSurface({0, -1.9, 2.0}, 10.0), 0.1, 1e-6);
  EXPECT_NEAR(world.DistanceToSurface({2, 3, 4}, 10.0), std::sqrt(3.0), 1e-6);
}

TEST(World, ClearanceOfACylinderIsThatOfTheNearestOfAllTriangles) {
  std::mt19937 random(6);
  const Mesh mesh = ScatteredTriangles(random, 60);
  const World world(mesh, kBounds);
  std::uniform_real_distribution<double> size(0.05, 1.0);
  int inside = 0;
  for (int i = 0; i < 500; ++i) {
    const RobotModel robot{.radius = size(random), .height = 2.0 * size(random)};
    const Eigen::Vector3d p = RandomPoint(random, 3.0);
    double nearest = 10.0;
    for (std::uint32_t index = 0; index < mesh.triangles.size(); ++index) {
      nearest = std::min(nearest, Distance({p, robot.radius, robot.height}, TriangleOf(mesh, index), 10.0));
    }
    ASSERT_NEAR(world.ClearanceOf(robot, p, 10.0), nearest, 2e-7);
    ASSERT_EQ(world.ClearanceOf(robot, p, nearest - 0.01), nearest - 0.01);
    ASSERT_EQ(world.ClearanceOf(robot, p, 0.0) < 0.0, nearest < 0.0);
    inside += nearest < 0.0;
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(inside, 450);
}

TEST(World, ClearanceOfASphereIsTheDistanceLessItsRadius) {
  std::mt19937 random(7);
  const World world(ScatteredTriangles(random, 20), kBounds);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = RandomPoint(random, 2.5);
    const double distance = world.DistanceToSurface(p, 10.0);
    ASSERT_NEAR(world.ClearanceOf({.radius = 0.3}, p, 10.0), distance - 0.3, 1e-9);
    ASSERT_NEAR(world.ClearanceOf({.radius = 0.3}, p, 0.0), std::min(distance - 0.3, 0.0), 1e-9);
  }
}

TEST(World, SightEndsAtAWallAndAtNothingElse) {
  Mesh mesh;
  test::AddQuad(mesh, {1, -1, -1}, {0, 2, 0}, {0, 0, 2});
  const World world(mesh, kBounds);
  EXPECT_TRUE(world.InSight({0, 0, 0}, {0.999, 0, 0}));
  EXPECT_FALSE(world.InSight({0, 0, 0}, {2, 0, 0}));
  EXPECT_FALSE(world.InSight({2, 0, 0}, {0, 0, 0}));
  EXPECT_TRUE(world.InSight({0, 1.1, 0}, {2, 1.1, 0}));
  EXPECT_TRUE(world.InSight({0, 0, 0}, {0, 0, 0}));
}

TEST(World, ATexturedQuadShowsItsImageTheRightWayUp) {
  Mesh mesh;
  constexpr Rgb kTopLeft{200, 10, 10};
  constexpr Rgb kTopRight{10, 200, 10};
  constexpr Rgb kBottomLeft{10, 10, 200};
  constexpr Rgb kBottomRight{100, 100, 100};
  mesh.textures.push_back({2, 2, {kTopLeft, kTopRight, kBottomLeft, kBottomRight}});
  mesh.material_table.push_back({{1, 2, 3}, 0});
  test::AddQuad(mesh, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 0);
  const World world(mesh, kBounds);
  const auto look_at = [&](double x, double z) {
    return world.ColorAt(*world.CastRay({x, -1, z}, Eigen::Vector3d::UnitY(), 2.0));
  };
  EXPECT_EQ(look_at(0.25, 0.75), kTopLeft);
  EXPECT_EQ(look_at(0.75, 0.75), kTopRight);
  EXPECT_EQ(look_at(0.25, 0.25), kBottomLeft);
  EXPECT_EQ(look_at(0.75, 0.25), kBottomRight);
  EXPECT_EQ(look_at(0.5, 0.75), (Rgb{105, 105, 10})) << "halfway between two pixels";
  EXPECT_TRUE(world.HasTexture(*world.CastRay({0.5, -1, 0.5}, Eigen::Vector3d::UnitY(), 2.0)));
}

/// Standard deviation of the red channel along a line on an untextured wall.
double PatternContrast(const World& world, double length, double footprint) {
  constexpr int kSamples = 400;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d from(0, length * i / kSamples, 0.31);
    const double red = world.ColorAt(*world.CastRay(from, Eigen::Vector3d::UnitX(), 5.0), footprint).r;
    sum += red;
    squares += red * red;
  }
  return std::sqrt(squares / kSamples - sum * sum / kSamples / kSamples);
}

TEST(World, NoSurfaceIsBlankWhetherNearOrFar) {
  const World world(test::BoxMesh({-1, -1, -1}, {1, 1, 1}), kBounds);
  EXPECT_GT(PatternContrast(world, 0.05, 0.0), 4.0) << "within 5 cm";
  EXPECT_GT(PatternContrast(world, 1.0, 0.015), 8.0) << "from 5 m away";
  EXPECT_LT(PatternContrast(world, 0.05, 0.5), 1.0) << "finer than a footprint of 0.5 m is not to be seen";
}

TEST(World, ColorsDoNotDependOnWhoLooks) {
  const World world(test::BoxMesh({-1, -1, -1}, {1, 1, 1}), kBounds);
  const auto from_inside = world.CastRay({0, 0.2, 0.3}, Eigen::Vector3d::UnitX(), 5.0);
  const auto from_outside = world.CastRay({3, 0.2, 0.3}, -Eigen::Vector3d::UnitX(), 5.0);
  EXPECT_EQ(world.ColorAt(*from_inside), world.ColorAt(*from_outside));
}

TEST(World, RefusesAnEmptyMeshEmptyBoundsAndVerticesThatAreNotThere) {
  EXPECT_THROW(World(Mesh{}, kBounds), std::invalid_argument);
  EXPECT_THROW(World(test::BoxMesh({0, 0, 0}, {1, 1, 1}), Eigen::AlignedBox3d()), std::invalid_argument);
  Mesh mesh = test::BoxMesh({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back({0, 1, 24});
  EXPECT_THROW(World(mesh, kBounds), std::invalid_argument);
}

/// A wall at x = 4, and a slab of 2 x 2 m before it at x = 2, which moves aside by 6 m between 10 and 12 s.
World WallBehindASlab(bool with_slab = true) {
  Mesh mesh;
  test::AddQuad(mesh, {4, -19, -19}, {0, 38, 0}, {0, 0, 38});
  MovingPart slab{.at_rest_W = {Eigen::Vector3d(2, -1, -1), Eigen::Vector3d(2.1, 1, 1)},
                  .places = {{.time = 10}, {.time = 12, .offset_W = Eigen::Vector3d(0, 6, 0)}}};
  return {mesh, test::kSensorBounds, {}, with_slab ? std::vector{slab} : std::vector<MovingPart>{}};
}

TEST(WorldWithParts, EveryQuerySeesThemWhereTheyAreNow) {
  World world = WallBehindASlab();
  const Eigen::Vector3d from = Eigen::Vector3d::Zero();
  const Eigen::Vector3d far_away(-9, -9, -9);
  const RobotModel ball{.radius = 0.2};
  const RobotModel cylinder{.radius = 0.2, .height = 0.5};
  const auto hit = world.CastRay(from, Eigen::Vector3d::UnitX(), 10.0);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 2.0, 1e-9);
  EXPECT_TRUE(hit->normal_W.isApprox(-Eigen::Vector3d::UnitX()));
  EXPECT_FALSE(world.CastRay(from, Eigen::Vector3d::UnitX(), 1.9));
  EXPECT_NEAR(world.DistanceToSurface(from, 10.0), 2.0, 1e-9);
  EXPECT_EQ(world.DistanceToSurface(from, 1.5), 1.5);
  for (const RobotModel& robot : {ball, cylinder})
    EXPECT_NEAR(world.ClearanceOf(robot, from, 9.0), 1.8, 1e-6);
  EXPECT_FALSE(world.InSight(from, {3, 0, 0}));
  EXPECT_TRUE(world.InSight(from, {1.9, 0, 0}));
  EXPECT_FALSE(world.HasTexture(*hit));

  EXPECT_NEAR(world.MoveParts(11.0, ball, far_away), 33.0, 1e-9) << "at 3 m/s at most";
  EXPECT_NEAR(world.DistanceToSurface({2, -1, 0}, 10.0), 2.0, 1e-6)
      << "halfway, y from 2 to 4: the wall is as near";
  EXPECT_TRUE(world.InSight(from, {3, 0, 0}));
  EXPECT_FALSE(world.InSight({0, 3, 0}, {3, 3, 0}));
  world.MoveParts(9.0, ball, far_away);
  EXPECT_NEAR(world.CastRay(from, Eigen::Vector3d::UnitX(), 10.0)->distance, 4.0, 1e-6);
  const auto there = world.CastRay({0, 6, 0}, Eigen::Vector3d::UnitX(), 10.0);
  ASSERT_TRUE(there);
  EXPECT_NEAR(there->distance, 2.0, 1e-9);
  for (const double footprint : {0.0, 0.01}) {
    EXPECT_EQ(world.ColorAt(*there, footprint), world.ColorAt(*hit, footprint))
        << "its pattern travels along";
  }
  for (const RobotModel& robot : {ball, cylinder})
    EXPECT_NEAR(world.ClearanceOf(robot, from, 9.0), 3.8, 1e-5);

  EXPECT_NEAR(world.AtStart().CastRay(from, Eigen::Vector3d::UnitX(), 10.0)->distance, 2.0, 1e-9);
  EXPECT_NEAR(world.WithoutParts().CastRay({0, 6, 0}, Eigen::Vector3d::UnitX(), 10.0)->distance, 4.0, 1e-6);
}

TEST(WorldWithParts, WhatTheyLeaveIsBitForBitTheWorldWithoutThem) {
  World world = WallBehindASlab();
  world.MoveParts(100.0, {}, {-9, -9, -9});
  const World bare = WallBehindASlab(false);
  std::mt19937 random(3);
  for (int n = 0; n < 1000; ++n) {
    const Eigen::Vector3d from = test::RandomPoint(random, 1.0);
    const Eigen::Vector3d direction = test::RandomDirection(random);
    if (direction.y() > 0.0) continue;  // where the slab may be now
    const auto hit = world.CastRay(from, direction, 50.0);
    const auto reference = bare.CastRay(from, direction, 50.0);
    ASSERT_EQ(hit.has_value(), reference.has_value());
    ASSERT_EQ(hit ? hit->distance : 0.0, reference ? reference->distance : 0.0);
    ASSERT_EQ(world.DistanceToSurface(from, 3.9), bare.DistanceToSurface(from, 3.9));
  }
}

}  // namespace
}  // namespace thalweg::simulator
