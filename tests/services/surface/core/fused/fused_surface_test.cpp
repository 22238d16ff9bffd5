#include "services/surface/core/fused/fused_surface.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/services/surface/core/fused/clouds.h"

namespace thalweg::surface {
namespace {

using test::Fusion;
using Point = Eigen::Vector3d;

const PinholeCamera kCoarse = PinholeCamera::FromFieldOfView(100, 100, 1.309);
const PinholeCamera kFine = PinholeCamera::FromFieldOfView(320, 240, 1.15);
const double kVoxel = FusedSurface::Options{}.voxel_size;

/// Views from all sides of what is at the origin.
std::vector<RigidTransform> AllAround(double distance) {
  std::vector<RigidTransform> poses;
  for (const double height : {-0.9, -0.4, 0.0, 0.4, 0.9}) {
    for (int k = 0; k < 8; ++k) {
      const double yaw = 0.37 + k * std::numbers::pi / 4.0;
      const Point side(std::cos(yaw) * std::sqrt(1.0 - height * height),
                       std::sin(yaw) * std::sqrt(1.0 - height * height), height);
      poses.push_back(test::LookingAt(distance * side, Point::Zero()));
    }
  }
  return poses;
}

TEST(FusedSurface, APlaneIsWhereItIsAndAsLargeAsWhatIsSeenOfIt) {
  // Seen obliquely, in general position to the voxels, by a camera whose pixels are 4.6 cm apart there.
  Fusion fusion({});
  const RigidTransform T_WC = test::LookingAlong(Point(0.013, 0.027, 0.041), 0.3, -0.1);
  const Point on_plane(3.0, 0.0, 0.0);
  const Point normal = Point(-1.0, 0.2, 0.1).normalized();
  fusion.See(kCoarse, T_WC,
             [&](const Point& o, const Point& d) { return test::ToPlane(on_plane, normal, o, d); });
  const TriangleMesh mesh = fusion.mesh.Joined();
  const auto [most, mean] = test::ErrorsOf(mesh, [&](const Point& p) { return (p - on_plane).dot(normal); });
  EXPECT_LT(most, 0.001 * kVoxel);
  for (const Eigen::Vector3f& n : mesh.normals_W) EXPECT_GT(n.cast<double>().dot(normal), 0.999);
  // The area between the outermost pixels, a quadrangle, less its rim: a cell needs all of its corners.
  const auto corner = [&](double u, double v) -> Point {
    const Point ray = T_WC.linear() * kCoarse.RayAtUnitDepth(u, v).normalized();
    return T_WC.translation() + test::ToPlane(on_plane, normal, T_WC.translation(), ray) * ray;
  };
  const Point a = corner(0, 0), b = corner(99, 0), c = corner(99, 99), d = corner(0, 99);
  const double rim = kVoxel * ((b - a).norm() + (c - b).norm() + (d - c).norm() + (a - d).norm());
  const double area = 0.5 * ((b - a).cross(c - a).norm() + (c - a).cross(d - a).norm()) - rim;
  EXPECT_NEAR(test::AreaOf(mesh) / area, 1.0, 0.01);
  EXPECT_NEAR(fusion.mesh.area().seen, test::AreaOf(mesh), 1e-3);
}

TEST(FusedSurface, ASphereHasItsArea) {
  Fusion fusion({});
  constexpr double kRadius = 0.5;
  const Point center(0.004, -0.003, 0.007);
  for (const RigidTransform& T_WC : AllAround(1.6)) {
    fusion.See(kFine, T_WC,
               [&](const Point& o, const Point& d) { return test::ToSphere(center, kRadius, o, d); });
  }
  const TriangleMesh mesh = fusion.mesh.Joined();
  EXPECT_NEAR(test::AreaOf(mesh) / (4.0 * std::numbers::pi * kRadius * kRadius), 1.0, 0.01);
  const auto [most, mean] =
      test::ErrorsOf(mesh, [&](const Point& p) { return (p - center).norm() - kRadius; });
  EXPECT_LT(most, 0.2 * kVoxel);
  EXPECT_LT(mean, 0.05 * kVoxel);
  for (std::size_t i = 0; i < mesh.vertices_W.size(); ++i) {
    const Point outward = (mesh.vertices_W[i].cast<double>() - center).normalized();
    EXPECT_GT(mesh.normals_W[i].cast<double>().dot(outward), 0.95);
  }
}

TEST(FusedSurface, ABoxHasItsArea) {
  Fusion fusion({});
  const Eigen::AlignedBox3d box(Point(-0.413, -0.507, -0.311), Point(0.421, 0.493, 0.319));
  for (const RigidTransform& T_WC : AllAround(1.6)) {
    fusion.See(kFine, T_WC, [&](const Point& o, const Point& d) { return test::ToBox(box, o, d); });
  }
  const Point s = box.sizes();
  const double area = 2.0 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
  const TriangleMesh mesh = fusion.mesh.Joined();
  EXPECT_NEAR(test::AreaOf(mesh) / area, 1.0, 0.01);
  const auto distance = [&](const Point& p) {
    const Point inside = (p - box.min()).cwiseMin(box.max() - p);
    return inside.minCoeff() >= 0.0 ? inside.minCoeff() : box.exteriorDistance(p);
  };
  const double mean = test::ErrorsOf(mesh, distance).second;
  EXPECT_LT(mean, 0.05 * kVoxel);
  const auto far =
      std::count_if(mesh.vertices_W.begin(), mesh.vertices_W.end(),
                    [&](const Eigen::Vector3f& p) { return distance(p.cast<double>()) > kVoxel; });
  EXPECT_LT(static_cast<double>(far), 1e-3 * static_cast<double>(mesh.vertices_W.size()))
      << "fringes of edges";
}

TEST(FusedSurface, BothSidesOfABoardOfAVoxelAndAHalfRemain) {
  Fusion fusion({});
  const Eigen::AlignedBox3d board(Point(-0.5, -0.5, -0.0137), Point(0.5, 0.5, 0.0163));
  const auto see = [&](const Point& eye) {
    fusion.See(kFine, test::LookingAt(eye, Point::Zero()),
               [&](const Point& o, const Point& d) { return test::ToBox(board, o, d); });
  };
  for (int k = 0; k < 10; ++k) see({0.3, 0.1 * k, 1.3});
  for (int k = 0; k < 10; ++k) see({0.3, 0.1 * k, -1.3});
  double above = 0.0;
  double below = 0.0;
  const TriangleMesh mesh = fusion.mesh.Joined();
  for (const auto& [a, b, c] : mesh.faces) {
    const Eigen::Vector3f p = mesh.vertices_W[a];
    const Eigen::Vector3f n = (mesh.vertices_W[b] - p).cross(mesh.vertices_W[c] - p);
    (n.z() > 0.0F ? above : below) += 0.5 * std::abs(static_cast<double>(n.z()));
  }
  EXPECT_NEAR(above, 1.0, 0.05) << "voxels round its rim off";
  EXPECT_NEAR(below, 1.0, 0.05);
}

TEST(FusedSurface, FreeSpaceRemovesWhatIsNoLongerThere) {
  Fusion fusion({});
  const RigidTransform T_WC = test::LookingAlong(Point::Zero(), 0.0, 0.0);
  const Eigen::AlignedBox3d stray(Point(1.5, -0.2, -0.2), Point(1.6, 0.2, 0.2));
  const auto wall = [](const Point& o, const Point& d) {
    return test::ToPlane(Point(3.0, 0, 0), Point(-1, 0, 0), o, d);
  };
  fusion.See(kFine, T_WC,
             [&](const Point& o, const Point& d) { return std::min(wall(o, d), test::ToBox(stray, o, d)); });
  const auto vertices_before_the_wall = [&] {
    const TriangleMesh mesh = fusion.mesh.Joined();
    return std::count_if(mesh.vertices_W.begin(), mesh.vertices_W.end(),
                         [](const auto& p) { return p.x() < 2.5F; });
  };
  EXPECT_GT(vertices_before_the_wall(), 100);
  for (int k = 0; k < 4; ++k) fusion.See(kFine, T_WC, wall);
  EXPECT_EQ(vertices_before_the_wall(), 0);
}

TEST(FusedSurface, AViewThatIsTooCoarseToSeeAPoleDoesNotEraseIt) {
  Fusion fusion({});
  const Eigen::AlignedBox3d pole(Point(2.99, -0.015, -0.5), Point(3.02, 0.015, 0.5));
  const auto scene = [&](const Point& o, const Point& d) {
    return std::min(test::ToBox(pole, o, d), test::ToPlane(Point(5.0, 0, 0), Point(-1, 0, 0), o, d));
  };
  fusion.See(kFine, test::LookingAlong(Point(2.0, 0, 0), 0.0, 0.0), scene);
  const auto vertices_of_the_pole = [&] {
    const TriangleMesh mesh = fusion.mesh.Joined();
    return std::count_if(mesh.vertices_W.begin(), mesh.vertices_W.end(),
                         [](const auto& p) { return p.x() < 4.0F; });
  };
  const auto before = vertices_of_the_pole();
  ASSERT_GT(before, 20);
  // From 6 m the pixels are 9 cm apart, and the pole is between two of them.
  const RigidTransform far = test::LookingAlong(Point(-3.0, 0.0, 0.0), 0.0, 0.0);
  for (int k = 0; k < 50; ++k) fusion.See(kCoarse, far, scene);
  EXPECT_GE(vertices_of_the_pole(), before);
}

TEST(FusedSurface, StandingStillForAThousandScansTakesNoMoreMemoryThanTen) {
  FusedSurface surface({.voxel_size = 0.05});
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(40, 40, 1.0);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.002);
  const auto scan = [&] {
    return test::CloudOf(camera, RigidTransform::Identity(), [&](const Point& o, const Point& d) {
      return test::ToPlane(Point(0, 0, 2.0), Point(0.1, 0.1, -1).normalized(), o, d) + noise(random);
    });
  };
  for (int k = 0; k < 10; ++k) surface.Fuse(scan(), camera, RigidTransform::Identity());
  const std::size_t blocks = surface.volume().block_count();
  for (int k = 0; k < 990; ++k) surface.Fuse(scan(), camera, RigidTransform::Identity());
  EXPECT_LE(surface.volume().block_count(), blocks + blocks / 50);
}

TEST(FusedSurface, TheSameExactScanAgainChangesNothing) {
  FusedSurface surface({});
  const RigidTransform T_WC = test::LookingAlong(Point(0.01, 0.02, 0.03), 0.2, 0.1);
  const PointCloud cloud = test::CloudOf(kCoarse, T_WC, [](const Point& o, const Point& d) {
    return test::ToPlane(Point(2.0, 0, 0), Point(-1, 0.1, 0.3).normalized(), o, d);
  });
  EXPECT_FALSE(surface.Fuse(cloud, kCoarse, T_WC).empty());
  EXPECT_TRUE(surface.Fuse(cloud, kCoarse, T_WC).empty());
}

TEST(FusedSurface, RemembersTheBestDistanceAngleAndSamplingOfItsViews) {
  FusedSurface surface({});
  const auto wall = [](const Point& o, const Point& d) {
    return test::ToPlane(Point(0.01, 0, 0), Point(-1, 0, 0), o, d);
  };
  const auto see = [&](const RigidTransform& T_WC) {
    surface.Fuse(test::CloudOf(kFine, T_WC, wall), kFine, T_WC);
  };
  const auto at_origin = [&] { return surface.volume().VoxelAt({0, 0, 0}).best; };
  see(test::LookingAt({-4.0, 0.0, 0.0}, Point::Zero()));  // square, but far
  EXPECT_NEAR(at_origin().distance(), 4.0, 0.02);
  EXPECT_NEAR(at_origin().cosine(), 1.0, 0.005);
  EXPECT_FALSE(at_origin().inspected());
  see(test::LookingAt({-0.5, -1.5, 0.0}, Point::Zero()));  // near, but 72 degrees off
  EXPECT_NEAR(at_origin().distance(), std::hypot(0.5, 1.5), 0.02);
  EXPECT_NEAR(at_origin().cosine(), 1.0, 0.005);
  EXPECT_FALSE(at_origin().inspected()) << "no view was both";
  see(test::LookingAt({-1.5, 0.8, 0.0}, Point::Zero()));
  EXPECT_TRUE(at_origin().inspected());
  // This is the last view, in the middle of the image: the distance over f and the cosine.
  const double distance = std::hypot(1.51, 0.8);
  EXPECT_NEAR(at_origin().sampling(), distance / kFine.fx / (1.51 / distance), 2e-4);
}

TEST(FusedSurface, AShareOfItsAreaWasInspected) {
  // On a wall at 1.5 m, what is nearer than 2 m is a disc of sqrt(2^2 - 1.5^2) m radius, all of it within 42
  // degrees of the normal.
  Fusion fusion({});
  const PinholeCamera wide = PinholeCamera::FromFieldOfView(200, 200, 2.2);
  fusion.See(wide, test::LookingAlong(Point::Zero(), 0.0, 0.0), [](const Point& o, const Point& d) {
    return test::ToPlane(Point(1.507, 0, 0), Point(-1, 0, 0), o, d);
  });
  const double disc = std::numbers::pi * (4.0 - 1.507 * 1.507);
  EXPECT_NEAR(fusion.mesh.area().inspected / disc, 1.0, 0.01);
  EXPECT_GT(fusion.mesh.area().seen, 2.0 * disc);
}

TEST(FusedSurface, AveragesTheStatedNoiseAway) {
  // Inverse depth off by 0.002 / m: 8 mm at 2 m.
  constexpr double kSigma = 0.002;
  Fusion fusion({.depth_error = {.sigma = kSigma, .window_px = 11}});
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, kSigma);
  const Point on_plane(2.0, 0.0, 0.0);
  const Point normal = Point(-1.0, 0.2, 0.1).normalized();
  const RigidTransform T_WC = test::LookingAlong(Point::Zero(), 0.0, 0.0);
  for (int k = 0; k < 10; ++k) {
    fusion.See(kCoarse, T_WC, [&](const Point& o, const Point& d) {
      return 1.0 / (1.0 / test::ToPlane(on_plane, normal, o, d) + noise(random));
    });
  }
  const TriangleMesh mesh = fusion.mesh.Joined();
  const auto [most, mean] = test::ErrorsOf(mesh, [&](const Point& p) { return (p - on_plane).dot(normal); });
  EXPECT_LT(mean, kSigma * 4.0 / 3.0);
  EXPECT_GT(test::AreaOf(mesh), 8.0) << "of 9.4 m^2";
}

TEST(FusedSurface, RefusesOptionsThatAreNoLengths) {
  EXPECT_THROW(FusedSurface({.voxel_size = 0.0}), std::invalid_argument);
  EXPECT_THROW(FusedSurface({.max_range = -1.0}), std::invalid_argument);
  EXPECT_THROW(FusedSurface({.depth_error = {.sigma = std::nan("")}}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::surface
