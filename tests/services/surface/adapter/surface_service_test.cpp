#include "services/surface/adapter/surface_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <tuple>

#include "services/surface/adapter/mesh_message.h"
#include "tests/support/analytic_room.h"
#include "tests/support/depth_message.h"
#include "tests/support/test_bus.h"

namespace thalweg::surface {
namespace {

namespace topics = dds::topics;
using thalweg::test::AwaitMatch;
using thalweg::test::BusOptionsForTest;
using thalweg::test::kPatience;

Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}
RigidTransform PoseAt(double seconds) {
  return MakeTransform(RotationFromYawPitch(0.3 * seconds, 0.0), {-1.5 + 0.2 * seconds, 0.1, 0.0});
}
PointCloud CloudFrom(const RigidTransform& T_WB) {
  return thalweg::test::AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(60, 45, 1.3),
                                                         T_WB * RobotModel{}.T_BC);
}
PointCloud CloudAt(double seconds, int width_px = 60, double fov = 1.3) {
  const RigidTransform T_WC = PoseAt(seconds) * RobotModel{}.T_BC;
  PointCloud cloud = thalweg::test::AnalyticRoom::Furnished().Render(
      PinholeCamera::FromFieldOfView(width_px, 45, fov), T_WC);
  cloud.colors.assign(cloud.points_C.size(), Rgb{200, 100, 50});
  return cloud;
}

/// What a reader keeps of the updates: the newest block at each place.
class Listener {
 public:
  using Blocks = std::map<std::tuple<int, int, int>, thalweg_msgs::msg::SurfaceBlock>;

  Listener() : bus_(BusOptionsForTest("listener")), requests_(bus_.Advertise<topics::SurfaceRequests>()) {
    bus_.Subscribe<topics::SurfaceUpdates>([this](const auto& update) { Apply(update); });
    bus_.Subscribe<topics::SurfaceStatus>([this](const auto& status) { status_ = status; });
    bus_.Subscribe<topics::SurfaceRifts>([this](const auto& rifts) { rifts_ = rifts; });
    bus_.Subscribe<topics::RiftMarkers>([this](const auto& markers) { markers_ = markers; });
    bus_.EveryWall(std::chrono::milliseconds(200), [this] { Request(); });
  }
  dds::Bus& bus() { return bus_; }
  const dds::Bus::Publisher<topics::SurfaceRequests>& requests() const { return requests_; }
  const Blocks& blocks() const { return blocks_; }
  bool has_copy() const { return has_copy_; }
  int updates() const { return updates_; }  ///< How many were applied.
  std::uint64_t session() const { return session_; }
  std::uint64_t number() const { return number_; }
  const thalweg_msgs::msg::SurfaceStatus& status() const { return status_; }
  const thalweg_msgs::msg::SurfaceRifts& rifts() const { return rifts_; }
  const visualization_msgs::msg::MarkerArray& markers() const { return markers_; }

 private:
  void Apply(const thalweg_msgs::msg::SurfaceUpdate& update) {
    if (update.session() != session_ && !update.full()) has_copy_ = false;
    if (update.full()) {
      blocks_.clear();
      has_copy_ = true;
      session_ = update.session();
    } else if (!has_copy_ || update.number() != number_ + 1) {
      if (has_copy_ && update.number() <= number_) return;
      has_copy_ = false;
      return Request();
    }
    number_ = update.number();
    ++updates_;
    for (const auto& block : update.blocks()) {
      const auto place = std::tuple(block.x(), block.y(), block.z());
      blocks_.erase(place);
      if (!block.faces().empty()) blocks_.emplace(place, block);
    }
  }
  void Request() {
    if (has_copy_) return;
    thalweg_msgs::msg::MapRequest request;
    request.header().frame_id(dds::kMapFrame);
    request.reader("listener");
    requests_.Write(request);
  }

  dds::Bus bus_;
  dds::Bus::Publisher<topics::SurfaceRequests> requests_;
  Blocks blocks_;
  thalweg_msgs::msg::SurfaceStatus status_;
  thalweg_msgs::msg::SurfaceRifts rifts_;
  visualization_msgs::msg::MarkerArray markers_;
  bool has_copy_ = false;
  std::uint64_t session_ = 0;
  std::uint64_t number_ = 0;
  int updates_ = 0;
};

class SurfaceServiceTest : public testing::Test {
 protected:
  SurfaceServiceTest()
      : robot_(BusOptionsForTest("robot")),
        odometry_(robot_.Advertise<topics::Odometry>()),
        points_(robot_.Advertise<topics::DepthPoints>()) {
    std::filesystem::create_directories(folder_);
    options_.surface.voxel_size = 0.05;
    options_.out = folder_;
    options_.publish_period = std::chrono::milliseconds(20);
    options_.full_copy_period = std::chrono::milliseconds(20);
    options_.checkpoint_period = std::chrono::hours(1);
  }
  ~SurfaceServiceTest() override {
    service_.reset();  // which may be writing
    std::filesystem::remove_all(folder_);
  }

  void Start() {
    service_.reset();
    bus_.reset();
    bus_.emplace(BusOptionsForTest("surface"));
    service_.emplace(options_, *bus_);
    AwaitMatch(robot_, odometry_, *bus_);
    if (!options_.reads_images) AwaitMatch(robot_, points_, *bus_);
  }
  void SendPose(double seconds) {
    odometry_.Write(dds::OdometryToIdl(At(seconds), PoseAt(seconds), {0, 0, 0}, {0, 0, 0}));
  }
  bool SpinUntil(const std::function<bool()>& done) { return bus_->SpinUntil(done, kPatience); }
  void Scan(double seconds) {
    const auto before = service_->scans();
    SendPose(seconds);
    points_.Write(dds::ToIdl(At(seconds), CloudAt(seconds)));
    ASSERT_TRUE(SpinUntil([&] { return service_->scans() == before + 1; })) << seconds;
  }
  /// Fuses what a robot in an empty room of 2 m sees. @param number  The scan's, from 1.
  void LookInRoom(int number, double yaw, double pitch) {
    const thalweg::test::AnalyticRoom room{
        {Eigen::Vector3d(-1.013, -1.027, -1.041), Eigen::Vector3d(0.987, 0.973, 0.959)}, {}};
    const RigidTransform T_WB = MakeTransform(RotationFromYawPitch(yaw, pitch), {0.0, 0.0, 0.0});
    odometry_.Write(dds::OdometryToIdl(At(number), T_WB, {0, 0, 0}, {0, 0, 0}));
    points_.Write(dds::ToIdl(
        At(number), room.Render(PinholeCamera::FromFieldOfView(60, 45, 1.3), T_WB * RobotModel{}.T_BC)));
    ASSERT_TRUE(SpinUntil([&] { return service_->scans() == static_cast<std::uint64_t>(number); })) << number;
  }
  /// Spins both until the listener has something.
  bool SpinBothUntil(Listener& listener, const std::function<bool()>& done) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!listener.bus().SpinUntil(done, std::chrono::milliseconds(5))) {
      if (std::chrono::steady_clock::now() > end) return false;
      bus_->SpinUntil([] { return false; }, std::chrono::milliseconds(5));
    }
    return true;
  }
  /// Spins both until the listener has all that was published.
  bool Follow(Listener& listener) {
    return SpinBothUntil(listener, [&] {
      return listener.has_copy() && service_->updates() > 0 && listener.number() == service_->updates() &&
             listener.status().scans() == service_->scans() && Same(listener);
    });
  }
  /// Whether the listener holds the service's mesh, to the last bit.
  bool Same(const Listener& listener) const {
    if (listener.blocks().size() != service_->mesh().blocks().size()) return false;
    for (const auto& [index, mesh] : service_->mesh().blocks()) {
      const auto found = listener.blocks().find({index.x, index.y, index.z});
      if (found == listener.blocks().end()) return false;
      if (!(found->second == ToIdl(index, &mesh, options_.surface.limits))) return false;
    }
    return true;
  }
  /// Whether the same is known of the same voxels. What changes a distance by rounding only is not stored.
  static bool KnowsTheSame(const TruncatedVolume& a, const TruncatedVolume& b) {
    const auto knows_no_more = [](const TruncatedVolume& one, const TruncatedVolume& other) {
      bool no_more = true;
      one.ForEachBlock([&](const VoxelIndex& index, const TruncatedVolume::Block& block) {
        const TruncatedVolume::Block* its = other.Find(index);
        for (std::size_t k = 0; no_more && k < block.voxels.size(); ++k) {
          const SurfaceVoxel voxel = its ? its->voxels[k] : SurfaceVoxel{};
          no_more = block.voxels[k].known() == voxel.known() && block.voxels[k].color == voxel.color &&
                    std::abs(block.voxels[k].distance - voxel.distance) < 1e-5F;
        }
      });
      return no_more;
    };
    return knows_no_more(a, b) && knows_no_more(b, a);
  }
  static SurfaceArea AreaOf(const TruncatedVolume& volume) {
    std::vector<VoxelIndex> blocks;
    volume.ForEachBlock([&](const VoxelIndex& index, const auto&) { blocks.push_back(index); });
    SurfaceMesh mesh{InspectionLimits{}};
    mesh.Update(volume, blocks);
    return mesh.area();
  }
  unsigned long long Rejected() { return bus_->health().rejected(); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-surface-" + std::to_string(getpid()));
  SurfaceServiceOptions options_;
  dds::Bus robot_;
  dds::Bus::Publisher<topics::Odometry> odometry_;
  dds::Bus::Publisher<topics::DepthPoints> points_;
  std::optional<dds::Bus> bus_;
  std::optional<SurfaceService> service_;
};

TEST_F(SurfaceServiceTest, AListenerThatJoinsLateHoldsTheSameMesh) {
  Start();
  Listener early;
  AwaitMatch(early.bus(), early.requests(), *bus_);
  for (int i = 1; i <= 3; ++i) Scan(0.2 * i);
  ASSERT_TRUE(Follow(early));
  Listener late;
  AwaitMatch(late.bus(), late.requests(), *bus_);
  ASSERT_TRUE(Follow(late));
  for (int i = 4; i <= 6; ++i) Scan(0.2 * i);
  EXPECT_TRUE(Follow(late));
  EXPECT_TRUE(Follow(early));
  EXPECT_GT(late.blocks().size(), 100U);
  EXPECT_NEAR(late.status().area_m2(), service_->mesh().area().seen, 1e-9);
  EXPECT_EQ(late.status().scans(), 6U);
  EXPECT_EQ(late.status().inspection_distance_m(), 2.0);
  EXPECT_EQ(late.status().inspection_angle_deg(), 60.0);
  EXPECT_EQ(late.status().sampling_m(), 0.005);
}

TEST_F(SurfaceServiceTest, RiftsAreWhereTheSurfaceIsTornUntilTheRestIsSeen) {
  Start();
  Listener early;
  AwaitMatch(early.bus(), early.requests(), *bus_);
  LookInRoom(1, 0.0, 0.0);
  ASSERT_TRUE(SpinBothUntil(early, [&] { return early.rifts().open() > 0; }));
  const thalweg_msgs::msg::SurfaceRift rift = early.rifts().rifts().at(0);
  EXPECT_EQ(early.rifts().header().frame_id(), "map");
  EXPECT_EQ(early.rifts().header().stamp(), dds::ToIdl(At(1)));
  EXPECT_EQ(rift.fate(), thalweg_msgs::msg::RIFT_OPEN);
  EXPECT_GT(rift.length_m(), 4.0) << "around all that the image shows";
  EXPECT_LT(rift.normal().x(), -0.5) << "the wall before the robot faces it";
  EXPECT_GT(rift.center().x(), 0.5);
  EXPECT_LT(rift.distance_m(), 2.0);
  EXPECT_EQ(rift.weight(), 0.5 * rift.distance_m() + 0.5 * rift.edges());
  ASSERT_TRUE(SpinBothUntil(early, [&] { return early.markers().markers().size() > 1; }));
  Listener late;
  AwaitMatch(late.bus(), late.requests(), *bus_);
  ASSERT_TRUE(SpinBothUntil(late, [&] { return late.rifts() == early.rifts(); }));
  ASSERT_TRUE(Follow(late));
  EXPECT_EQ(late.rifts().session(), late.session());

  int number = 1;
  for (const double pitch : {-1.0, 0.0, 1.0}) {
    for (int k = 0; k < 12; ++k) LookInRoom(++number, 0.55 * k, pitch);
  }
  EXPECT_TRUE(SpinBothUntil(late, [&] { return late.rifts().open() == 0; })) << late.rifts().open();
  const auto& ended = late.rifts().rifts();
  EXPECT_TRUE(std::ranges::any_of(ended, [&](const auto& its) { return its.number() == rift.number(); }));
  for (const auto& its : ended) EXPECT_NE(its.fate(), thalweg_msgs::msg::RIFT_OPEN);
}

TEST_F(SurfaceServiceTest, AfterAKillItGoesOnFromItsCheckpoint) {
  options_.checkpoint_period = std::chrono::milliseconds(50);
  Start();
  for (int i = 1; i <= 3; ++i) Scan(0.2 * i);
  // As kill -9: without Save.
  const auto on_disk = [&] {
    const auto loaded = LoadVolume(folder_ / SurfaceService::kCheckpointFile);
    return loaded && loaded->has_value() && KnowsTheSame((*loaded)->volume, service_->surface().volume());
  };
  ASSERT_TRUE(SpinUntil(on_disk));
  const SurfaceArea area = AreaOf(service_->surface().volume());
  Start();
  EXPECT_TRUE(on_disk());
  EXPECT_NEAR(service_->mesh().area().seen, area.seen, 1e-4 * area.seen);
  EXPECT_NEAR(service_->mesh().area().inspected, area.inspected, 1e-4 * area.seen);
  EXPECT_EQ(service_->scans(), 0U);
  Listener listener;
  AwaitMatch(listener.bus(), listener.requests(), *bus_);
  Scan(1.0);
  EXPECT_TRUE(Follow(listener));
}

TEST_F(SurfaceServiceTest, OneOfOtherOptionsIsRefusedAndADamagedOneSetAside) {
  Start();
  Scan(0.2);
  service_->Save();
  EXPECT_GT(std::filesystem::file_size(folder_ / SurfaceService::kMeshFile), 10000U);
  options_.surface.voxel_size = 0.1;
  EXPECT_THROW(Start(), std::runtime_error);
  options_.surface.voxel_size = 0.05;
  options_.surface.limits.distance = 1.0F;
  EXPECT_THROW(Start(), std::runtime_error);
  std::ofstream(folder_ / SurfaceService::kCheckpointFile) << "THALSUR1 and then nonsense";
  Start();
  EXPECT_EQ(service_->surface().volume().block_count(), 0U);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "checkpoint.surface.unused"));
}

TEST_F(SurfaceServiceTest, LiesAreRefusedAndCounted) {
  Start();
  Scan(0.2);
  auto elsewhere = dds::ToIdl(At(0.3), CloudAt(0.3));
  elsewhere.header().frame_id("somewhere");
  points_.Write(elsewhere);
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 1; }));
  PointCloud nothing = CloudAt(0.3);
  for (Eigen::Vector3f& p_C : nothing.points_C) p_C.setConstant(std::numeric_limits<float>::quiet_NaN());
  nothing.width_px = nothing.width_px * nothing.height_px;
  nothing.height_px = 1;
  points_.Write(dds::ToIdl(At(0.31), nothing));  // not organized
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 2; }));
  points_.Write(dds::ToIdl(At(0.32), CloudAt(0.3, 80)));  // another size
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 3; }));
  points_.Write(dds::ToIdl(At(0.33), CloudAt(0.3, 60, 1.0)));  // other intrinsics
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 4; }));
  auto no_pose = dds::OdometryToIdl(At(0.3), PoseAt(0.3), {0, 0, 0}, {0, 0, 0});
  no_pose.pose().pose().position().x(std::numeric_limits<double>::quiet_NaN());
  odometry_.Write(no_pose);
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 5; }));
  // A pose that jumps by 3 m places no cloud.
  const RigidTransform far = Eigen::Translation3d(3.0, 0.0, 0.0) * PoseAt(0.35);
  odometry_.Write(dds::OdometryToIdl(At(0.35), far, {0, 0, 0}, {0, 0, 0}));
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 6; }));
  EXPECT_EQ(service_->scans(), 1U);
  Scan(0.4);  // still works
}

TEST_F(SurfaceServiceTest, ACloudWithoutPointsIsOfTheCameraThatIsKnown) {
  Start();
  const auto nothing_at = [&](double seconds) {
    PointCloud nothing = CloudAt(seconds);
    for (Eigen::Vector3f& p_C : nothing.points_C) p_C.setConstant(std::numeric_limits<float>::quiet_NaN());
    SendPose(seconds);
    points_.Write(dds::ToIdl(At(seconds), nothing));
  };
  nothing_at(0.1);
  ASSERT_TRUE(SpinUntil([&] { return bus_->health().dropped() == 1; }));
  Scan(0.2);
  nothing_at(0.3);
  ASSERT_TRUE(SpinUntil([&] { return service_->scans() == 2; }));
  EXPECT_EQ(Rejected(), 0U);
}

TEST_F(SurfaceServiceTest, TheMeshIsSentInPartsIfItIsLarge) {
  options_.most_update_bytes = 100'000;
  Start();
  Listener listener;
  AwaitMatch(listener.bus(), listener.requests(), *bus_);
  for (int i = 1; i <= 2; ++i) Scan(0.2 * i);
  ASSERT_TRUE(Follow(listener));
  Listener late;
  AwaitMatch(late.bus(), late.requests(), *bus_);
  ASSERT_TRUE(Follow(late));
  EXPECT_GT(late.updates(), 3);
  EXPECT_TRUE(Follow(listener));
}

TEST_F(SurfaceServiceTest, ANewCameraIsBelievedOnceItStays) {
  Start();
  Scan(0.2);
  for (int k = 0; k < SteadyCamera::kToStay; ++k) {
    const double seconds = 0.21 + 0.01 * k;
    SendPose(seconds);
    points_.Write(dds::ToIdl(At(seconds), CloudAt(seconds, 80)));
    ASSERT_TRUE(SpinUntil(
        [&] { return Rejected() == static_cast<unsigned long long>(k) + 1 || service_->scans() == 2; }));
  }
  EXPECT_EQ(service_->scans(), 2U);
  EXPECT_EQ(Rejected(), SteadyCamera::kToStay - 1);
}

TEST_F(SurfaceServiceTest, TakesNoMoreMemoryThanItMay) {
  options_.surface.most_bytes = 100 * TruncatedVolume::kBlockBytes;
  Start();
  for (int i = 1; i <= 3; ++i) Scan(0.2 * i);
  EXPECT_LE(service_->surface().volume().bytes(), options_.surface.most_bytes);
  EXPECT_TRUE(service_->surface().full());
}

TEST_F(SurfaceServiceTest, StandingStillNothingNewIsPublished) {
  Start();
  Listener listener;
  AwaitMatch(listener.bus(), listener.requests(), *bus_);
  SendPose(0.2);
  points_.Write(dds::ToIdl(At(0.2), CloudAt(0.2)));
  ASSERT_TRUE(SpinUntil([&] { return service_->scans() == 1; }));
  ASSERT_TRUE(Follow(listener));
  const auto updates = service_->updates();
  // The same view again, ten times: stamps of a robot that stands.
  for (int k = 1; k <= 10; ++k) {
    const double seconds = 0.2 + 0.1 * k;
    odometry_.Write(dds::OdometryToIdl(At(seconds), PoseAt(0.2), {0, 0, 0}, {0, 0, 0}));
    points_.Write(dds::ToIdl(At(seconds), CloudAt(0.2)));
    ASSERT_TRUE(SpinUntil([&] { return service_->scans() == static_cast<std::uint64_t>(k) + 1; }));
  }
  ASSERT_TRUE(Follow(listener));
  EXPECT_EQ(service_->updates(), updates);
}

TEST_F(SurfaceServiceTest, DepthImagesGiveTheSurfaceOfTheirClouds) {
  Start();
  Scan(0.2);
  const SurfaceArea of_clouds = AreaOf(service_->surface().volume());
  options_.reads_images = true;
  Start();
  const auto images = robot_.Advertise<topics::DepthImage>();
  const auto cameras = robot_.Advertise<topics::DepthCameraInfo>();
  AwaitMatch(robot_, images, *bus_);
  AwaitMatch(robot_, cameras, *bus_);
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(60, 45, 1.3);
  const auto send = [&](double seconds, const PinholeCamera& stated) {
    SendPose(seconds);
    images.Write(thalweg::test::DepthMessage(At(seconds), CloudAt(seconds)));
    cameras.Write(dds::ToIdl(At(seconds), stated, 0.0));
  };
  send(0.2, camera);
  ASSERT_TRUE(SpinUntil([&] { return service_->scans() == 1; }));
  EXPECT_NEAR(AreaOf(service_->surface().volume()).seen, of_clouds.seen, 1e-3 * of_clouds.seen);
  send(0.3, PinholeCamera::FromFieldOfView(50, 45, 1.3));  // of another size than its image
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 1; }));
  send(0.4, PinholeCamera::FromFieldOfView(60, 45, 1.0));  // other intrinsics than before
  ASSERT_TRUE(SpinUntil([&] { return Rejected() == 2; }));
  EXPECT_EQ(service_->scans(), 1U);
}

TEST_F(SurfaceServiceTest, ACheckpointOfAnotherPlaceIsRefusedByTheFirstViewsAndStays) {
  options_.checkpoint_period = std::chrono::milliseconds(50);
  Start();
  const auto scan_round = [&](int i, const RigidTransform& T_WB, const RigidTransform& of) {
    odometry_.Write(dds::OdometryToIdl(At(0.5 * i), T_WB, {0, 0, 0}, {0, 0, 0}));
    points_.Write(dds::ToIdl(At(0.5 * i), CloudFrom(of)));
    ASSERT_TRUE(SpinUntil([&] { return service_->scans() == static_cast<std::uint64_t>(i); }));
  };
  const auto here = [](int i) {
    return MakeTransform(RotationFromYawPitch(0.55 * i, 0.0), {-1.5, 0.1, 0.0});
  };
  // All around, so that the robot that stands elsewhere looks at something known.
  for (int i = 1; i <= 12; ++i) scan_round(i, here(i), here(i));
  service_->Save();
  Start();
  for (int i = 1; i <= 6; ++i) scan_round(i, here(i), here(i));
  service_.reset();
  const std::filesystem::path file = folder_ / SurfaceService::kCheckpointFile;
  const auto before = std::filesystem::last_write_time(file);
  Start();
  try {
    for (int i = 1; i <= 12; ++i) {
      const RigidTransform there = MakeTransform(RotationFromYawPitch(2.2 + 0.55 * i, 0.0), {1.2, -1.0, 0.2});
      scan_round(i, here(i), there);
    }
    FAIL() << "it is fused with the checkpoint of another place";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("checkpoint.surface is of another place"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(std::filesystem::last_write_time(file), before) << "it is as it was";
}

TEST_F(SurfaceServiceTest, WhenTheMapIsSavedTheMeshIsToo) {
  Start();
  const auto commands = robot_.Advertise<topics::OperatorCommands>();
  AwaitMatch(robot_, commands, *bus_);
  Scan(0.2);
  thalweg_msgs::msg::OperatorCommand command;
  command.sender("test");
  command.id(1);
  command.kind(thalweg_msgs::msg::COMMAND_PAUSE);
  commands.Write(command);
  command.id(2);
  command.kind(thalweg_msgs::msg::COMMAND_SAVE_MAP);
  commands.Write(command);
  const std::filesystem::path file = folder_ / SurfaceService::kMeshFile;
  ASSERT_TRUE(SpinUntil([&] { return std::filesystem::exists(file); }));
  EXPECT_GT(std::filesystem::file_size(file), 10000U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / SurfaceService::kCheckpointFile));
}

TEST(SurfaceServiceOptions, ReadImagesWhereTheScenarioSaysSo) {
  Scenario scenario;
  EXPECT_FALSE(OptionsFrom(scenario, {}).reads_images);
  scenario.set_depth_source(DepthSource::DEPTH_IMAGE);
  EXPECT_TRUE(OptionsFrom(scenario, {}).reads_images);
}

TEST(SurfaceServiceOptions, FollowTheScenario) {
  Scenario scenario;
  scenario.mutable_surface()->set_voxel_size_m(0.04);
  scenario.mutable_surface()->set_inspection_angle_deg(45.0);
  scenario.mutable_surface()->set_most_memory_mb(300);
  scenario.mutable_mapper()->set_depth_error_per_m(0.002);
  const SurfaceServiceOptions options = OptionsFrom(scenario, "/tmp/out");
  EXPECT_EQ(options.surface.voxel_size, 0.04);
  EXPECT_NEAR(options.surface.limits.cosine, std::sqrt(0.5), 1e-6);
  EXPECT_EQ(options.surface.most_bytes, 300'000'000U);
  EXPECT_EQ(options.surface.depth_error.sigma, 0.002);
  EXPECT_EQ(options.surface.limits.distance, InspectionLimits{}.distance);
}

}  // namespace
}  // namespace thalweg::surface
