#include "services/cli/adapter/observer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "services/cli/adapter/report_files.h"
#include "services/cli/report/report_json.h"
#include "services/cli/report/run_page.h"

namespace thalweg::cli {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

constexpr double kVoxel = 0.1;

dds::BusOptions BusOptionsFor(const char* name) {
  dds::BusOptions options;
  options.name = name;
  options.domain = 62;
  options.partition = "observer-test-" + std::to_string(getpid());
  return options;
}

/// Mapper, explorer and odometry in one, publishing what the test wants.
class ObserverTest : public testing::Test {
 protected:
  ObserverTest() {
    services_.Subscribe<topics::MapRequests>([this](const auto&) {
      ++requests_;
      map_out_.Write(log_.FullCopy(grid_));
    });
    Drive([this] {
      return map_out_.readers() == 1 && odometry_out_.readers() == 1 && status_out_.readers() == 1 &&
             motion_out_.readers() == 1 &&
             // A sample that is written before the reader has found its writer, too, is lost.
             bus_.Writers<topics::MapUpdates>() == 1 && bus_.Writers<topics::Odometry>() == 1 &&
             bus_.Writers<topics::ExplorationStatus>() == 1 && bus_.Writers<topics::MotionStatus>() == 1;
    });
  }

  /// Spins both buses until the condition holds.
  bool Drive(const std::function<bool()>& done) {
    const auto limit = std::chrono::steady_clock::now() + 10s;
    while (!done()) {
      if (std::chrono::steady_clock::now() > limit) return false;
      services_.SpinUntil(done, 2ms);
      bus_.SpinUntil(done, 2ms);
    }
    return true;
  }

  void See(const VoxelIndex& voxel, float log_odds, Time stamp) {
    grid_.Set(voxel, log_odds);
    const VoxelChange change{voxel, log_odds};
    log_.Add(stamp, {.T_WC = RigidTransform::Identity()}, {&change, 1});
  }
  void BeAt(double x, Time stamp) {
    const RigidTransform T_WB = MakeTransform(Eigen::Matrix3d::Identity(), {x, 0.0, 0.0});
    odometry_out_.Write(dds::OdometryToIdl(stamp, T_WB, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()));
  }
  thalweg_msgs::msg::ExplorationStatus Status(Time stamp, std::uint32_t plans) const {
    thalweg_msgs::msg::ExplorationStatus status;
    status.header(dds::MakeHeader(stamp, dds::kMapFrame));
    status.strategy("closest");
    status.state(thalweg_msgs::msg::EXPLORATION_MOVING);
    status.plans(plans);
    status.frontiers_left(7);
    return status;
  }

  const Time start_ = Time{} + 1000s;
  OccupancyGrid grid_{kVoxel};
  dds::MapLog log_{dds::MapLog::MakeSession(), kVoxel};
  int requests_ = 0;
  dds::Bus services_{BusOptionsFor("services")};
  dds::Bus::Publisher<topics::MapUpdates> map_out_ = services_.Advertise<topics::MapUpdates>();
  dds::Bus::Publisher<topics::Odometry> odometry_out_ = services_.Advertise<topics::Odometry>();
  dds::Bus::Publisher<topics::ExplorationStatus> status_out_ =
      services_.Advertise<topics::ExplorationStatus>();
  dds::Bus::Publisher<topics::MotionStatus> motion_out_ = services_.Advertise<topics::MotionStatus>();
  dds::Bus bus_{BusOptionsFor("thalweg")};
  Observer observer_{Scenario{}, "test", bus_};
};

TEST_F(ObserverTest, ReportsDistanceVolumeAndPlansOfARun) {
  See({0, 0, 0}, -1.0F, start_);
  ASSERT_TRUE(Drive([&] { return observer_.map() != nullptr; }));  // it requested a full copy
  EXPECT_GE(requests_, 1);
  for (int i = 0; i <= 10; ++i) {
    const Time stamp = start_ + i * 100ms;
    ASSERT_TRUE(Drive([&] {
      BeAt(0.1 * i, stamp);
      return observer_.Live().distance > 0.1 * i - 1e-6 && observer_.Live().time > 0.1 * i - 1e-6;
    }));
  }
  auto without_plan = Status(start_, 0);
  without_plan.frontiers_left(0);
  without_plan.activity("waiting for a map");
  status_out_.Write(without_plan);
  ASSERT_TRUE(Drive([&] { return observer_.Live().activity == "waiting for a map"; }));
  EXPECT_FALSE(observer_.Live().frontiers) << "none were looked for";
  status_out_.Write(Status(start_, 5));
  ASSERT_TRUE(Drive([&] { return observer_.Live().frontiers == 7U; }));
  auto restarted = Status(start_ + 1s, 2);
  restarted.frontiers_left(3);
  status_out_.Write(restarted);
  ASSERT_TRUE(Drive([&] { return observer_.Live().frontiers == 3U; }));

  const RunRecord record = observer_.Record("interrupted");
  EXPECT_NEAR(record.distance, 1.0, 1e-9);
  EXPECT_NEAR(record.duration, 1.0, 1e-9);
  EXPECT_NEAR(record.free_volume, 0.001, 1e-12);
  EXPECT_EQ(record.plans, 7U);
  EXPECT_EQ(record.strategy, "closest");
  EXPECT_EQ(record.stop_reason, "interrupted");
  EXPECT_FALSE(record.agreement);
  EXPECT_FALSE(record.true_collisions);
}

TEST_F(ObserverTest, NamesWhatNothingWasHeardOfYet) {
  using Names = std::vector<std::string>;
  const auto unheard_is = [&](const Names& names) {
    return Drive([&] { return observer_.Live().unheard == names; });
  };
  EXPECT_TRUE(unheard_is({"pose", "map", "explorer", "controller"}));
  motion_out_.Write({});
  EXPECT_TRUE(unheard_is({"pose", "map", "explorer"}));
  BeAt(0.0, start_);
  EXPECT_TRUE(unheard_is({"map", "explorer"}));
  status_out_.Write(Status(start_, 1));
  EXPECT_TRUE(unheard_is({"map"}));
  See({0, 0, 0}, -1.0F, start_);
  map_out_.Write(log_.FullCopy(grid_));
  EXPECT_TRUE(unheard_is({}));
}

TEST_F(ObserverTest, ReportsThatTheMapperHasResumedItsMap) {
  dds::BusOptions options = BusOptionsFor("mapper");
  options.publish_health = false;  // but what the test writes
  dds::Bus mapper(options);
  const auto health_out = mapper.Advertise<topics::Health>();
  thalweg_msgs::msg::ServiceHealth health;
  health.service("mapper");
  health.timings().resize(1);
  const auto send = [&](const char* timing) {
    health.timings()[0].name(timing);
    ASSERT_TRUE(Drive([&] {
      health_out.Write(health);
      const auto record = observer_.Record("interrupted");
      return !record.integration.empty() && record.integration[0].name == timing;
    }));
  };
  send("integrate");
  EXPECT_FALSE(observer_.map_was_resumed());
  send("resume");
  EXPECT_TRUE(observer_.map_was_resumed());
}

TEST_F(ObserverTest, GoesOnCountingWhenTheSimulatorIsRestarted) {
  const auto poses = [&] { return observer_.Record("interrupted").trajectory.size(); };
  const auto go = [&](double x, Time stamp) {
    const std::size_t before = poses();
    return Drive([&] {
      BeAt(x, stamp);
      return poses() > before;
    });
  };
  ASSERT_TRUE(go(0.0, start_));
  ASSERT_TRUE(go(1.0, start_ + 10s));
  // The new simulator's clock begins at 0, and its robot is elsewhere.
  ASSERT_TRUE(go(5.0, Time{} + 1s));
  ASSERT_TRUE(go(5.5, Time{} + 6s));
  const RunRecord record = observer_.Record("interrupted");
  EXPECT_NEAR(record.distance, 1.5, 1e-9);
  EXPECT_NEAR(record.duration, 15.0, 0.1);
  for (std::size_t n = 1; n < record.trajectory.size(); ++n) {
    EXPECT_LT(record.trajectory[n - 1].stamp, record.trajectory[n].stamp);
  }
}

TEST_F(ObserverTest, SaysSoWhenAnotherRunIsInItsDomain) {
  int k = 0;
  ASSERT_TRUE(Drive([&] {
    ++k;
    BeAt(0.01 * k, start_ + k * 20ms);
    BeAt(3.0, Time{} + 10s + k * 20ms);
    return observer_.failure().has_value();
  }));
  EXPECT_NE(observer_.failure()->find("domain"), std::string::npos);
}

TEST_F(ObserverTest, IsFinishedOnceTheMapHoldsWhatWasSeenUntilTheEnd) {
  BeAt(0.0, start_);
  See({0, 0, 0}, -1.0F, start_);
  ASSERT_TRUE(Drive([&] { return observer_.map() != nullptr; }));
  auto done = Status(start_ + 2s, 1);
  done.state(thalweg_msgs::msg::EXPLORATION_DONE);
  done.outcome(thalweg_msgs::msg::OUTCOME_COMPLETE);
  done.stop_reason("complete");
  done.stop_details("1 m2 of frontier stayed unknown");
  status_out_.Write(done);
  ASSERT_TRUE(Drive([&] { return observer_.stop_reason() == "complete"; }));
  EXPECT_FALSE(observer_.finished());
  See({1, 0, 0}, 1.0F, start_ + 2s);
  map_out_.Write(log_.TakeUpdate());
  map_out_.Write(log_.FullCopy(grid_));
  ASSERT_TRUE(Drive([&] { return observer_.finished(); }));
  EXPECT_TRUE(observer_.map()->SameAs(grid_));
  EXPECT_EQ(observer_.Record("interrupted").stop_reason, "complete");
  EXPECT_TRUE(observer_.Record("interrupted").succeeded);
  EXPECT_EQ(observer_.Record("interrupted").stop_details, "1 m2 of frontier stayed unknown");
}

TEST_F(ObserverTest, MessagesThatLieAreCountedInTheReport) {
  auto lie = log_.FullCopy(grid_);
  lie.voxel_size_m(-1.0);
  ASSERT_TRUE(Drive([&] {
    map_out_.Write(lie);
    return bus_.health().rejected() > 0;
  }));
  ASSERT_TRUE(Drive([&] { return !observer_.Record("").rejected.empty(); }));
  EXPECT_EQ(observer_.Record("").rejected[0].service, "thalweg");
}

TEST_F(ObserverTest, TextOfPeersIsCleanedAndListsAreLimitedBeforeTheyAreShown) {
  const std::string evil = "\x1B]0;owned\x07\xFF\n" + std::string(500, 'x');
  auto status = Status(start_, 1);
  status.state(thalweg_msgs::msg::EXPLORATION_DONE);
  status.strategy(evil);
  status.activity(evil);
  status.stop_reason(evil);
  status.stop_details(evil);
  status.set_aside().resize(200);
  status.timings().resize(200);
  for (auto& entry : status.set_aside()) entry.reason(static_cast<thalweg_msgs::msg::AsideReason>(99));
  for (auto& entry : status.timings()) entry.name(evil);
  status_out_.Write(status);
  ASSERT_TRUE(Drive([&] { return observer_.Live().frontiers == 7U; }));
  dds::BusOptions options = BusOptionsFor("peer");
  options.publish_health = false;  // but what the test writes
  dds::Bus peer(options);
  const auto health_out = peer.Advertise<topics::Health>();
  thalweg_msgs::msg::ServiceHealth health;
  health.service(evil);
  health.rejected().resize(200);
  for (std::size_t k = 0; k < health.rejected().size(); ++k) {
    health.rejected()[k].name(std::to_string(k) + evil);
    health.rejected()[k].count(1);
    health.rejected()[k].last(evil);
  }
  ASSERT_TRUE(Drive([&] {
    health_out.Write(health);
    return !observer_.Record("").rejected.empty();
  }));

  const RunRecord record = observer_.Record("interrupted");
  EXPECT_LE(record.set_aside.size(), 64U);
  EXPECT_LE(record.planning.size(), 64U);
  EXPECT_LE(record.rejected.size(), 64U);
  const std::string json = ToJson(record).dump();  // throws on text that is not UTF-8
  EXPECT_LT(json.size(), 200'000U);
  for (const std::string& shown :
       {json, LiveLine(observer_.Live(), 1000), record.stop_details, record.stop_reason}) {
    EXPECT_EQ(shown.find_first_of("\x1B\x07\xFF\n"), std::string::npos) << shown;
  }
  EXPECT_TRUE(record.stop_reason.starts_with("\uFFFD]0;owned\uFFFD\uFFFD x"));
}

TEST_F(ObserverTest, ListsDecisionsWithTheirPathsAndTheFrontiersOfTheLastPlan) {
  const std::string evil = "\x1B[31m" + std::string(500, 'x');
  const auto path_out = services_.Advertise<topics::Path>();
  const auto frontiers_out = services_.Advertise<topics::Frontiers>();
  BeAt(0.0, start_);
  ASSERT_TRUE(Drive([&] { return path_out.readers() == 1 && frontiers_out.readers() == 1; }));
  auto status = Status(start_ + 1s, 1);
  status.activity(evil);
  status.target().x(1.5);
  status_out_.Write(status);
  const RigidTransform there = MakeTransform(Eigen::Matrix3d::Identity(), {0.0, 2.0, 0.0});
  path_out.Write(dds::ToIdl(dds::StampedPath{start_ + 900ms, {RigidTransform::Identity(), there}}));
  thalweg_msgs::msg::FrontierList list;
  list.frontiers().resize(5000);
  list.frontiers()[0].center().x(std::nan(""));  // not a place
  list.frontiers()[1].reason(thalweg_msgs::msg::ASIDE_VISITED);
  frontiers_out.Write(list);
  ASSERT_TRUE(Drive([&] {
    const RunRecord record = observer_.Record("");
    return !record.decisions.empty() && record.decisions[0].length && !record.frontiers.empty();
  }));
  const RunRecord record = observer_.Record("");
  EXPECT_EQ(record.decisions.size(), 1U);
  EXPECT_NEAR(*record.decisions[0].length, 2.0, 1e-9);
  EXPECT_NEAR(record.decisions[0].target_W->x(), 1.5, 1e-9);
  EXPECT_LE(record.frontiers.size(), 2048U);
  EXPECT_EQ(record.decisions[0].purpose.find('\x1B'), std::string::npos);
  EXPECT_LT(record.decisions[0].purpose.size(), 300U);
  EXPECT_EQ(record.frontiers[0].reason, "visited without progress") << "the first has no place";
  ASSERT_TRUE(Drive([&] { return !observer_.Record("").services.empty(); }));
}

TEST_F(ObserverTest, WarnsOfFilesThatAServiceCouldNotWrite) {
  EXPECT_TRUE(observer_.warnings().empty());
  services_.health().Drop<topics::DepthPoints>("too late");
  services_.health().FileNotWritten("/out/checkpoint.map: cannot be written: No space left on device");
  ASSERT_TRUE(Drive([&] { return !observer_.warnings().empty(); }));
  const std::vector<std::string> warnings{
      "services: /out/checkpoint.map: cannot be written: No space left on device; the run continues"};
  EXPECT_EQ(observer_.warnings(), warnings);
  EXPECT_EQ(observer_.Record("").warnings, warnings);
}

TEST_F(ObserverTest, SaysThatNoClockIsHeardAndWhatARobotNeeds) {
  dds::BusOptions options = BusOptionsFor("watching");
  options.clock = dds::ClockSource::kTopic;
  dds::Bus bus(options);
  Observer observer(Scenario{}, "test", bus);
  EXPECT_TRUE(observer.warnings().empty()) << "it has only begun";
  ASSERT_TRUE(bus.SpinUntil([&] { return !observer.warnings().empty(); }, 20s));
  EXPECT_NE(observer.warnings()[0].find("network.wall_clock: true"), std::string::npos);
  EXPECT_EQ(observer.Live().unheard[0], topics::Clock::kName);
}

TEST_F(ObserverTest, ShowsWhatAServiceRefusesWithTheReasonLiveAndInTheReport) {
  services_.health().Reject(dds::Health::kDatagrams, "of a stranger");
  services_.health().Reject<topics::DepthPoints>("frame_id is \"lidar\", must be \"camera_optical_frame\"");
  const std::string expected = std::string("services rejects ") + topics::DepthPoints::kName +
                               ": frame_id is \"lidar\", must be \"camera_optical_frame\"";
  ASSERT_TRUE(Drive([&] { return !observer_.Live().trouble.empty(); }));
  EXPECT_EQ(observer_.Live().trouble, expected);
  EXPECT_EQ(observer_.warnings(), std::vector<std::string>{expected});
  EXPECT_EQ(observer_.Record("").warnings, std::vector<std::string>{expected});
  LiveState live = observer_.Live();
  live.activity = "waiting for a map";
  EXPECT_NE(LiveLine(live, 300).find(expected + "; waiting for a map"), std::string::npos);
  // It is no longer shown once nothing more is refused.
  ASSERT_TRUE(Drive([&] { return observer_.Live().trouble.empty(); }));
  EXPECT_FALSE(observer_.warnings().empty());
}

TEST_F(ObserverTest, ShowsLiveWhyTheControllerHasNoPose) {
  dds::Bus controller(BusOptionsFor("controller"));
  const auto limit = std::chrono::steady_clock::now() + 10s;
  const auto never = [] { return false; };
  const std::string expected = "controller cannot use odometry: its stamp is 0";
  while (observer_.Live().trouble != expected && std::chrono::steady_clock::now() < limit) {
    controller.health().Drop<topics::Odometry>("its stamp is 0");
    controller.SpinUntil(never, 5ms);
    bus_.SpinUntil(never, 5ms);
  }
  EXPECT_EQ(observer_.Live().trouble, expected);
}

TEST_F(ObserverTest, CloudsWithoutPlaceDoNotHideWhyThereIsNoPose) {
  dds::Bus controller(BusOptionsFor("controller"));
  dds::Bus mapper(BusOptionsFor("mapper"));
  const auto limit = std::chrono::steady_clock::now() + 10s;
  const auto never = [] { return false; };
  const std::string expected = "controller cannot use odometry: its stamp is 0";
  const auto has_warned = [&] { return !observer_.warnings().empty(); };
  bool clouds_are_counted = false;
  while ((!clouds_are_counted || !has_warned()) && std::chrono::steady_clock::now() < limit) {
    controller.health().Drop(topics::Odometry::kName, "its stamp is 0", 40);
    controller.SpinUntil(never, 5ms);
    bus_.SpinUntil(never, 5ms);
    if (observer_.Live().trouble != expected) continue;
    mapper.health().Drop<topics::DepthPoints>("no odometry has come");
    mapper.SpinUntil(never, 5ms);
    bus_.SpinUntil(never, 5ms);
    clouds_are_counted = observer_.Record("").clouds_not_mapped > 0;
    EXPECT_EQ(observer_.Live().trouble, expected);
  }
  EXPECT_TRUE(clouds_are_counted);
  EXPECT_EQ(observer_.warnings(), std::vector<std::string>{expected});
}

TEST_F(ObserverTest, SaysThatNobodyPublishesOdometryByTheNameOnTheWire) {
  Scenario scenario;
  scenario.mutable_network()->set_wall_clock(true);
  scenario.mutable_robot()->set_name("scout");
  dds::BusOptions options = BusOptionsFor("alone");
  options.partition += "-alone";
  dds::Bus bus(options);
  Observer observer(scenario, "test", bus);
  EXPECT_TRUE(observer.warnings().empty()) << "it has only begun";
  ASSERT_TRUE(bus.SpinUntil([&] { return !observer.warnings().empty(); }, 20s));
  EXPECT_EQ(observer.warnings()[0],
            "nobody publishes rt/scout/odometry as nav_msgs/msg/Odometry in this domain; thalweg doctor "
            "names what is "
            "published");
  EXPECT_EQ(observer.Live().trouble, observer.warnings()[0]);
}

TEST_F(ObserverTest, NamesWhatIsRefusedInFull) {
  services_.health().Reject("viewers' commands", "too many");
  ASSERT_TRUE(Drive([&] { return !observer_.warnings().empty(); }));
  EXPECT_EQ(observer_.warnings()[0], "services rejects viewers' commands: too many");
}

TEST_F(ObserverTest, ShowsCloudsThatTheMapLacksLiveAndInTheReport) {
  dds::Bus mapper(BusOptionsFor("mapper"));
  const auto drive = [&](const std::function<bool()>& done) {
    const auto limit = std::chrono::steady_clock::now() + 10s;
    // Evaluating `done` may take longer than a spin.
    const auto never = [] { return false; };
    while (!done()) {
      if (std::chrono::steady_clock::now() > limit) return false;
      mapper.SpinUntil(never, 5ms);
      bus_.SpinUntil(never, 5ms);
    }
    return true;
  };
  mapper.health().Drop<topics::MapRequests>("no cloud");
  mapper.health().Drop(topics::DepthPoints::kName, "lost on the way", 2);
  ASSERT_TRUE(drive([&] { return observer_.Record("").clouds_not_mapped == 2; }));
  EXPECT_EQ(observer_.Live().trouble, "2 clouds not mapped (lost on the way)");
  EXPECT_EQ(observer_.Record("").clouds_not_mapped_why, "lost on the way");
  // It is no longer shown live once no more are lost, but it stays in the report.
  ASSERT_TRUE(drive([&] { return observer_.Live().trouble.empty(); }));
  mapper.health().Drop<topics::DepthPoints>("no odometry has reached its stamp");
  ASSERT_TRUE(drive([&] { return !observer_.Live().trouble.empty(); }));
  EXPECT_EQ(observer_.Live().trouble, "3 clouds not mapped (no odometry has reached its stamp)");
}

TEST_F(ObserverTest, ReportFilesAreWrittenAndCanBeReadBack) {
  BeAt(0.0, start_);
  const std::filesystem::path folder = testing::TempDir() + "/report-" + std::to_string(getpid());
  std::filesystem::create_directories(folder);
  const std::filesystem::path page = folder / "template.html";
  std::ofstream(page) << "<script type=\"application/json\">" << kDataPlace << "</script>";
  EXPECT_TRUE(
      WriteReport(observer_.Record("interrupted"), observer_.map(), observer_.tally(), folder, page).empty());
  const auto json = nlohmann::json::parse(std::ifstream(folder / "report.json"));
  EXPECT_EQ(json["stop_reason"], "interrupted");
  EXPECT_TRUE(json["agreement"].is_null());
  EXPECT_GT(std::filesystem::file_size(folder / "report.png"), 1000U);
  EXPECT_TRUE(std::filesystem::exists(folder / "trajectory.tum"));
  EXPECT_GT(std::filesystem::file_size(folder / "report.html"), 100U);
  std::filesystem::remove_all(folder);
  std::ofstream(folder) << "a file where a folder should be";
  const std::vector<std::string> errors =
      WriteReport(observer_.Record(""), nullptr, observer_.tally(), folder / "gone", "not built");
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0], (folder / "gone" / "report.json").string() + ": cannot be written: Not a directory");
  std::filesystem::remove(folder);
}

}  // namespace
}  // namespace thalweg::cli
