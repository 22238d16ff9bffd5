#include "services/evaluator/core/surface_recorder.h"

#include <gtest/gtest.h>

#include <numbers>

#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/core/lockstep.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/core/depth_sensor.h"
#include "services/surface/core/fused/remembered_place.h"
#include "tests/support/meshes.h"

namespace thalweg::evaluator {
namespace {

using Point = Eigen::Vector3d;

/// A room of 3 x 3 x 3 m, and what a robot that starts in its middle can observe.
struct Room {
  explicit Room(const std::vector<Eigen::AlignedBox3d>& furniture = {})
      : world(MeshWith(furniture), Eigen::AlignedBox3d(low, high)), truth(world, start, options) {}
  static simulator::Mesh MeshWith(const std::vector<Eigen::AlignedBox3d>& furniture) {
    simulator::Mesh mesh = test::BoxMesh(low, high);
    for (const Eigen::AlignedBox3d& box : furniture) test::AddBox(mesh, box);
    return mesh;
  }
  SurfaceTruth Surfaces() const { return SurfaceTruth::Of(world, truth, options, start); }

  static inline const Point low{-1.53, -1.53, -1.53}, high{1.47, 1.47, 1.47};
  const Point start{-0.03, -0.03, -0.03};
  simulator::TrueMap::Options options;
  simulator::World world;
  simulator::TrueMap truth;
};

/// Looks everywhere from a place.
void LookAround(const Room& room, const Point& eye_W, SurfaceRecorder& recorder) {
  const DepthSensorModel sensor;
  simulator::DepthSensor camera(sensor);
  for (const double pitch : {-1.2, 0.0, 1.2}) {
    for (int k = 0; k < 8; ++k) {
      const RigidTransform T_WC =
          MakeTransform(RotationFromYawPitch(k * std::numbers::pi / 4.0, pitch) * BodyFromOptical(), eye_W);
      recorder.OnScan(camera.Capture(room.world, T_WC), T_WC, T_WC);
    }
  }
}

TEST(SurfaceTruth, IsTheInsideOfARoom) {
  const Room room;
  const SurfaceTruth surfaces = room.Surfaces();
  EXPECT_NEAR(surfaces.area(), 6 * 9.0, 0.05);
  for (const SurfaceTruth::Point& point : surfaces.points) {
    EXPECT_GT(point.normal_W.dot(room.start - point.p_W), 0.0) << "seen from within";
  }
}

TEST(SurfaceTruth, DoesNotCountWhatABoxStandsOn) {
  const Room room({Eigen::AlignedBox3d(Point(0.5, 0.5, Room::low.z()), Point(1.3, 1.1, -0.7))});
  const Point s(0.8, 0.6, -0.7 - Room::low.z());
  EXPECT_NEAR(room.Surfaces().area(), 6 * 9.0 + 2.0 * s.z() * (s.x() + s.y()), 0.3)
      << "its sides; its top instead of what it stands on";
}

TEST(SurfaceRecorder, ALookAroundFromTheMiddleSeesAllAndInspectsADiscOfEachWall) {
  const Room room;
  const SurfaceTruth surfaces = room.Surfaces();
  SurfaceRecorder recorder(room.world, surfaces, DepthSensorModel{}, {});
  LookAround(room, room.start, recorder);
  const SurfaceFigures figures = recorder.Figures(0.1);
  EXPECT_NEAR(figures.observable, 54.0, 0.05);
  EXPECT_NEAR(figures.seen, 1.0, 0.001);
  // Within 2 m of a place 1.5 m before a wall: there, 41 degrees from the normal.
  EXPECT_NEAR(figures.inspected, std::numbers::pi * (4.0 - 2.25) / 9.0, 0.015);
  EXPECT_EQ(figures.fine, 0.0) << "pixels are 23 mm apart at 1.5 m";
  EXPECT_NEAR(figures.mesh_area / 54.0, 1.0, 0.06) << "along creases, pixels 4 cm apart leave gaps";
  EXPECT_LT(figures.mesh_to_truth, 0.001);
  EXPECT_LT(figures.truth_to_mesh, 0.003);
  EXPECT_GT(figures.f_near, 0.98);
  EXPECT_GT(figures.f_voxel, 0.999);
}

TEST(SurfaceRecorder, AMeshAsideOfTheTruthHasItsDistance) {
  const Room room;
  const SurfaceTruth surfaces = room.Surfaces();
  SurfaceRecorder recorder(room.world, surfaces, DepthSensorModel{}, {});
  simulator::DepthSensor camera({});
  // The robot takes itself to be 5 cm farther from the wall that it looks at than it is.
  const RigidTransform T_WC_true = MakeTransform(BodyFromOptical(), room.start);
  const RigidTransform T_WC = Eigen::Translation3d(-0.05, 0.0, 0.0) * T_WC_true;
  recorder.OnScan(camera.Capture(room.world, T_WC_true), T_WC, T_WC_true);
  const SurfaceFigures figures = recorder.Figures(0.1);
  EXPECT_NEAR(figures.mesh_to_truth, 0.05, 0.005);
  EXPECT_LT(figures.f_near, 0.01);
  EXPECT_NEAR(figures.f_voxel, 2.0 * figures.seen / (1.0 + figures.seen), 0.03)
      << "precision 1, recall as seen";
}

TEST(SurfaceRecorder, WithoutScansNothingIsSeenAndNothingRight) {
  const Room room;
  const SurfaceTruth surfaces = room.Surfaces();
  const SurfaceRecorder recorder(room.world, surfaces, DepthSensorModel{}, {});
  const SurfaceFigures figures = recorder.Figures(0.1);
  EXPECT_EQ(figures.seen, 0.0);
  EXPECT_EQ(figures.f_voxel, 0.0);
  EXPECT_EQ(figures.truth_to_mesh, SurfaceFigures::kFarthest);
}

// Whoever goes on from a checkpoint compares its first cloud with it, wherever the robot has gone meanwhile.
TEST(SurfaceRecorder, NoCloudOfARunIsTakenForOneOfAnotherPlaceThanItsFirst) {
  const Scene scene("kitchen", {});
  const LockstepOptions options = scene.Options("cover", 1);
  const auto mapper_options = mapper::OptionsFrom(scene.scenario(), {});
  const auto map = mapper::MakeMap(mapper_options.engine, mapper_options.map);
  struct Scan {
    PointCloud cloud;
    RigidTransform T_WC;
  };
  std::vector<Scan> scans;
  RunLockstep(scene.world(), scene.Start(1), options, *map, {}, nullptr, {},
              [&](const PointCloud& cloud, const RigidTransform& T_WC, const RigidTransform&) {
                scans.push_back({cloud, T_WC});
              });
  ASSERT_GT(scans.size(), 300U);
  surface::FusedSurface surface({.max_range = options.sensor.max_range});
  constexpr std::size_t kFused = 50;
  for (std::size_t n = 0; n < kFused; n += 5)
    surface.Fuse(scans[n].cloud, options.sensor.camera, scans[n].T_WC);
  const surface::RememberedPlace place(surface.volume());
  std::size_t telling = 0;
  for (std::size_t n = kFused; n < scans.size(); n += 5) {
    const MapAgreement agreement = place.Compare(scans[n].cloud, scans[n].T_WC, 4.0);
    telling += agreement.IsTelling() ? 1 : 0;
    EXPECT_FALSE(agreement.IsOfAnotherPlace())
        << "cloud " << n << ": " << agreement.contradicting << " of " << agreement.known();
  }
  EXPECT_GT(telling, 30U);
  // Had the robot started elsewhere, much of the same would be elsewhere.
  std::size_t refused = 0;
  for (std::size_t n = 0; n < scans.size(); n += 5) {
    const RigidTransform moved = MakeTransform(Eigen::Matrix3d::Identity(), {1.0, 1.0, 0.0}) * scans[n].T_WC;
    refused += place.Compare(scans[n].cloud, moved, 4.0).IsOfAnotherPlace() ? 1 : 0;
  }
  EXPECT_GT(refused, scans.size() / 5 / 10);
}

}  // namespace
}  // namespace thalweg::evaluator
