#include "services/mapper/adapter/mapper_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <limits>
#include <optional>
#include <sstream>

#include "tests/services/mapper/support/mapper_service_fixture.h"

namespace thalweg::mapper {
namespace {

namespace topics = dds::topics;
using test::At;
using test::CloudAt;
using test::Listener;
using test::MapperServiceTest;
using test::PoseAt;
using test::SpinTogether;
using thalweg::test::BusOptionsForTest;

TEST_P(MapperServiceTest, CloudAndOdometryInGiveAnUpdateOut) {
  Start();
  Listener listener;
  Connect(listener);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 0));
  // The cloud was taken halfway between two poses.
  const RigidTransform T_WB = MakeTransform(RotationFromYawPitch(0.4, 0.0), {-1.0, 0.2, 0.1});
  const RigidTransform before = MakeTransform(RotationFromYawPitch(0.3, 0.0), {-1.1, 0.1, 0.1});
  const RigidTransform after = MakeTransform(RotationFromYawPitch(0.5, 0.0), {-0.9, 0.3, 0.1});
  const RigidTransform T_WC = T_WB * options_.T_BC;
  const PointCloud cloud =
      thalweg::test::AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(40, 30, 1.3), T_WC);
  PointCloud seen = cloud;  // without the lower right quarter of the image
  for (int v = 15; v < 30; ++v) {
    for (int u = 20; u < 40; ++u) {
      seen.points_C[static_cast<std::size_t>(40 * v + u)].setConstant(
          std::numeric_limits<float>::quiet_NaN());
    }
  }
  odometry_.Write(dds::OdometryToIdl(At(1.0), before, {0, 0, 0}, {0, 0, 0}));
  points_.Write(dds::ToIdl(At(1.1), seen));
  odometry_.Write(dds::OdometryToIdl(At(1.2), after, {0, 0, 0}, {0, 0, 0}));
  ASSERT_TRUE(listener.Follow(*bus_, 0, 1));
  EXPECT_TRUE(listener.replica().grid().SameAs(mapper_->grid()));
  ASSERT_EQ(listener.scans().size(), 1u);
  const Result<ScanView> scan = dds::FromIdl(listener.scans()[0]);
  ASSERT_TRUE(scan) << scan.error();
  EXPECT_TRUE(scan->T_WC.isApprox(T_WC, 1e-9));
  ASSERT_TRUE(scan->measured);
  EXPECT_EQ(scan->measured->of_255, MeasuredShares::Of(seen)->of_255);
  EXPECT_EQ(scan->measured->of_255.front(), 255);
  EXPECT_EQ(scan->measured->of_255.back(), 0);
  // What was measured within range is occupied, except where rounding moves a point across a voxel face.
  std::size_t measured = 0;
  std::size_t elsewhere = 0;
  for (const Eigen::Vector3f& p_C : seen.points_C) {
    if (!(p_C.norm() <= 4.8F)) continue;
    ++measured;
    const VoxelIndex voxel = mapper_->grid().IndexOf(T_WC * p_C.cast<double>());
    elsewhere += mapper_->grid().State(voxel) == VoxelState::kOccupied ? 0 : 1;
  }
  EXPECT_GT(measured, 500u);
  EXPECT_LT(elsewhere, measured / 100);
}

TEST_P(MapperServiceTest, AnUpdateComesEvenWhenNothingChanged) {
  Start();
  Listener listener;
  Connect(listener);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 0));
  PointCloud nothing{.width_px = 2, .height_px = 2, .points_C = {}, .colors = {}};
  nothing.points_C.assign(4, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  SendPose(1.0);
  points_.Write(dds::ToIdl(At(1.0), nothing));
  ASSERT_TRUE(listener.Follow(*bus_, 0, 1));
  EXPECT_EQ(listener.scans().size(), 1u);
  EXPECT_EQ(mapper_->grid().block_count(), 0u);
}

TEST_P(MapperServiceTest, CloudWaitsUntilOdometryReachesItsStamp) {
  Start();
  SendPose(0.9);
  SendCloud(1.0);
  SendPose(0.95);
  ASSERT_TRUE(SpinUntil([&] { return mapper_->pending() == 1; }));
  EXPECT_EQ(Scans(), 0u);
  SendPose(1.05);
  ASSERT_TRUE(SpinUntil([&] { return Scans() == 1; }));
  EXPECT_EQ(mapper_->pending(), 0u);
  EXPECT_EQ(Dropped(), 0u);
}

TEST_P(MapperServiceTest, CloudsThatNoPoseFitsAreDroppedAndCounted) {
  Start();
  SendPose(5.0);
  SendCloud(1.0);  // before the first pose
  ASSERT_TRUE(SpinUntil([&] { return Dropped() == 1; }));
  SendCloud(5.5);
  ASSERT_TRUE(SpinUntil([&] { return mapper_->pending() == 1; }));
  SendPose(6.0);  // after a gap
  ASSERT_TRUE(SpinUntil([&] { return Dropped() == 2; }));
  EXPECT_EQ(Scans(), 0u);
}

TEST_P(MapperServiceTest, ACloudFromJustBeforeTheFirstPoseIsNoLoss) {
  Start();
  SendPose(5.0);
  SendCloud(4.9);
  SendCloud(5.0);
  ASSERT_TRUE(SpinUntil([&] { return Scans() == 1; }));
  EXPECT_EQ(Dropped(), 0U);
}

TEST_P(MapperServiceTest, CloudsThatWaitForeverAreDroppedOldestFirst) {
  Start();
  SendPose(0.0);
  for (std::size_t i = 1; i <= MapperService::kMaxPendingClouds; ++i) {
    SendCloud(0.1 * static_cast<double>(i));
    ASSERT_TRUE(SpinUntil([&] { return mapper_->pending() == i; }));
  }
  SendCloud(2.0);
  ASSERT_TRUE(SpinUntil([&] { return Dropped() == 1; }));
  EXPECT_EQ(mapper_->pending(), MapperService::kMaxPendingClouds);
}

TEST_P(MapperServiceTest, MessagesThatLieAreRejectedAndCounted) {
  Start();
  auto short_cloud = dds::ToIdl(At(1.0), CloudAt(1.0));
  short_cloud.data().resize(100);
  points_.Write(short_cloud);
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 1; }));
  auto empty_cloud = dds::ToIdl(At(1.0), PointCloud{});
  points_.Write(empty_cloud);
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 2; }));
  auto elsewhere = dds::ToIdl(At(1.0), CloudAt(1.0));
  elsewhere.header().frame_id("somewhere");
  points_.Write(elsewhere);
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 3; }));
  auto no_pose = dds::OdometryToIdl(At(1.0), PoseAt(1.0), {0, 0, 0}, {0, 0, 0});
  no_pose.pose().pose().position().x(std::numeric_limits<double>::quiet_NaN());
  odometry_.Write(no_pose);
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 4; }));
  Scan(2.0);  // still works
}

TEST_P(MapperServiceTest, TheSameCloudTwiceIsTakenOnce) {
  Start();
  Scan(1.0);
  SendCloud(1.0);
  ASSERT_TRUE(SpinUntil([&] { return Dropped() == 1; }));
  EXPECT_EQ(Scans(), 1u);
}

TEST_P(MapperServiceTest, GoesOnWhenTheSimulatorsTimeBeginsAgain) {
  Start();
  Scan(100.0);
  const std::size_t blocks = mapper_->grid().block_count();
  Scan(0.5);  // the pose comes first
  EXPECT_GE(Dropped(), 1u);
  EXPECT_GE(mapper_->grid().block_count(), blocks) << "the map is kept";
  // Now the cloud comes first, and must not be placed by a pose from before the jump.
  Scan(3.0);
  SendCloud(0.5);
  ASSERT_TRUE(SpinUntil([&] { return mapper_->pending() == 1; }));
  SendPose(0.5);
  ASSERT_TRUE(SpinUntil([&] { return Scans() == 4; }));
}

TEST_P(MapperServiceTest, AListenerThatJoinsLateEndsWithTheSameMap) {
  Start();
  Listener early;
  Connect(early);
  for (int i = 1; i <= 4; ++i) Scan(0.5 * i);
  ASSERT_TRUE(early.Follow(*bus_, 0, 4));
  Listener late;
  Connect(late);
  ASSERT_TRUE(late.Follow(*bus_, 0, 4));
  EXPECT_TRUE(late.replica().grid().SameAs(mapper_->grid()));
  for (int i = 5; i <= 8; ++i) Scan(0.5 * i);
  ASSERT_TRUE(late.Follow(*bus_, 0, 8));
  ASSERT_TRUE(early.Follow(*bus_, 0, 8));
  EXPECT_TRUE(late.replica().grid().SameAs(mapper_->grid()));
  EXPECT_TRUE(early.replica().grid().SameAs(mapper_->grid()));
}

TEST_P(MapperServiceTest, FullCopiesAreRateLimited) {
  options_.full_copy_period = std::chrono::hours(1);
  Start();
  Listener listener;
  Connect(listener);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 0));
  for (int i = 0; i < 10; ++i) listener.requests().Write(listener.replica().MakeRequest(At(1.0), "listener"));
  Scan(1.0);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 1));
  Scan(1.5);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 2));
  EXPECT_EQ(listener.full_copies(), 1);
}

TEST_P(MapperServiceTest, SaysInTfStaticWhereWhatDoesNotMoveIsAlsoToThoseWhoJoinLate) {
  Start();
  dds::Bus late(BusOptionsForTest("rviz2"));
  std::optional<tf2_msgs::msg::TFMessage> heard;
  late.Subscribe<topics::StaticTransforms>([&](const auto& message) { heard = message; });
  ASSERT_TRUE(SpinTogether(*bus_, late, [&] { return heard.has_value(); }));
  ASSERT_EQ(heard->transforms().size(), 2U);
  EXPECT_EQ(heard->transforms()[0].child_frame_id(), dds::kOdometryFrame);
  EXPECT_EQ(heard->transforms()[1].child_frame_id(), dds::kCameraFrame);
}

TEST_P(MapperServiceTest, PublishesOccupiedVoxelsAsPointsOnlyWhileSomebodyListens) {
  options_.snapshot_period = std::chrono::milliseconds(10);
  Start();
  Scan(1.0);
  dds::Bus tool(BusOptionsForTest("rviz2"));
  std::optional<sensor_msgs::msg::PointCloud2> heard;
  tool.Subscribe<topics::OccupiedPoints>([&](const auto& message) { heard = message; });
  ASSERT_TRUE(SpinTogether(*bus_, tool, [&] { return heard.has_value(); }));
  std::size_t occupied = 0;
  mapper_->grid().ForEachKnown([&](const VoxelIndex&, float log_odds) {
    occupied += OccupancyGrid::StateOf(log_odds) == VoxelState::kOccupied ? 1 : 0;
  });
  EXPECT_GT(occupied, 100U);
  EXPECT_EQ(heard->width(), occupied);
  EXPECT_EQ(heard->header().frame_id(), dds::kMapFrame);
  ASSERT_EQ(heard->fields().size(), 4U);
  EXPECT_EQ(heard->fields()[3].name(), "rgb");
}

TEST_P(MapperServiceTest, PublishesVoxelsInTheirColorsAsSoonAsACloudHasSome) {
  options_.snapshot_period = std::chrono::milliseconds(10);
  Start();
  PointCloud cloud = CloudAt(1.0);
  cloud.colors.clear();
  SendPose(1.0);
  points_.Write(dds::ToIdl(At(1.0), cloud));
  ASSERT_TRUE(SpinUntil([&] { return Scans() == 1; }));
  dds::Bus tool(BusOptionsForTest("rviz2"));
  std::optional<dds::StampedCloud> heard;
  int times_heard = 0;
  tool.Subscribe<topics::ColoredPoints>([&](sensor_msgs::msg::PointCloud2 message) {
    EXPECT_EQ(message.header().frame_id(), dds::kMapFrame);
    message.header().frame_id(dds::kCameraFrame);  // as a cloud's, for which the decoder is made
    const Result<dds::StampedCloud> decoded = dds::FromIdl(message);
    ASSERT_TRUE(decoded) << decoded.error();
    heard = *decoded;
    ++times_heard;
  });
  bool has_occupied = false;
  tool.Subscribe<topics::OccupiedPoints>([&](const auto&) { has_occupied = true; });
  ASSERT_TRUE(SpinTogether(*bus_, tool, [&] { return has_occupied; }));
  EXPECT_FALSE(heard) << "no cloud had colors";
  Scan(2.0);
  ASSERT_TRUE(SpinTogether(*bus_, tool, [&] { return heard.has_value(); }));
  EXPECT_GT(heard->cloud.points_C.size(), 100U);
  EXPECT_THAT(heard->cloud.colors, testing::Each(CloudAt(2.0).colors.front()));
  const OccupancyGrid map = mapper_->grid();
  for (const Eigen::Vector3f& p_W : heard->cloud.points_C) {
    EXPECT_EQ(map.State(map.IndexOf(p_W.cast<double>())), VoxelState::kOccupied);
  }
}

TEST_P(MapperServiceTest, DoesNotPublishColorsAgainWhileTheyAndTheMapStayAsTheyAre) {
  options_.snapshot_period = std::chrono::milliseconds(10);
  Start();
  dds::Bus tool(BusOptionsForTest("rviz2"));
  int published = 0;
  tool.Subscribe<topics::ColoredPoints>([&](const auto&) { ++published; });
  int periods = 0;
  bus_->EveryWall(options_.snapshot_period, [&] { ++periods; });
  std::uint64_t scans = 0;
  const auto look_again = [&](std::optional<Rgb> other_color) {
    ++scans;
    const auto seconds = static_cast<double>(scans);
    odometry_.Write(dds::OdometryToIdl(At(seconds), PoseAt(0.0), {0, 0, 0}, {0, 0, 0}));
    PointCloud cloud = CloudAt(0.0);
    if (other_color) std::ranges::fill(cloud.colors, *other_color);
    points_.Write(dds::ToIdl(At(seconds), cloud));
    ASSERT_TRUE(SpinUntil([&] { return Scans() == scans; }));
    periods = 0;
    ASSERT_TRUE(SpinTogether(*bus_, tool, [&] { return periods > 5; }));
  };
  while (scans < 30) look_again({});  // until each voxel that is seen is as certain as it can be
  ASSERT_TRUE(SpinTogether(*bus_, tool, [&] { return published > 0; }));
  const int before = published;
  for (int n = 0; n < 3; ++n) look_again({});
  EXPECT_EQ(published, before);
  look_again(Rgb{1, 250, 3});
  ASSERT_TRUE(SpinTogether(*bus_, tool, [&] { return published > before; }));
  EXPECT_EQ(published, before + 1);
}

TEST_P(MapperServiceTest, PublishesAnOctomapForToolsThatListen) {
  options_.snapshot_period = std::chrono::milliseconds(10);
  Start();
  Scan(1.0);
  dds::Bus tool(BusOptionsForTest("tool"));
  std::optional<octomap_msgs::msg::Octomap> got;
  tool.Subscribe<topics::Octomap>([&](const auto& message) { got = message; });
  ASSERT_TRUE(SpinTogether(*bus_, tool, [&] { return got.has_value(); }));
  std::stringstream data;
  data.write(reinterpret_cast<const char*>(got->data().data()),
             static_cast<std::streamsize>(got->data().size()));
  octomap::OcTree tree(got->resolution());
  tree.readData(data);
  std::size_t known = 0;
  mapper_->grid().ForEachKnown([&known](const VoxelIndex&, float) { ++known; });
  tree.expand();
  EXPECT_EQ(tree.getNumLeafNodes(), known);
}

INSTANTIATE_TEST_SUITE_P(Engines, MapperServiceTest, thalweg::test::kEngines, thalweg::test::NameOfEngine);

}  // namespace
}  // namespace thalweg::mapper
