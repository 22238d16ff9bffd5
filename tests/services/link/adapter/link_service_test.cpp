#include "services/link/adapter/link_service.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/dds/map_replica.h"
#include "tests/support/analytic_room.h"
#include "tests/support/datagram_sender.h"
#include "tests/support/test_bus.h"

// Two links in one process, between two groups of services that see each other only through them.

namespace thalweg::link {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""ms;
using test::kPatience;

dds::BusOptions On(const std::string& side, const std::string& name) {
  dds::BusOptions options = test::BusOptionsForTest(name);
  options.partition += '.' + side;
  return options;
}

/// A link with its buses and threads.
class RunningLink {
 public:
  explicit RunningLink(Side side)
      : given_(On(side == Side::kOnboard ? "robot" : "base", "link")),
        service_(Healthy(ServiceBusOptions(given_))),
        local_(LocalBusOptions(given_)),
        network_(NetworkBusOptions(given_, Options())),
        link_(Options(), side, {service_, local_, network_}),
        running_([this](const std::stop_token& stop) { link_.Run(stop); }) {}

  static int Domain() { return 100 + getpid() % 99; }  // beside those of BusOptionsForTest

 private:
  static dds::BusOptions Healthy(dds::BusOptions options) {
    options.publish_health = true;
    return options;
  }
  static LinkOptions Options() {
    LinkOptions options;
    options.domain = Domain();
    return options;
  }

  dds::BusOptions given_;
  dds::Bus service_;
  dds::Bus local_;
  dds::Bus network_;
  LinkService link_;
  std::jthread running_;
};

class TwoSides : public testing::Test {
 protected:
  /// Spins both until `done`; `each` is called in between.
  bool Spin(const std::function<bool()>& done, const std::function<void()>& each = {}) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!base_.SpinUntil(done, 5ms)) {
      if (std::chrono::steady_clock::now() > end) return false;
      robot_.SpinUntil([] { return false; }, 5ms);
      if (each) each();
    }
    return true;
  }

  dds::Bus robot_{On("robot", "robot")};
  dds::Bus base_{On("base", "base")};
};

Time At(int k) {
  return Time{100ms * k};
}

TEST_F(TwoSides, CloudsAndPosesCrossOneWayAndPathsTheOther) {
  const auto clouds_out = robot_.Advertise<topics::DepthPoints>();
  const auto poses_out = robot_.Advertise<topics::Odometry>();
  const auto path_out = base_.Advertise<topics::Path>();
  std::vector<sensor_msgs::msg::PointCloud2> clouds;
  std::vector<nav_msgs::msg::Odometry> poses;
  std::vector<nav_msgs::msg::Path> paths;
  base_.Subscribe<topics::DepthPoints>([&](const auto& message) { clouds.push_back(message); });
  base_.Subscribe<topics::Odometry>([&](const auto& message) { poses.push_back(message); });
  robot_.Subscribe<topics::Path>([&](const auto& message) { paths.push_back(message); });
  const RunningLink onboard(Side::kOnboard);
  const RunningLink offboard(Side::kOffboard);
  ASSERT_TRUE(Spin([&] {
    return clouds_out.readers() > 0 && poses_out.readers() > 0 && path_out.readers() > 0;
  })) << "each side subscribes to what the other one reads";

  const auto camera = PinholeCamera::FromFieldOfView(40, 30, 1.3);
  const PointCloud cloud = test::AnalyticRoom::Furnished().Render(camera, RigidTransform::Identity());
  int k = 0;
  const auto publish = [&] {
    ++k;
    const RigidTransform T = MakeTransform(RotationFromYawPitch(0.1 * k, 0.0), {0.3 * k, 1.0, 2.0});
    poses_out.Write(dds::OdometryToIdl(At(k), T, {1, 2, 3}, {4, 5, 6}));
    clouds_out.Write(dds::ToIdl(At(k), cloud));
    path_out.Write(dds::ToIdl(dds::StampedPath{.stamp = At(7), .T_WBs = {T, T}}));
  };
  ASSERT_TRUE(Spin([&] { return clouds.size() >= 5 && poses.size() >= 5 && paths.size() >= 3; }, publish));
  // Poses and paths are the same to the bit.
  const auto pose = dds::FromIdl(poses.back());
  ASSERT_TRUE(pose) << pose.error();
  const int number = static_cast<int>(pose->stamp.time_since_epoch() / 100ms);
  const RigidTransform T = MakeTransform(RotationFromYawPitch(0.1 * number, 0.0), {0.3 * number, 1.0, 2.0});
  EXPECT_EQ(poses.back(), dds::OdometryToIdl(At(number), T, {1, 2, 3}, {4, 5, 6}));
  EXPECT_EQ(dds::FromIdl(paths.back())->stamp, At(7));
  // Clouds keep their shape, and their points within half a step.
  const auto received = dds::FromIdl(clouds.back());
  ASSERT_TRUE(received) << received.error();
  ASSERT_EQ(received->cloud.points_C.size(), cloud.points_C.size());
  EXPECT_EQ(received->cloud.width_px, 40);
  for (std::size_t n = 0; n < cloud.points_C.size(); ++n) {
    const Eigen::Vector3f off = received->cloud.points_C[n] - cloud.points_C[n];
    EXPECT_TRUE(!cloud.points_C[n].allFinite() || off.norm() < 0.005F) << n;
  }
}

TEST_F(TwoSides, TheMapOfAMapperOnBoardIsServedOnTheOtherSide) {
  // A mapper on board, in one voxel after the other.
  OccupancyGrid grid(0.1);
  dds::MapLog log(dds::MapLog::MakeSession(), 0.1);
  const auto updates_out = robot_.Advertise<topics::MapUpdates>();
  robot_.Subscribe<topics::MapRequests>([&](const auto&) { updates_out.Write(log.FullCopy(grid)); });
  const auto requests_out = base_.Advertise<topics::MapRequests>();
  dds::MapReplica replica;
  base_.Subscribe<topics::MapUpdates>([&](const auto& update) {
    const auto applied = replica.Apply(update);
    EXPECT_TRUE(applied) << applied.error();
    if (replica.missing()) requests_out.Write(replica.MakeRequest(Time{}, "test"));
  });
  base_.EveryWall(300ms, [&] {
    if (replica.missing()) requests_out.Write(replica.MakeRequest(Time{}, "test"));
  });
  const RunningLink onboard(Side::kOnboard);
  const auto offboard = std::make_unique<RunningLink>(Side::kOffboard);
  int k = 0;
  const auto change = [&] {
    if (++k > 400) return;
    const VoxelChange voxel{{k % 50, k / 7, -k / 20},
                            k % 3 == 0 ? -0.4F : 0.85F + 0.001F * static_cast<float>(k)};
    grid.Set(voxel.voxel, voxel.log_odds);
    log.Add(At(k), ScanView{.T_WC = RigidTransform::Identity()}, std::span(&voxel, 1));
    updates_out.Write(log.TakeUpdate());
  };
  EXPECT_TRUE(Spin([&] { return k > 400 && replica.has_map() && replica.grid().SameAs(grid); }, change));
  EXPECT_NE(replica.session(), log.session());  // the copy is the link's, with numbers of its own
}

TEST_F(TwoSides, WhatStrangersSendToTheNetworkIsCounted) {
  std::string last;
  robot_.Subscribe<topics::Health>([&](const auto& health) {
    for (const auto& counter : health.rejected()) {
      if (health.service() == "link" && counter.name() == "network datagram") last = counter.last();
    }
  });
  const RunningLink onboard(Side::kOnboard);
  const test::DatagramSender stranger(RunningLink::Domain());
  EXPECT_TRUE(Spin([&] { return !last.empty(); },
                   [&] {
                     stranger.Send({'n', 'o', 't', ' ', 'R', 'T', 'P', 'S'});
                   }));
  EXPECT_NE(last.find("127.0.0.1"), std::string::npos) << last;
}

TEST_F(TwoSides, WhatNobodyReadsDoesNotCross) {
  const auto clouds_out = robot_.Advertise<topics::DepthPoints>();
  const auto status_out = robot_.Advertise<topics::MotionStatus>();
  int statuses = 0;
  base_.Subscribe<topics::MotionStatus>([&](const auto&) { ++statuses; });
  const RunningLink onboard(Side::kOnboard);
  const RunningLink offboard(Side::kOffboard);
  ASSERT_TRUE(Spin([&] { return statuses > 3; }, [&] { status_out.Write({}); }));
  EXPECT_EQ(clouds_out.readers(), 0);
}

}  // namespace
}  // namespace thalweg::link
