#include "services/explorer/adapter/explorer_service.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <thread>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/files/write_file.h"
#include "common/geometry/depth_image.h"
#include "tests/services/explorer/support/rooms.h"
#include "tests/support/depth_message.h"
#include "tests/support/test_bus.h"

namespace thalweg::explorer {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""ms;
using test::kHere;
using thalweg::test::BusOptionsForTest;

dds::BusOptions ExplorerBusOptions() {
  dds::BusOptions options = BusOptionsForTest("explorer");
  options.publish_health = true;
  return options;
}

/// The explorer on its own participant and thread.
class RunningExplorer {
 public:
  explicit RunningExplorer(const Explorer::Options& options = test::GoingOptions(), ExplorationFile file = {},
                           ExplorerService::ViewSource views = ExplorerService::ViewSource::kClouds)
      : bus_(ExplorerBusOptions()), service_(options, bus_, std::move(file), views) {}

 private:
  dds::Bus bus_;
  ExplorerService service_;
  std::jthread thread_{[this](std::stop_token stop) { bus_.Spin(stop); }};
};

/// A mapper that sends a full copy on request, and a robot that reports its pose.
class ExplorerServiceTest : public testing::Test {
 protected:
  ExplorerServiceTest() {
    for (const VoxelChange& change : test::LongRoom()) grid_.Set(change.voxel, change.log_odds);
    bus_.Subscribe<topics::MapRequests>([this](const auto& message) {
      ++requests_;
      request_ = message;
      if (answers_) updates_out_.Write(log_.FullCopy(grid_));
    });
    bus_.Subscribe<topics::Path>([this](const auto& message) {
      const auto path = dds::FromIdl(message);
      ASSERT_TRUE(path) << path.error();
      path_ = *path;
    });
    bus_.Subscribe<topics::ExplorationStatus>([this](const auto& message) { status_ = message; });
    bus_.Subscribe<topics::CommandReplies>([this](const auto& message) { replies_.push_back(message); });
    bus_.Subscribe<topics::Health>([this](const auto& message) {
      if (message.service() == "explorer") health_ = message;
    });
    bus_.Every(50ms, [this] {
      if (publishes_pose_) odometry_out_.Write(Odometry());
    });
  }

  bool Until(const std::function<bool()>& done) { return bus_.SpinUntil(done, thalweg::test::kPatience); }
  bool Matched() const {
    return updates_out_.readers() == 1 && odometry_out_.readers() == 1 && motion_out_.readers() == 1 &&
           bus_.Writers<topics::MapRequests>() == 1 && bus_.Writers<topics::Path>() == 1 &&
           bus_.Writers<topics::ExplorationStatus>() == 1 && bus_.Writers<topics::Health>() == 1;
  }
  bool Is(thalweg_msgs::msg::ExplorationState state) const { return status_ && status_->state() == state; }
  nav_msgs::msg::Odometry Odometry() const {
    return dds::OdometryToIdl(bus_.Now(), kHere, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  }
  /// Applies the changes and returns the next update.
  thalweg_msgs::msg::MapUpdate Update(const std::vector<VoxelChange>& changes) {
    for (const VoxelChange& change : changes) grid_.Set(change.voxel, change.log_odds);
    log_.Add(bus_.Now(), {.T_WC = kHere * RobotModel{}.T_BC}, changes);
    return log_.TakeUpdate();
  }
  thalweg_msgs::msg::MotionStatus Standing(Time path_id) const {
    thalweg_msgs::msg::MotionStatus status;
    status.header(dds::MakeHeader(bus_.Now(), dds::kMapFrame));
    status.path_stamp(dds::ToIdl(path_id));
    status.state(thalweg_msgs::msg::MOTION_STOPPED);
    status.speed_mps(0.0);
    return status;
  }

  /// Sends a command and returns the reply.
  thalweg_msgs::msg::CommandReply Send(thalweg_msgs::msg::OperatorCommand command) {
    command.header(dds::MakeHeader(bus_.Now(), dds::kMapFrame));
    command.sender("test");
    command.id(++command_id_);
    const std::size_t before = replies_.size();
    EXPECT_TRUE(
        Until([&] { return commands_out_.readers() == 1 && bus_.Writers<topics::CommandReplies>() == 1; }));
    commands_out_.Write(command);
    EXPECT_TRUE(Until([&] { return replies_.size() > before; }));
    if (replies_.size() == before) return {};
    EXPECT_EQ(replies_.back().service(), "explorer");
    EXPECT_EQ(replies_.back().sender(), "test");
    EXPECT_EQ(replies_.back().id(), command_id_);
    return replies_.back();
  }
  thalweg_msgs::msg::CommandReply Send(thalweg_msgs::msg::CommandKind kind) {
    thalweg_msgs::msg::OperatorCommand command;
    command.kind(kind);
    return Send(command);
  }
  static geometry_msgs::msg::Point Point(double x, double y, double z) {
    geometry_msgs::msg::Point point;
    point.x(x);
    point.y(y);
    point.z(z);
    return point;
  }
  /// Reports that the robot stands, whatever path it was given, until `done`.
  bool StandUntil(const std::function<bool()>& done) {
    return Until([&] {
      if (path_) motion_out_.Write(Standing(path_->stamp));
      return done();
    });
  }

  dds::Bus bus_{BusOptionsForTest("test")};
  dds::Bus::Publisher<topics::MapUpdates> updates_out_ = bus_.Advertise<topics::MapUpdates>();
  dds::Bus::Publisher<topics::Odometry> odometry_out_ = bus_.Advertise<topics::Odometry>();
  dds::Bus::Publisher<topics::MotionStatus> motion_out_ = bus_.Advertise<topics::MotionStatus>();
  dds::Bus::Publisher<topics::OperatorCommands> commands_out_ = bus_.Advertise<topics::OperatorCommands>();
  std::vector<thalweg_msgs::msg::CommandReply> replies_;
  std::uint64_t command_id_ = 0;
  OccupancyGrid grid_{0.1};
  dds::MapLog log_{dds::MapLog::MakeSession(), 0.1};
  bool answers_ = true;
  bool publishes_pose_ = true;
  int requests_ = 0;
  std::optional<thalweg_msgs::msg::MapRequest> request_;
  std::optional<dds::StampedPath> path_;
  std::optional<thalweg_msgs::msg::ExplorationStatus> status_;
  std::optional<thalweg_msgs::msg::ServiceHealth> health_;
};

TEST_F(ExplorerServiceTest, ContinuesAnExplorationOfItsOwnPlaceOnly) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / fmt::format("exploration-{}.json", getpid());
  const SavedExploration paused = {.place = "here",
                                   .paused = PauseCause{PauseReason::kOperator},
                                   .strategy = std::string(test::GoingOptions().strategy.name)};
  WriteFile(file, EncodeExploration(paused));
  {
    const RunningExplorer explorer(test::GoingOptions(), {.path = file, .place = "here"});
    EXPECT_TRUE(Until([&] { return Is(thalweg_msgs::msg::EXPLORATION_PAUSED); }));
  }
  WriteFile(file, EncodeExploration(paused));
  {
    const RunningExplorer explorer(test::GoingOptions(), {.path = file, .place = "elsewhere"});
    EXPECT_TRUE(Until([&] { return path_ && !path_->T_WBs.empty(); }));
  }
  std::filesystem::remove(file);
}

TEST_F(ExplorerServiceTest, AMapAndAPoseGiveAPathAndAStatus) {
  publishes_pose_ = false;
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched() && Is(thalweg_msgs::msg::EXPLORATION_WAITING); }));
  ASSERT_TRUE(Until([&] { return requests_ > 0; }));
  EXPECT_FALSE(path_);
  publishes_pose_ = true;
  ASSERT_TRUE(Until([&] { return path_ && Is(thalweg_msgs::msg::EXPLORATION_MOVING); }));
  ASSERT_GE(path_->T_WBs.size(), 2U);
  EXPECT_LT((path_->T_WBs.front().translation() - kHere.translation()).norm(), 1e-6);
  EXPECT_GT(path_->T_WBs.back().translation().x(), 4.5);
  EXPECT_EQ(status_->strategy(), "closest");
  EXPECT_EQ(status_->plans(), 1U);
  EXPECT_EQ(status_->frontier_voxels_left(), 144U);
  EXPECT_NEAR(status_->target().x(), 6.05, 1e-9);
  // The path is repeated unchanged until there is another one.
  const Time stamp = path_->stamp;
  path_.reset();
  ASSERT_TRUE(Until([&] { return path_.has_value(); }));
  EXPECT_EQ(path_->stamp, stamp);
}

const PinholeCamera kViewCamera = PinholeCamera::FromFieldOfView(80, 60, 1.0);

/// A wall 2 m before kHere, to the right of which another is 4 m away, as its camera sees them.
PointCloud StepBeforeHere() {
  DepthImage depth{kViewCamera.width_px, kViewCamera.height_px, {}};
  for (int v = 0; v < kViewCamera.height_px; ++v) {
    for (int u = 0; u < kViewCamera.width_px; ++u)
      depth.depths.push_back(kViewCamera.RayAtUnitDepth(u, v).x() < 0.15 ? 2.0F : 4.0F);
  }
  return CloudFrom(depth, kViewCamera);
}

TEST_F(ExplorerServiceTest, AStrategyThatGoesByViewsReadsCloudsAndSendsAPath) {
  Explorer::Options options = test::GoingOptions();
  options.strategy = Configure("rift");
  RunningExplorer explorer(options);
  dds::Bus::Publisher<topics::DepthPoints> clouds_out = bus_.Advertise<topics::DepthPoints>();
  ASSERT_TRUE(Until([&] { return Matched() && clouds_out.readers() == 1; }));
  ASSERT_TRUE(Until([&] { return status_ && status_->activity().starts_with("waiting for a view"); }));
  EXPECT_FALSE(path_);
  PointCloud line = StepBeforeHere();
  line.width_px *= line.height_px;
  line.height_px = 1;
  clouds_out.Write(dds::ToIdl(bus_.Now(), line));
  ASSERT_TRUE(Until([&] { return health_ && !health_->rejected().empty(); }));
  EXPECT_THAT(health_->rejected()[0].last(), testing::HasSubstr("is not organized"));
  EXPECT_FALSE(path_);
  bus_.Every(50ms, [&] { clouds_out.Write(dds::ToIdl(bus_.Now(), StepBeforeHere())); });
  ASSERT_TRUE(Until([&] { return path_ && Is(thalweg_msgs::msg::EXPLORATION_MOVING); }));
  EXPECT_THAT(status_->activity(), testing::HasSubstr("to look at the surface"));
  ASSERT_GE(path_->T_WBs.size(), 2U);
  // 1 m before the wall
  EXPECT_NEAR(path_->T_WBs.back().translation().x(), kHere.translation().x() + 1.0, 0.02);
}

TEST_F(ExplorerServiceTest, AStrategyThatGoesByViewsReadsDepthImagesWhereTheSensorSendsThem) {
  Explorer::Options options = test::GoingOptions();
  options.strategy = Configure("rift");
  RunningExplorer explorer(options, {}, ExplorerService::ViewSource::kDepthImages);
  dds::Bus::Publisher<topics::DepthPoints> clouds_out = bus_.Advertise<topics::DepthPoints>();
  dds::Bus::Publisher<topics::DepthImage> images_out = bus_.Advertise<topics::DepthImage>();
  dds::Bus::Publisher<topics::DepthCameraInfo> cameras_out = bus_.Advertise<topics::DepthCameraInfo>();
  ASSERT_TRUE(Until([&] { return Matched() && images_out.readers() == 1 && cameras_out.readers() == 1; }));
  EXPECT_EQ(clouds_out.readers(), 0);
  bus_.Every(50ms, [&] {
    const Time now = bus_.Now();
    images_out.Write(thalweg::test::DepthMessage(now, StepBeforeHere()));
    cameras_out.Write(dds::ToIdl(now, kViewCamera, 0.0));
  });
  ASSERT_TRUE(Until([&] { return path_ && Is(thalweg_msgs::msg::EXPLORATION_MOVING); }));
  ASSERT_GE(path_->T_WBs.size(), 2U);
  EXPECT_NEAR(path_->T_WBs.back().translation().x(), kHere.translation().x() + 1.0, 0.02);
}

TEST_F(ExplorerServiceTest, AStrategyThatGoesByViewsIsForThoseWhoBeganSo) {
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return path_.has_value(); }));
  dds::Bus::Publisher<topics::DepthPoints> clouds_out = bus_.Advertise<topics::DepthPoints>();
  thalweg_msgs::msg::OperatorCommand command;
  command.kind(thalweg_msgs::msg::COMMAND_STRATEGY);
  command.strategy("rift");
  const thalweg_msgs::msg::CommandReply reply = Send(command);
  EXPECT_FALSE(reply.accepted());
  EXPECT_THAT(reply.reason(), testing::HasSubstr("goes by views of the camera"));
  EXPECT_EQ(clouds_out.readers(), 0) << "nobody carries clouds to who does not need them";
}

TEST_F(ExplorerServiceTest, ReportsWhatItsPlanWasChosenFrom) {
  std::optional<thalweg_msgs::msg::FrontierList> frontiers;
  std::optional<dds::StampedPath> streamline;
  std::optional<sensor_msgs::msg::PointCloud2> field;
  bus_.Subscribe<topics::Frontiers>([&](const auto& message) { frontiers = message; });
  bus_.Subscribe<topics::Streamline>([&](const auto& message) { streamline = *dds::FromIdl(message); });
  std::optional<sensor_msgs::msg::PointCloud2> sealed;
  bus_.Subscribe<topics::Field>([&](const auto& message) { field = message; });
  bus_.Subscribe<topics::Sealed>([&](const auto& message) { sealed = message; });
  Explorer::Options options = test::GoingOptions();
  options.strategy = Configure("potential_flux");
  publishes_pose_ = false;
  RunningExplorer explorer(options);
  ASSERT_TRUE(Until([&] {
    return Matched() && bus_.Writers<topics::Field>() == 1 && bus_.Writers<topics::Sealed>() == 1;
  }));
  publishes_pose_ = true;
  ASSERT_TRUE(Until([&] { return frontiers && streamline && field && sealed && path_; }));

  EXPECT_EQ(frontiers->strategy(), "potential_flux");
  ASSERT_FALSE(frontiers->frontiers().empty());
  int chosen = 0;
  std::size_t voxels = 0;
  double best = 0.0;
  for (const auto& frontier : frontiers->frontiers()) best = std::max(best, frontier.score());
  for (const auto& frontier : frontiers->frontiers()) {
    EXPECT_NEAR(frontier.center().x(), 6.05, 1e-6) << "the far end";
    EXPECT_GT(frontier.path_length_m(), 4.0);
    EXPECT_EQ(frontier.reason(), thalweg_msgs::msg::ASIDE_NONE);
    voxels += frontier.voxels();
    if (frontier.fate() != thalweg_msgs::msg::FRONTIER_CHOSEN) continue;
    ++chosen;
    EXPECT_EQ(frontier.score(), best);
  }
  EXPECT_EQ(chosen, 1);
  EXPECT_EQ(voxels, 144U);

  ASSERT_GE(streamline->T_WBs.size(), 2U);
  EXPECT_LT((streamline->T_WBs.front().translation() - kHere.translation()).norm(), 1e-6);
  EXPECT_GE(streamline->T_WBs.back().translation().x(), path_->T_WBs.back().translation().x() - 1e-9);

  ASSERT_EQ(field->fields().size(), 4U);
  EXPECT_EQ(field->fields()[3].name(), "intensity");
  ASSERT_EQ(field->data().size(), std::size_t{field->width()} * field->point_step());
  const auto value = [&](std::size_t point, std::size_t axis) {
    float number = 0.0F;
    std::memcpy(&number, field->data().data() + point * field->point_step() + axis * sizeof number,
                sizeof number);
    return number;
  };
  float nearest = 10.0F;  // [m]
  float there = 0.0F;
  for (std::size_t k = 0; k < field->width(); ++k) {
    ASSERT_LE(std::abs(value(k, 3)), 1.0F + 1e-5F);
    const Eigen::Vector3f p_W(value(k, 0), value(k, 1), value(k, 2));
    const float distance = (p_W - kHere.translation().cast<float>()).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    there = value(k, 3);
  }
  EXPECT_LT(nearest, 0.1F);
  EXPECT_EQ(there, 1.0F) << "the robot is the source";
}

TEST_F(ExplorerServiceTest, AMissingUpdateIsAskedFor) {
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched() && path_; }));
  answers_ = false;
  requests_ = 0;
  Update({});  // never sent
  updates_out_.Write(Update(test::FarWall()));
  ASSERT_TRUE(Until([&] { return requests_ > 0; }));
  EXPECT_EQ(request_->reader(), "explorer");
  EXPECT_EQ(request_->session(), log_.session());
  EXPECT_EQ(request_->number(), 0U);
  EXPECT_FALSE(request_->reason().empty());
  answers_ = true;
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::EXPLORATION_DONE); }));
  EXPECT_EQ(status_->stop_reason(), "complete");
}

TEST_F(ExplorerServiceTest, AnObstacleOnThePathStopsTheRobotAndThenLeadsAroundIt) {
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched() && path_ && !path_->T_WBs.empty(); }));
  const Time first = path_->stamp;
  updates_out_.Write(Update(test::ObstacleAt(test::PointAlong(path_->T_WBs, 0.5))));
  ASSERT_TRUE(Until([&] { return path_->T_WBs.empty(); })) << "an empty path is a stop";
  const Time stop = path_->stamp;
  EXPECT_GT(stop, first);
  ASSERT_TRUE(Until([&] {
    motion_out_.Write(Standing(stop));
    return !path_->T_WBs.empty();
  }));
  EXPECT_GT(path_->stamp, stop);
  ASSERT_TRUE(Until([&] { return status_->replans() == 1U && status_->plans() == 2U; }));
}

TEST_F(ExplorerServiceTest, PauseStopsTheRobotWithinASecondAndResumeSendsItOn) {
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched() && path_ && !path_->T_WBs.empty(); }));
  const auto sent = std::chrono::steady_clock::now();
  const auto paused = Send(thalweg_msgs::msg::COMMAND_PAUSE);
  EXPECT_TRUE(paused.accepted()) << paused.reason();
  ASSERT_TRUE(Until([&] { return path_->T_WBs.empty(); })) << "an empty path is a stop";
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - sent;
  RecordProperty("pause_s", std::to_string(took.count()));
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::EXPLORATION_PAUSED); }));
  EXPECT_EQ(status_->activity(), "paused: by the operator");
  ASSERT_TRUE(StandUntil([&] { return path_->T_WBs.empty(); }));
  const auto resumed = Send(thalweg_msgs::msg::COMMAND_RESUME);
  EXPECT_TRUE(resumed.accepted()) << resumed.reason();
  ASSERT_TRUE(StandUntil([&] { return !path_->T_WBs.empty(); }));
  ASSERT_TRUE(Until([&] { return Is(thalweg_msgs::msg::EXPLORATION_MOVING); }));
}

TEST_F(ExplorerServiceTest, GoToAndNoGoBoxesAreObeyedAndTheirRefusalsHaveReasons) {
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched() && path_ && !path_->T_WBs.empty(); }));
  thalweg_msgs::msg::OperatorCommand box;
  box.kind(thalweg_msgs::msg::COMMAND_NO_GO_BOX);
  box.point(Point(3.0, 0.0, 0.0));
  box.corner(Point(3.5, 0.5, 1.2));
  EXPECT_TRUE(Send(box).accepted());
  ASSERT_TRUE(Until([&] { return status_ && status_->no_go().size() == 1; }));
  EXPECT_EQ(status_->no_go()[0].min(), Point(3.0, 0.0, 0.0));
  EXPECT_EQ(status_->no_go()[0].max(), Point(3.5, 0.5, 1.2));

  thalweg_msgs::msg::OperatorCommand go;
  go.kind(thalweg_msgs::msg::COMMAND_GOTO);
  go.yaw_rad(std::numeric_limits<double>::quiet_NaN());
  go.point(Point(3.25, 0.25, 0.6));
  const auto refused = Send(go);
  EXPECT_FALSE(refused.accepted());
  EXPECT_THAT(refused.reason(), testing::HasSubstr("in a no-go box"));
  go.point(Point(20.0, 0.0, 0.0));
  EXPECT_THAT(Send(go).reason(), testing::HasSubstr("not known yet"));

  go.point(Point(2.0, 0.65, 0.65));
  const auto accepted = Send(go);
  EXPECT_TRUE(accepted.accepted()) << accepted.reason();
  const Eigen::Vector3d goal_W(2.0, 0.65, 0.65);
  ASSERT_TRUE(StandUntil(
      [&] { return !path_->T_WBs.empty() && (path_->T_WBs.back().translation() - goal_W).norm() < 0.1; }));
  EXPECT_TRUE(Until([&] { return status_->activity().find("as commanded") != std::string::npos; }));
  EXPECT_TRUE(Send(thalweg_msgs::msg::COMMAND_CLEAR_NO_GO).accepted());
  ASSERT_TRUE(Until([&] { return status_->no_go().empty(); }));
}

TEST_F(ExplorerServiceTest, ACommandThatIsSentAgainIsAnsweredAgainButCarriedOutOnce) {
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched() && path_ && !path_->T_WBs.empty(); }));
  thalweg_msgs::msg::OperatorCommand box;
  box.kind(thalweg_msgs::msg::COMMAND_NO_GO_BOX);
  box.point(Point(3.0, 0.0, 0.0));
  box.corner(Point(3.5, 0.2, 0.2));
  EXPECT_TRUE(Send(box).accepted());
  --command_id_;  // the same command
  EXPECT_TRUE(Send(box).accepted());
  EXPECT_EQ(replies_[0].reason(), replies_[1].reason());
  ASSERT_TRUE(Until([&] { return status_ && !status_->no_go().empty(); }));
  EXPECT_EQ(status_->no_go().size(), 1U);
}

TEST_F(ExplorerServiceTest, ACommandThatMakesNoSenseIsRefusedAndCounted) {
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched() && path_ && !path_->T_WBs.empty(); }));
  thalweg_msgs::msg::OperatorCommand go;
  go.kind(thalweg_msgs::msg::COMMAND_GOTO);
  go.point(Point(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0));
  const auto reply = Send(go);
  EXPECT_FALSE(reply.accepted());
  EXPECT_THAT(reply.reason(), testing::HasSubstr("point.x"));
  ASSERT_TRUE(Until([&] { return health_ && !health_->rejected().empty(); }));
  EXPECT_THAT(health_->rejected()[0].last(), testing::HasSubstr("point.x"));
  EXPECT_FALSE(path_->T_WBs.empty()) << "the robot goes on";
}

TEST_F(ExplorerServiceTest, MessagesThatLieAreRefusedAndCounted) {
  publishes_pose_ = false;
  answers_ = false;
  RunningExplorer explorer;
  ASSERT_TRUE(Until([&] { return Matched(); }));
  thalweg_msgs::msg::MapUpdate map = log_.FullCopy(grid_);
  map.voxel_size_m(std::numeric_limits<double>::quiet_NaN());
  updates_out_.Write(map);
  map = log_.FullCopy(grid_);
  map.blocks().front().log_odds().pop_back();
  updates_out_.Write(map);
  nav_msgs::msg::Odometry nowhere = Odometry();
  nowhere.pose().pose().position().y(std::numeric_limits<double>::quiet_NaN());
  bus_.Every(50ms, [&] {
    if (!publishes_pose_) odometry_out_.Write(nowhere);  // best effort: a single message may be lost
  });
  thalweg_msgs::msg::MotionStatus never = Standing(bus_.Now());
  never.path_stamp().nanosec(2000000000U);
  motion_out_.Write(never);
  thalweg_msgs::msg::MotionStatus backwards = Standing(bus_.Now());
  backwards.speed_mps(-1.0);
  motion_out_.Write(backwards);
  const auto rejected = [&] {
    unsigned long long count = 0;
    if (health_) {
      for (const thalweg_msgs::msg::Counter& counter : health_->rejected()) count += counter.count();
    }
    return count;
  };
  const auto says_speed = [](const thalweg_msgs::msg::Counter& counter) {
    return counter.last().find("speed_mps is -1") != std::string::npos;
  };
  ASSERT_TRUE(Until([&] {
    return rejected() >= 4 && health_->rejected().size() == 3 &&
           std::ranges::any_of(health_->rejected(), says_speed);
  })) << rejected()
      << " were refused";
  EXPECT_FALSE(path_);
  EXPECT_TRUE(Is(thalweg_msgs::msg::EXPLORATION_WAITING));
  // A valid pose is still accepted afterwards.
  publishes_pose_ = true;
  answers_ = true;
  EXPECT_TRUE(Until([&] { return path_.has_value(); }));
}

}  // namespace
}  // namespace thalweg::explorer
