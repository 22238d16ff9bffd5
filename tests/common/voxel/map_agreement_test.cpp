#include "common/voxel/map_agreement.h"

#include <gtest/gtest.h>

#include <random>

#include "services/mapper/core/occupancy_map.h"
#include "tests/support/analytic_room.h"

namespace thalweg {
namespace {

using test::AnalyticRoom;

constexpr double kRange = 4.0;  // [m]
const PinholeCamera kCamera = PinholeCamera::FromFieldOfView(60, 45, 1.3);

/// The room from so many random places.
OccupancyGrid MapOf(const AnalyticRoom& room, int scans, unsigned seed = 1) {
  mapper::OccupancyMap map(mapper::OccupancyMap::Options{});
  std::mt19937 random(seed);
  for (int k = 0; k < scans; ++k) {
    const RigidTransform T_WC = room.RandomPose(random);
    map.Integrate(room.Render(kCamera, T_WC), T_WC);
  }
  OccupancyGrid copy(map.grid().voxel_size());
  map.grid().ForEachKnown([&](const VoxelIndex& voxel, float log_odds) { copy.Set(voxel, log_odds); });
  return copy;
}

/// The robot's start: in the middle of the room, level.
RigidTransform LevelAt(double x, double y, double yaw) {
  return MakeTransform(RotationFromYawPitch(yaw, 0.0) * BodyFromOptical(), {x, y, 0.0});
}

/// With walls elsewhere, floor and ceiling where they were.
AnalyticRoom Scaled(double share) {
  AnalyticRoom room = AnalyticRoom::Furnished();
  const auto scaled = [share](Eigen::AlignedBox3d& box) {
    for (const int axis : {0, 1}) {
      box.min()[axis] *= share;
      box.max()[axis] *= share;
    }
  };
  scaled(room.walls);
  for (auto& box : room.boxes) scaled(box);
  return room;
}

TEST(MapAgreement, OfTheSamePlaceIsNearlyWhole) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  std::mt19937 random(3);
  for (const int scans : {1, 3, 10, 60}) {
    const OccupancyGrid map = MapOf(room, scans);
    for (int k = 0; k < 30; ++k) {
      const RigidTransform T_WC = room.RandomPose(random);
      const MapAgreement agreement = Compare(map, room.Render(kCamera, T_WC), T_WC, kRange);
      EXPECT_FALSE(agreement.IsOfAnotherPlace()) << scans << ' ' << k;
      EXPECT_LE(static_cast<double>(agreement.contradicting),
                0.1 * static_cast<double>(agreement.known()) + 20.0)
          << scans << ' ' << k;
    }
  }
}

TEST(MapAgreement, ForgivesADriftOfTheOdometry) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const OccupancyGrid map = MapOf(room, 40);
  std::mt19937 random(4);
  for (int k = 0; k < 30; ++k) {
    const RigidTransform T_WC = room.RandomPose(random);
    RigidTransform drifted = T_WC;
    drifted.pretranslate(Eigen::Vector3d(0.15, -0.1, 0.05));
    const MapAgreement agreement = Compare(map, room.Render(kCamera, T_WC), drifted, kRange);
    EXPECT_FALSE(agreement.IsOfAnotherPlace()) << agreement.contradicting << " of " << agreement.known();
  }
}

TEST(MapAgreement, ReportsAnotherPlaceFromTheStart) {
  const OccupancyGrid map = MapOf(AnalyticRoom::Furnished(), 60);
  for (const double share : {0.5, 0.7, 1.4}) {
    const AnalyticRoom other = Scaled(share);
    int recognized = 0;
    for (int k = 0; k < 8; ++k) {
      const RigidTransform T_WC = LevelAt(0.0, 0.0, 0.785 * k);
      recognized += Compare(map, other.Render(kCamera, T_WC), T_WC, kRange).IsOfAnotherPlace() ? 1 : 0;
    }
    EXPECT_GE(recognized, 4) << share << ": from half of the directions, walls are near enough";
  }
}

TEST(MapAgreement, ReportsARobotThatStartedElsewhere) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const OccupancyGrid map = MapOf(room, 60);
  // It stands at (-2, -1.5), turned around, and takes this for the origin.
  int recognized = 0;
  for (int k = 0; k < 8; ++k) {
    const RigidTransform T_WC = LevelAt(-2.0, -1.5, 0.785 * k + 2.0);
    const MapAgreement agreement =
        Compare(map, room.Render(kCamera, T_WC), LevelAt(0.0, 0.0, 0.785 * k), kRange);
    recognized += agreement.IsOfAnotherPlace() ? 1 : 0;
  }
  EXPECT_GE(recognized, 4);
}

TEST(MapAgreement, SaysNothingWhereNothingIsKnown) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  const PointCloud cloud = room.Render(kCamera, LevelAt(0.0, 0.0, 0.0));
  const MapAgreement agreement = Compare(OccupancyGrid(0.1), cloud, LevelAt(0.0, 0.0, 0.0), kRange);
  EXPECT_EQ(agreement.known(), 0U);
  EXPECT_FALSE(agreement.IsTelling());
  EXPECT_FALSE(agreement.IsOfAnotherPlace());
  // Nor where no index leads.
  EXPECT_EQ(Compare(MapOf(room, 3), cloud, LevelAt(1e7, 0.0, 0.0), kRange).known(), 0U);
  EXPECT_EQ(Compare(MapOf(room, 3), cloud, LevelAt(std::nan(""), 0.0, 0.0), kRange).known(), 0U);
}

}  // namespace
}  // namespace thalweg
