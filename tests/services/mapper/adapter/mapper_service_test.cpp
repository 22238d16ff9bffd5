#include "services/mapper/adapter/mapper_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <map>
#include <memory>
#include <sstream>

#include "common/dds/map_replica.h"
#include "tests/services/mapper/adapter/example_map.h"
#include "tests/support/test_bus.h"

namespace thalweg::mapper {
namespace {

namespace topics = dds::topics;
using test::AwaitMatch;
using test::BusOptionsForTest;
using test::kPatience;
using test::TestFolder;

Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}

/// The pose of the test's robot, and below what it sees.
RigidTransform PoseAt(double seconds) {
  return MakeTransform(RotationFromYawPitch(0.3 * seconds, 0.0), {-1.5 + 0.2 * seconds, 0.1, 0.0});
}

PointCloud CloudAt(double seconds) {
  const RigidTransform T_WC = PoseAt(seconds) * MapperOptions{}.T_BC;
  PointCloud cloud =
      test::AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(40, 30, 1.3), T_WC);
  cloud.colors.assign(cloud.points_C.size(), Rgb{200, 100, 50});
  return cloud;
}

/// Spins the two buses in turn until `done`.
bool SpinTogether(dds::Bus& a, dds::Bus& b, const std::function<bool()>& done) {
  constexpr auto kTurn = std::chrono::milliseconds(5);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!b.SpinUntil(done, kTurn)) {
    if (std::chrono::steady_clock::now() > end) return false;
    a.SpinUntil([] { return false; }, kTurn);
  }
  return true;
}

/// A reader of the map, as the explorer is one.
class Listener {
 public:
  Listener() : bus_(BusOptionsForTest("listener")), requests_(bus_.Advertise<topics::MapRequests>()) {
    bus_.Subscribe<topics::MapUpdates>([this](const thalweg_msgs::msg::MapUpdate& update) {
      full_copies_ += update.full() ? 1 : 0;
      scans_.insert(scans_.end(), update.scans().begin(), update.scans().end());
      EXPECT_TRUE(replica_.Apply(update));
      RequestWhatIsMissing();
    });
    // A request may be sent before the mapper listens, so it is repeated, as real readers do.
    bus_.EveryWall(std::chrono::milliseconds(200), [this] { RequestWhatIsMissing(); });
  }

  void RequestWhatIsMissing() {
    if (replica_.missing()) requests_.Write(replica_.MakeRequest(bus_.Now(), "listener"));
  }
  /// Spins both until the listener has the map under `number` or a later one, of a session other than
  /// `session_before`.
  bool Follow(dds::Bus& mapper_bus, std::uint64_t session_before, std::uint64_t number) {
    return SpinTogether(mapper_bus, bus_, [&] {
      return !replica_.missing() && replica_.session() != session_before && replica_.number() >= number;
    });
  }

  dds::Bus& bus() { return bus_; }
  const dds::Bus::Publisher<topics::MapRequests>& requests() const { return requests_; }
  const dds::MapReplica& replica() const { return replica_; }
  int full_copies() const { return full_copies_; }
  const std::vector<thalweg_msgs::msg::ScanView>& scans() const { return scans_; }

 private:
  dds::Bus bus_;
  dds::Bus::Publisher<topics::MapRequests> requests_;
  dds::MapReplica replica_;
  int full_copies_ = 0;
  std::vector<thalweg_msgs::msg::ScanView> scans_;
};

class MapperServiceTest : public testing::Test {
 protected:
  MapperServiceTest()
      : robot_(BusOptionsForTest("robot")),
        odometry_(robot_.Advertise<topics::Odometry>()),
        points_(robot_.Advertise<topics::DepthPoints>()) {
    options_.out = folder_.path();
    options_.checkpoint_period = std::chrono::hours(1);
    options_.snapshot_period = std::chrono::hours(1);
    options_.full_copy_period = std::chrono::milliseconds(20);
  }

  void Start() {
    mapper_.reset();
    bus_.emplace(BusOptionsForTest("mapper"));
    mapper_.emplace(options_, *bus_);
    AwaitMatch(robot_, odometry_, *bus_);
    AwaitMatch(robot_, points_, *bus_);
  }
  /// Stops the mapper as kill -9 does: without Save().
  void Kill() {
    mapper_.reset();
    bus_.reset();
  }

  void SendPose(double seconds) {
    odometry_.Write(dds::OdometryToIdl(At(seconds), PoseAt(seconds), {0, 0, 0}, {0, 0, 0}));
  }
  void SendCloud(double seconds) { points_.Write(dds::ToIdl(At(seconds), CloudAt(seconds))); }

  bool SpinUntil(const std::function<bool()>& done) { return bus_->SpinUntil(done, kPatience); }
  unsigned long long Scans() { return mapper_->updates(); }
  unsigned long long Dropped() { return bus_->health().dropped(); }
  unsigned long long Rejected() { return bus_->health().rejected(); }

  /// Sends a cloud and its pose and waits until the cloud is in the map.
  void Scan(double seconds) {
    const auto before = Scans();
    SendPose(seconds);
    SendCloud(seconds);
    ASSERT_TRUE(SpinUntil([&] { return Scans() == before + 1; })) << seconds;
  }
  void Connect(Listener& listener) {
    ASSERT_TRUE(listener.bus().SpinUntil([&] { return listener.bus().Writers<topics::MapUpdates>() > 0; },
                                         kPatience));
    AwaitMatch(listener.bus(), listener.requests(), *bus_);
    ASSERT_TRUE(SpinUntil([&] { return mapper_->listeners() > 0; }));
    listener.RequestWhatIsMissing();
  }

  TestFolder folder_;
  MapperOptions options_;
  dds::Bus robot_;
  dds::Bus::Publisher<topics::Odometry> odometry_;
  dds::Bus::Publisher<topics::DepthPoints> points_;
  std::optional<dds::Bus> bus_;
  std::optional<MapperService> mapper_;
};

TEST_F(MapperServiceTest, CloudAndOdometryInGiveAnUpdateOut) {
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
      test::AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(40, 30, 1.3), T_WC);
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

TEST_F(MapperServiceTest, AnUpdateComesEvenWhenNothingChanged) {
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

TEST_F(MapperServiceTest, CloudWaitsUntilOdometryReachesItsStamp) {
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

TEST_F(MapperServiceTest, CloudsThatNoPoseFitsAreDroppedAndCounted) {
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

TEST_F(MapperServiceTest, CloudsThatWaitForeverAreDroppedOldestFirst) {
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

TEST_F(MapperServiceTest, MessagesThatLieAreRejectedAndCounted) {
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

TEST_F(MapperServiceTest, TheSameCloudTwiceIsTakenOnce) {
  Start();
  Scan(1.0);
  SendCloud(1.0);
  ASSERT_TRUE(SpinUntil([&] { return Dropped() == 1; }));
  EXPECT_EQ(Scans(), 1u);
}

TEST_F(MapperServiceTest, GoesOnWhenTheSimulatorsTimeBeginsAnew) {
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

TEST_F(MapperServiceTest, AListenerThatJoinsLateEndsWithTheSameMap) {
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

TEST_F(MapperServiceTest, FullCopiesAreRateLimited) {
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

TEST_F(MapperServiceTest, AfterAKillItGoesOnFromItsCheckpointInANewSession) {
  options_.checkpoint_period = std::chrono::milliseconds(10);
  Start();
  for (int i = 1; i <= 3; ++i) Scan(0.5 * i);
  const OccupancyGrid before = CopyOf(mapper_->grid());
  const auto written = [&] {
    const auto loaded = LoadCheckpoint(folder_.path() / MapperService::kCheckpointFile);
    return loaded && loaded->has_value() && (*loaded)->grid.SameAs(before);
  };
  ASSERT_TRUE(SpinUntil(written));
  Kill();
  Start();
  EXPECT_TRUE(mapper_->grid().SameAs(before));
  Listener listener;
  Connect(listener);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 0));
  const std::uint64_t session = listener.replica().session();
  EXPECT_TRUE(listener.replica().grid().SameAs(before));
  Kill();
  Start();
  Connect(listener);
  Scan(2.0);
  ASSERT_TRUE(listener.Follow(*bus_, session, 1)) << "the listener notices the restart";
  EXPECT_TRUE(listener.replica().grid().SameAs(mapper_->grid()));
}

/// Collects the log in memory until destroyed.
class LogText {
 public:
  LogText() {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
  }
  ~LogText() { spdlog::set_default_logger(before_); }
  LogText(const LogText&) = delete;
  LogText& operator=(const LogText&) = delete;
  std::string Text() const { return text_.str(); }
  int Count(const std::string& part) const {
    const std::string text = text_.str();
    int count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
  }

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::ostringstream text_;
};

TEST_F(MapperServiceTest, AfterAKillNoScanButTheLastIsMissing) {
  Start();
  std::vector<OccupancyGrid> states;
  for (int i = 1; i <= 5; ++i) {
    Scan(0.5 * i);
    states.push_back(CopyOf(mapper_->grid()));
    const auto stored = LoadStoredMap(folder_.path() / MapperService::kCheckpointFile);
    ASSERT_TRUE(stored) << stored.error();
    const std::uint64_t number = stored->has_value() ? (*stored)->checkpoint.position.number : 0;
    EXPECT_GE(number + 1, states.size());
    if (number > 0) {
      EXPECT_TRUE((*stored)->checkpoint.grid.SameAs(states.at(number - 1)));
    }
  }
}

TEST_F(MapperServiceTest, FilesThatCannotBeWrittenStayWholeAreToldOnceAndTriedAgain) {
  options_.checkpoint_period = std::chrono::milliseconds(10);
  const auto file = folder_.path() / MapperService::kCheckpointFile;
  const auto in_the_way = folder_.path() / (std::string(MapperService::kCheckpointFile) + ".unfinished");
  const LogText log;
  Start();
  Scan(1.0);
  const OccupancyGrid before = CopyOf(mapper_->grid());
  const auto stored = [&] {
    auto loaded = LoadCheckpoint(file);
    return loaded && loaded->has_value() ? *std::move(loaded) : std::nullopt;
  };
  ASSERT_TRUE(SpinUntil([&] { return stored() && stored()->position.number == 1; }));
  // Without its journal the map needs a new checkpoint, which cannot be written either.
  std::filesystem::create_directories(in_the_way);
  std::filesystem::remove(JournalOf(file));
  ASSERT_TRUE(SpinUntil([&] { return Dropped() >= 4; })) << Dropped() << log.Text();  // attempts
  Scan(2.0);
  const auto counters = bus_->health().ToMessage(Time{}).dropped();
  ASSERT_EQ(counters.size(), 1U);
  EXPECT_EQ(counters[0].name(), dds::Health::kFiles);
  EXPECT_THAT(counters[0].last(), testing::HasSubstr(MapperService::kCheckpointFile));
  EXPECT_EQ(log.Count("what is on disk stays whole"), 1);
  ASSERT_TRUE(stored());
  EXPECT_EQ(stored()->position.number, 0U) << "the checkpoint from before is whole";
  std::filesystem::remove(in_the_way);
  ASSERT_TRUE(SpinUntil([&] { return log.Count("can be written again") == 1; }));
  ASSERT_TRUE(stored());
  EXPECT_EQ(stored()->position.number, 2U);
  EXPECT_TRUE(stored()->grid.SameAs(mapper_->grid()));
  EXPECT_THAT(bus_->health().ToMessage(Time{}).dropped()[0].last(), testing::HasSubstr("again"));
}

TEST_F(MapperServiceTest, ResumesBeforeATornScanAndSaysWhatItCutOff) {
  Start();
  Scan(1.0);
  const OccupancyGrid first = CopyOf(mapper_->grid());
  Scan(2.0);
  Kill();
  const auto journal = JournalOf(folder_.path() / MapperService::kCheckpointFile);
  std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 1);
  const LogText log;
  Start();
  EXPECT_TRUE(mapper_->grid().SameAs(first));
  EXPECT_EQ(log.Count("the record after scan 1 is cut off; 1 scans before it are used"), 1);
  EXPECT_EQ(log.Count("after 1 scans, 1 of them from its journal"), 1);
  Scan(3.0);
}

TEST_F(MapperServiceTest, RefusesACheckpointOfAnotherPlaceBeforeItChangesIt) {
  Start();
  for (int i = 1; i <= 6; ++i) Scan(0.5 * i);
  mapper_->Save();
  Kill();
  const auto file = folder_.path() / MapperService::kCheckpointFile;
  const auto before = LoadStoredMap(file);
  Start();
  // The same pose, and a wall across the room a meter ahead.
  PointCloud wall = CloudAt(1.5);
  for (Eigen::Vector3f& p_C : wall.points_C) p_C *= 1.0F / p_C.z();
  odometry_.Write(dds::OdometryToIdl(At(10.5), PoseAt(1.5), {0, 0, 0}, {0, 0, 0}));
  points_.Write(dds::ToIdl(At(10.5), wall));
  try {
    SpinUntil([&] { return Scans() == 1; });
    FAIL() << "it was fused";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("checkpoint.map is of another place"),
                                             testing::HasSubstr("choose another --out or remove the file")));
  }
  Kill();
  const auto after = LoadStoredMap(file);
  ASSERT_TRUE(before && after && before->has_value() && after->has_value());
  EXPECT_EQ((*after)->checkpoint.position, (*before)->checkpoint.position);
  EXPECT_TRUE((*after)->checkpoint.grid.SameAs((*before)->checkpoint.grid));
}

TEST_F(MapperServiceTest, SaveWritesWhatItCanAndNamesTheRest) {
  Start();
  Scan(1.0);
  std::filesystem::create_directories(folder_.path() / "map.bt");  // in the way of the file
  try {
    mapper_->Save();
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), (folder_.path() / "map.bt").string() + ": cannot be written: Is a directory");
  }
  for (const char* name : {"checkpoint.map", "map.ot", "map.ply"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_.path() / name)) << name;
  }
}

TEST_F(MapperServiceTest, StartsEmptyFromACheckpointThatIsGarbledAndKeepsIt) {
  std::ofstream(folder_.path() / MapperService::kCheckpointFile) << "THALWEG1 and then nonsense";
  Start();
  EXPECT_EQ(mapper_->grid().block_count(), 0u);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "checkpoint.map.unused"));
  Scan(1.0);
}

TEST_F(MapperServiceTest, RefusesACheckpointOfAnotherVoxelSize) {
  Start();
  Scan(1.0);
  mapper_->Save();
  Kill();
  options_.map.voxel_size = 0.05;
  dds::Bus bus(BusOptionsForTest("mapper"));
  try {
    MapperService mapper(options_, bus);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr(MapperService::kCheckpointFile),
                                             testing::HasSubstr("0.1"), testing::HasSubstr("0.05")));
  }
  options_.checkpoint_period = Duration::zero();
  EXPECT_NO_THROW(MapperService(options_, bus)) << "without checkpoints there is none to refuse";
}

TEST_F(MapperServiceTest, SaveLeavesTheMapAsFiles) {
  Start();
  Scan(1.0);
  mapper_->Save();
  octomap::OcTree tree((folder_.path() / "map.bt").string());
  EXPECT_GT(tree.size(), 100u);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "map.ot"));
  EXPECT_GT(std::filesystem::file_size(folder_.path() / "map.ply"), 1000u);
}

TEST_F(MapperServiceTest, AnOperatorsCommandSavesTheMapOnceAndIsAnsweredWhenItIsOnDisk) {
  Start();
  dds::Bus operator_bus(BusOptionsForTest("operator"));
  const auto commands = operator_bus.Advertise<topics::OperatorCommands>();
  std::map<std::uint32_t, std::vector<thalweg_msgs::msg::CommandReply>> replies;  // by id
  bool on_disk = false;  // when command 3 was answered
  operator_bus.Subscribe<topics::CommandReplies>([&](const auto& reply) {
    if (reply.id() == 3 && replies[3].empty()) on_disk = std::filesystem::exists(folder_.path() / "map.ply");
    replies[reply.id()].push_back(reply);
  });
  Scan(1.0);
  thalweg_msgs::msg::OperatorCommand command;
  command.header(dds::MakeHeader(At(1.0), dds::kMapFrame));
  command.sender("test");
  const auto send = [&](std::uint32_t id, thalweg_msgs::msg::CommandKind kind) {
    command.id(id);
    command.kind(kind);
    commands.Write(command);
  };
  // Until both directions have matched, a sender repeats its command.
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] {
    send(1, thalweg_msgs::msg::COMMAND_SAVE_MAP);
    return !replies[1].empty();
  }));
  std::filesystem::remove(folder_.path() / "map.ply");
  send(2, thalweg_msgs::msg::COMMAND_PAUSE);  // for the explorer
  send(3, thalweg_msgs::msg::COMMAND_SAVE_MAP);
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] { return replies[3].size() == 1; }));
  EXPECT_TRUE(on_disk);
  EXPECT_TRUE(replies[2].empty());
  EXPECT_EQ(replies[3][0].service(), "mapper");
  EXPECT_TRUE(replies[3][0].accepted()) << replies[3][0].reason();
  octomap::OcTree tree(1.0);
  ASSERT_TRUE(tree.readBinary((folder_.path() / "map.bt").string()));
  EXPECT_GT(tree.getNumLeafNodes(), 100U);
  std::filesystem::remove(folder_.path() / "map.ply");
  commands.Write(command);
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] { return replies[3].size() == 2; }));
  EXPECT_EQ(replies[3][1].reason(), replies[3][0].reason());
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "map.ply")) << "it was not saved again";
}

TEST_F(MapperServiceTest, CommandsToSaveThatComeTogetherAreAllAnswered) {
  Start();
  dds::Bus operator_bus(BusOptionsForTest("operator"));
  const auto commands = operator_bus.Advertise<topics::OperatorCommands>();
  std::map<std::uint32_t, bool> accepted;  // by id
  std::string refusal;
  operator_bus.Subscribe<topics::CommandReplies>([&](const auto& reply) {
    accepted[reply.id()] = reply.accepted();
    if (!reply.accepted()) refusal = reply.reason();
  });
  Scan(1.0);
  thalweg_msgs::msg::OperatorCommand command;
  command.header(dds::MakeHeader(At(1.0), dds::kMapFrame));
  command.sender("test");
  command.kind(thalweg_msgs::msg::COMMAND_SAVE_MAP);
  command.id(1);
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] {
    commands.Write(command);
    return accepted.contains(1);
  }));
  constexpr std::uint32_t kMany = 60;
  for (std::uint32_t id = 2; id < 2 + kMany; ++id) {
    command.id(id);
    commands.Write(command);
  }
  ASSERT_TRUE(SpinTogether(*bus_, operator_bus, [&] { return accepted.size() == 1 + kMany; }));
  EXPECT_TRUE(accepted[2]);
  if (!refusal.empty()) {
    EXPECT_EQ(refusal, "too many wait for the map to be saved");
  }
}

/// The depths of a cloud of the test, as 32FC1.
sensor_msgs::msg::Image DepthImageAt(double seconds) {
  const PointCloud cloud = CloudAt(seconds);
  sensor_msgs::msg::Image message;
  message.header(dds::MakeHeader(At(seconds), dds::kCameraFrame));
  message.width(static_cast<std::uint32_t>(cloud.width_px));
  message.height(static_cast<std::uint32_t>(cloud.height_px));
  message.encoding("32FC1");
  message.step(message.width() * sizeof(float));
  for (const Eigen::Vector3f& p_C : cloud.points_C) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&p_C.z());
    message.data().insert(message.data().end(), bytes, bytes + sizeof(float));
  }
  return message;
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

TEST_F(DepthImageTest, WithItsCalibrationGivesTheMapOfTheCloud) {
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
  // Points of the image are the cloud's but for the last digits, which decide a few voxels.
  std::size_t known = 0;
  std::size_t same = 0;
  from_cloud.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    ++known;
    same += mapper_->grid().State(voxel) == OccupancyGrid::StateOf(log_odds) ? 1 : 0;
  });
  EXPECT_GT(known, 1000U);
  EXPECT_GE(static_cast<double>(same), 0.999 * static_cast<double>(known));
}

TEST_F(DepthImageTest, IsPairedWithTheCalibrationOfItsStampInAnyOrder) {
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

TEST_F(DepthImageTest, OfAnotherSizeThanItsCalibrationIsRejected) {
  StartWithImages();
  SendPose(1.0);
  SendCamera(1.0, PinholeCamera::FromFieldOfView(80, 60, 1.3));
  images_.Write(DepthImageAt(1.0));
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 1; }));
  EXPECT_EQ(Scans(), 0U);
}

TEST_F(MapperServiceTest, SaysInTfStaticWhereWhatDoesNotMoveIsAlsoToThoseWhoJoinLate) {
  Start();
  dds::Bus late(BusOptionsForTest("rviz2"));
  std::optional<tf2_msgs::msg::TFMessage> heard;
  late.Subscribe<topics::StaticTransforms>([&](const auto& message) { heard = message; });
  ASSERT_TRUE(SpinTogether(*bus_, late, [&] { return heard.has_value(); }));
  ASSERT_EQ(heard->transforms().size(), 2U);
  EXPECT_EQ(heard->transforms()[0].child_frame_id(), dds::kOdometryFrame);
  EXPECT_EQ(heard->transforms()[1].child_frame_id(), dds::kCameraFrame);
}

TEST_F(MapperServiceTest, PublishesOccupiedVoxelsAsPointsOnlyWhileSomebodyListens) {
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

TEST_F(MapperServiceTest, PublishesAnOctomapForToolsThatListen) {
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

/// Rays without a return only, encoded as drivers of depth cameras do: infinite depth.
sensor_msgs::msg::PointCloud2 NoReturns(double seconds, int width_px, int height_px) {
  const auto pixels = static_cast<std::size_t>(width_px * height_px);
  return dds::ToIdl(At(seconds), PointCloud{.width_px = width_px,
                                            .height_px = height_px,
                                            .points_C = std::vector<Eigen::Vector3f>(pixels, NoReturn()),
                                            .colors = {}});
}

TEST_F(MapperServiceTest, RaysWithoutReturnClearSpaceOnlyWhereTheScenarioSaysSo) {
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

TEST_F(MapperServiceTest, RaysWithoutReturnOfUnknownDirectionsAreCountedAndClearNothing) {
  options_.map.no_return = PinholeCamera::FromFieldOfView(40, 30, 1.3);
  Start();
  SendPose(1.0);
  points_.Write(NoReturns(1.0, 20, 16));
  ASSERT_TRUE(SpinUntil([&] { return Scans() == 1 && Dropped() == 1; }));
  EXPECT_EQ(mapper_->grid().block_count(), 0u);
  Scan(1.5);
  EXPECT_EQ(Dropped(), 1u) << "a cloud without such rays may have any size";
}

TEST(MapperOptions, ASensorThatTellsWhereNothingIsClearsNoFartherThanItsRange) {
  Scenario scenario;
  EXPECT_FALSE(OptionsFrom(scenario, "x").map.no_return);
  scenario.mutable_depth_sensor()->set_max_range_m(1.5);
  scenario.mutable_depth_sensor()->set_width_px(64);
  EXPECT_EQ(OptionsFrom(scenario, "x").map.max_range, OccupancyMap::Options().max_range);
  scenario.mutable_depth_sensor()->set_no_return_is_free(true);
  const OccupancyMap::Options options = OptionsFrom(scenario, "x").map;
  EXPECT_EQ(options.max_range, 1.5);
  ASSERT_TRUE(options.no_return);
  EXPECT_EQ(options.no_return->width_px, 64);
  scenario.mutable_depth_sensor()->set_max_range_m(50.0);
  EXPECT_EQ(OptionsFrom(scenario, "x").map.max_range, OccupancyMap::Options().max_range);
}

TEST(MapperOptions, ComeFromTheScenarioAndElseFromTheCore) {
  Scenario scenario;
  const OccupancyMap::Options core;
  EXPECT_EQ(OptionsFrom(scenario, "x").map.voxel_size, core.voxel_size);
  EXPECT_EQ(OptionsFrom(scenario, "x").out, "x");
  scenario.mutable_mapper()->set_voxel_size_m(0.07);
  scenario.mutable_mapper()->set_max_range_m(3.0);
  scenario.mutable_mapper()->set_fill(true);
  scenario.mutable_mapper()->set_protect(true);
  scenario.mutable_mapper()->set_checkpoint_period_s(0.0);
  scenario.mutable_mapper()->set_log_odds_hit(0.7);
  const MapperOptions options = OptionsFrom(scenario, "x");
  EXPECT_EQ(options.map.voxel_size, 0.07);
  EXPECT_EQ(options.map.max_range, 3.0);
  EXPECT_TRUE(options.map.fill);
  EXPECT_TRUE(options.map.protect);
  EXPECT_EQ(options.map.log_odds_hit, 0.7F);
  EXPECT_EQ(options.checkpoint_period, Duration::zero());
}

}  // namespace
}  // namespace thalweg::mapper
