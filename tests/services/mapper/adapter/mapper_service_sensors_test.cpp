#include <gtest/gtest.h>

#include <vector>

#include "services/mapper/adapter/mapper_service.h"
#include "tests/services/mapper/support/mapper_service_fixture.h"
#include "tests/support/depth_message.h"

namespace thalweg::mapper {
namespace {

namespace topics = dds::topics;
using test::At;
using test::CloudAt;
using test::Listener;
using test::MapperServiceTest;
using test::PoseAt;
using thalweg::test::AwaitMatch;
using thalweg::test::BusOptionsForTest;

/// The depths of a cloud of the test.
sensor_msgs::msg::Image DepthImageAt(double seconds) {
  return thalweg::test::DepthMessage(At(seconds), CloudAt(seconds));
}

class DepthImageTest : public MapperServiceTest {
 protected:
  void StartWithImages() {
    options_.reads_images = true;
    bus_.emplace(BusOptionsForTest("mapper"));
    mapper_.emplace(options_, *bus_);
    AwaitMatch(robot_, odometry_, *bus_);
    AwaitMatch(robot_, images_, *bus_);
    AwaitMatch(robot_, cameras_, *bus_);
  }
  void SendCamera(double seconds, const PinholeCamera& camera = PinholeCamera::FromFieldOfView(40, 30, 1.3)) {
    cameras_.Write(dds::ToIdl(At(seconds), camera, 0.0));
  }

  dds::Bus::Publisher<topics::DepthImage> images_ = robot_.Advertise<topics::DepthImage>();
  dds::Bus::Publisher<topics::DepthCameraInfo> cameras_ = robot_.Advertise<topics::DepthCameraInfo>();
};

INSTANTIATE_TEST_SUITE_P(Engines, DepthImageTest, thalweg::test::kEngines, thalweg::test::NameOfEngine);

TEST_P(DepthImageTest, WithItsCalibrationGivesTheMapOfTheCloud) {
  Start();
  Scan(1.0);
  const OccupancyGrid from_cloud = CopyOf(mapper_->grid());
  Kill();
  options_.out = folder_.path() / "images";
  StartWithImages();
  SendPose(1.0);
  SendCamera(1.0);
  images_.Write(DepthImageAt(1.0));
  ASSERT_TRUE(SpinUntil([&] { return Scans() == 1; }));
  const OccupancyGrid from_image = CopyOf(mapper_->grid());
  // Points of the image are the cloud's but for the last digits, which decide a few voxels.
  std::size_t known = 0;
  std::size_t same = 0;
  from_cloud.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    ++known;
    same += from_image.State(voxel) == OccupancyGrid::StateOf(log_odds) ? 1 : 0;
  });
  EXPECT_GT(known, 1000U);
  EXPECT_GE(static_cast<double>(same), 0.999 * static_cast<double>(known));
}

TEST_P(DepthImageTest, IsPairedWithTheCalibrationOfItsStampInAnyOrder) {
  StartWithImages();
  for (const double seconds : {1.0, 2.0, 3.0}) {
    SendPose(seconds);
    const auto before = Scans();
    if (seconds != 2.0) images_.Write(DepthImageAt(seconds));
    SendCamera(seconds);
    if (seconds == 2.0) images_.Write(DepthImageAt(seconds));
    ASSERT_TRUE(SpinUntil([&] { return Scans() == before + 1; })) << seconds;
  }
  EXPECT_EQ(Dropped() + Rejected(), 0U);
}

TEST_P(DepthImageTest, OfAnotherSizeThanItsCalibrationIsRejected) {
  StartWithImages();
  SendPose(1.0);
  SendCamera(1.0, PinholeCamera::FromFieldOfView(80, 60, 1.3));
  images_.Write(DepthImageAt(1.0));
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 1; }));
  EXPECT_EQ(Scans(), 0U);
}

/// Rays without a return only, encoded as drivers of depth cameras do: infinite depth.
sensor_msgs::msg::PointCloud2 NoReturns(double seconds, int width_px, int height_px) {
  const auto pixels = static_cast<std::size_t>(width_px * height_px);
  return dds::ToIdl(At(seconds), PointCloud{.width_px = width_px,
                                            .height_px = height_px,
                                            .points_C = std::vector<Eigen::Vector3f>(pixels, NoReturn()),
                                            .colors = {}});
}

TEST_P(MapperServiceTest, RaysWithoutReturnClearSpaceOnlyWhereTheScenarioSaysSo) {
  for (const bool says_so : {true, false}) {
    options_.map.no_return.reset();
    if (says_so) options_.map.no_return = PinholeCamera::FromFieldOfView(40, 30, 1.3);
    options_.checkpoint_period = Duration::zero();
    Start();
    Listener listener;
    Connect(listener);
    ASSERT_TRUE(listener.Follow(*bus_, 0, 0));
    SendPose(1.0);
    points_.Write(NoReturns(1.0, 40, 30));
    ASSERT_TRUE(listener.Follow(*bus_, 0, 1));
    const Eigen::Vector3d ahead_W = PoseAt(1.0) * Eigen::Vector3d(2.0, 0.01, 0.01);
    EXPECT_EQ(mapper_->grid().State(mapper_->grid().IndexOf(ahead_W)),
              says_so ? VoxelState::kFree : VoxelState::kUnknown);
    const Result<ScanView> scan = dds::FromIdl(listener.scans().back());
    ASSERT_TRUE(scan && scan->measured);
    EXPECT_EQ(scan->measured->of_255.front(), says_so ? 255 : 0);
    Kill();
  }
}

TEST_P(MapperServiceTest, WhatTheFilterDropsCountsAsNotMeasured) {
  options_.filter = {.type = FilterModel::Type::kDistance, .max_distance = 2.0};
  options_.checkpoint_period = Duration::zero();
  Start();
  Listener listener;
  Connect(listener);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 0));
  SendPose(1.0);
  PointCloud wall{.width_px = 40, .height_px = 30, .points_C = {}, .colors = {}};
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(40, 30, 1.3);
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) {
      const float depth = u < 20 ? 1.5F : 3.0F;  // the right half is beyond
      wall.points_C.push_back(depth * camera.RayAtUnitDepth(u, v).cast<float>());
    }
  }
  points_.Write(dds::ToIdl(At(1.0), wall));
  ASSERT_TRUE(listener.Follow(*bus_, 0, 1));
  const Result<ScanView> scan = dds::FromIdl(listener.scans().back());
  ASSERT_TRUE(scan && scan->measured);
  const int row = 8 * 4;  // in the middle of the image
  EXPECT_EQ(scan->measured->of_255.at(row), 255);
  EXPECT_EQ(scan->measured->of_255.at(row + 7), 0);
  const OccupancyGrid grid = mapper_->grid();
  grid.ForEachKnown([&](const VoxelIndex& voxel, float) {
    EXPECT_LE((grid.CenterOf(voxel) - (PoseAt(1.0) * options_.T_BC).translation()).norm(), 2.2);
  });
}

TEST_P(MapperServiceTest, RaysWithoutReturnOfUnknownDirectionsAreCountedAndClearNothing) {
  options_.map.no_return = PinholeCamera::FromFieldOfView(40, 30, 1.3);
  Start();
  SendPose(1.0);
  points_.Write(NoReturns(1.0, 20, 16));
  ASSERT_TRUE(SpinUntil([&] { return Scans() == 1 && Dropped() == 1; }));
  EXPECT_EQ(mapper_->grid().block_count(), 0u);
  Scan(1.5);
  EXPECT_EQ(Dropped(), 1u) << "a cloud without such rays may have any size";
}

}  // namespace
}  // namespace thalweg::mapper
