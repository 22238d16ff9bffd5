#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <octomap/OcTree.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <Eigen/Core>
#include <fstream>
#include <sstream>

#include "common/dds/map_replica.h"
#include "services/gateway/adapter/options.h"
#include "services/mapper/adapter/checkpoint.h"
#include "tests/support/full_disk.h"
#include "tests/support/outcome.h"
#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

using std::chrono_literals::operator""s;

TEST_F(RunSystemTest, TinyRoomIsExploredAndLeavesMapPathAndReport) {
  Start();
  ExpectComplete();
  const auto report = Report();
  EXPECT_EQ(report["scenario"], "tiny");
  for (const char* key : {"distance_m", "duration_s", "wall_s", "explored_m3", "free_m3", "occupied_m3"}) {
    EXPECT_GT(report[key], 0.0) << key;
  }
  EXPECT_GT(report["plans"], 0);
  EXPECT_FALSE(report["strategy"].get<std::string>().empty());
  EXPECT_FALSE(report["planning"].empty());
  EXPECT_FALSE(report["integration"].empty());
  EXPECT_EQ(report["messages_rejected"]["total"], 0);
  ASSERT_FALSE(report["coverage_over"].empty());
  EXPECT_GT(report["coverage_over"].back()["coverage"], 0.9);
  EXPECT_GE(report["coverage_over"].back()["t_s"], report["coverage_over"].front()["t_s"]);

  for (const char* service : {"simulator", "mapper", "explorer", "controller"}) {
    std::string line;
    std::getline(std::ifstream(Out() / (std::string(service) + ".log")), line);
    const std::string domain = "DDS domain " + std::to_string(place_.domain()) + ", ";
    for (const std::string& part :
         {std::string("] scenario "), std::string("scenario.txtpb, "), domain, std::string("waits for ")}) {
      EXPECT_NE(line.find(part), std::string::npos) << service << " begins with: " << line;
    }
  }

  octomap::OcTree map(1.0);
  ASSERT_TRUE(map.readBinary((Out() / "map.bt").string()));
  EXPECT_DOUBLE_EQ(map.getResolution(), 0.1);
  EXPECT_GT(map.getNumLeafNodes(), 100U);
  for (const char* file : {"map.ot", "map.ply", "trajectory.tum", "report.png", "scenario.txtpb"}) {
    EXPECT_GT(std::filesystem::file_size(Out() / file), 0U) << file;
  }
}

TEST_F(RunSystemTest, LeavesTheMeshOfTheSurfaceIfAskedTo) {
  Start({"--surface"});
  ExpectComplete();
  EXPECT_THAT(Printed(), testing::ContainsRegex(
                             "m2 of surface seen of [0-9.]+ m2 that can be, [0-9.]+ m2 of it inspected"));
  const nlohmann::json surface = nlohmann::json::parse(std::ifstream(Out() / "report.json"))["surface"];
  EXPECT_GT(surface["observable_m2"], 10.0);
  EXPECT_GT(surface["seen_m2"], 0.8 * surface["observable_m2"].get<double>());
  EXPECT_LT(surface["seen_m2"], 1.2 * surface["observable_m2"].get<double>());
  EXPECT_THAT(Printed(), testing::HasSubstr("controller, simulator and surface."));
  std::ostringstream log;
  log << std::ifstream(Out() / "surface.log").rdbuf();
  const std::size_t at = log.str().rfind("surface: ", log.str().rfind(" m2 seen"));
  ASSERT_NE(at, std::string::npos) << log.str();
  const double seen = std::stod(log.str().substr(at + std::string("surface: ").size()));
  EXPECT_NEAR(surface["seen_m2"], seen, 0.06) << "the report has what the service ended with";
  std::string line;
  std::getline(std::ifstream(Out() / "map_surface.ply"), line);
  EXPECT_EQ(line, "ply");
  EXPECT_GT(std::filesystem::file_size(Out() / "map_surface.ply"), 100'000U);
  EXPECT_GT(std::filesystem::file_size(Out() / "checkpoint.surface"), 10'000U);
}

TEST_F(RunSystemTest, WarnsOfASurfaceThatTakesAllItMay) {
  Start({"--surface", "--set", "surface.most_memory_mb=1"});
  ExpectComplete();
  EXPECT_THAT(Printed(), testing::HasSubstr("warning: the surface takes surface.most_memory_mb"));
}

/// A port that somebody listens on, whoever that is.
class TakenPort {
 public:
  explicit TakenPort(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) listen(socket_, 1);
  }
  ~TakenPort() { close(socket_); }
  TakenPort(const TakenPort&) = delete;
  TakenPort& operator=(const TakenPort&) = delete;

 private:
  int socket_;
};

TEST_F(RunSystemTest, IsRecordedUnderItsNameAndShownByItsOwnGateway) {
  unsetenv("THALWEG_GATEWAY_PORT");
  const int usual = gateway::ListenOptions{}.port;
  const TakenPort taken(usual);
  Start({"--record", "--view"});
  const std::string open = "Open http://127.0.0.1:";
  const auto recording = Out() / "recording.mcap";
  ASSERT_TRUE(Until([&] {
    return OnTheWay() && Printed().find(open) != std::string::npos && pids_.contains("gateway");
  })) << Printed();
  EXPECT_NE(std::stoi(Printed().substr(Printed().find(open) + open.size())), usual);
  run_->Kill(SIGINT);
  ASSERT_TRUE(run_->WaitForEnd(60s)) << Printed();
  const Outcome info = OutcomeOf(BinFolder() + "/thalweg bag info --check " + recording.string());
  EXPECT_EQ(info.exit_code, 0) << info.text;
  EXPECT_NE(info.text.find("name: tiny\n"), std::string::npos) << info.text;
}

TEST_F(RunSystemTest, TinyRoomIsExploredFromMatchedPixelsAlone) {
  StartScenario("tiny_stereo");
  ExpectComplete(0.95);
  EXPECT_GT(Report()["coverage_over"].back()["coverage"], 0.9);
}

TEST_F(RunSystemTest, TinyRoomIsExploredFromItsCameraAloneCloudAndPose) {
  StartScenario("tiny_camera");
  ExpectComplete(0.95);
  EXPECT_GT(Report()["coverage_over"].back()["coverage"], 0.95);
}

/// The positions of a trajectory in TUM's format.
std::vector<Eigen::Vector3d> PlacesIn(const std::filesystem::path& file) {
  std::vector<Eigen::Vector3d> places;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    double time, x, y, z;
    if (std::istringstream(line) >> time >> x >> y >> z) places.emplace_back(x, y, z);
  }
  return places;
}

TEST_F(RunSystemTest, ARobotThatDrivesExploresTheBandThatItSweeps) {
  Start({"--set", "robot.radius_m=0.15", "--set", "robot.height_m=0.4", "--set", "robot.drives=true", "--set",
         "simulator.start_position_m={x: 0.9 y: 1.3 z: 0.35}"});
  ExpectComplete(0.95);
  EXPECT_GT(Report()["coverage_over"].back()["coverage"], 0.95);
  const std::vector<Eigen::Vector3d> places = PlacesIn(Out() / "trajectory.tum");
  ASSERT_GT(places.size(), 10U);
  for (const Eigen::Vector3d& p_W : places) EXPECT_NEAR(p_W.z(), 0.35, 1e-6);
}

TEST_F(RunSystemTest, ARobotIsHomeBeforeItsBudgetIsSpent) {
  constexpr double kBudget = 2.5;  // [m] too little for the whole room
  Start({"--set", "explorer.return_home=true", "--set",
         "explorer.distance_budget_m=" + std::to_string(kBudget)});
  const auto status = run_->WaitForEnd(200s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 0) << Printed();
  const auto report = Report();
  EXPECT_EQ(report["outcome"], "distance_budget");
  EXPECT_EQ(report["succeeded"], true);
  EXPECT_EQ(report["stop_reason"], "home within the distance budget");
  EXPECT_EQ(report["true_collisions"], 0);
  EXPECT_LE(report["distance_m"], kBudget);
  const std::vector<Eigen::Vector3d> places = PlacesIn(Out() / "trajectory.tum");
  ASSERT_GT(places.size(), 10U);
  EXPECT_LT((places.back() - Eigen::Vector3d(0.9, 1.3, 0.8)).norm(), 0.2);
}

TEST_F(RunSystemTest, IsCompletedAlthoughTheExplorerIsKilled) {
  Start({"--respawn"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  kill(PidOf("explorer"), SIGKILL);
  ExpectComplete();
  EXPECT_NE(Printed().find("explorer ended with signal 9 (Killed); restarted"), std::string::npos);
}

TEST_F(RunSystemTest, IsCompletedAlthoughTheMapperIsKilled) {
  Start({"--respawn", "--set", "mapper.checkpoint_period_s=1"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  kill(PidOf("mapper"), SIGKILL);
  ExpectComplete();
  EXPECT_NE(Printed().find("mapper ended with signal 9 (Killed); restarted"), std::string::npos);
}

/// Runs that leave their map to others, and whoever hears how it grows.
class RunWithItsMap : public RunSystemTest {
 protected:
  RunWithItsMap() {
    bus_.Subscribe<dds::topics::MapUpdates>([this](const thalweg_msgs::msg::MapUpdate& update) {
      EXPECT_TRUE(replica_.Apply(update));
      if (!replica_.missing()) {
        heard_.insert_or_assign(replica_.number(), mapper::CopyOf(replica_.grid()));
      } else {
        requests_.Write(replica_.MakeRequest(bus_.Now(), "test"));
      }
    });
  }
  /// Copies what a mapper needs to resume into a new folder.
  std::filesystem::path FolderToResumeIn(const std::string& name) const {
    const auto folder = place_.folder() / name;
    std::filesystem::create_directories(folder);
    for (const char* const file : {"checkpoint.map", "checkpoint.journal"}) {
      std::filesystem::copy_file(Out() / file, folder / file);
    }
    return folder;
  }

  dds::Bus::Publisher<dds::topics::MapRequests> requests_ = bus_.Advertise<dds::topics::MapRequests>();
  dds::MapReplica replica_;
  std::map<std::uint64_t, OccupancyGrid> heard_;  ///< The map after each scan of the mapper, by its number.
};

TEST_F(RunWithItsMap, AKilledMapperLeavesAllScansButTheLastOnDiskAndAnotherRunGoesOnFromThere) {
  Start({"--set", "mapper.checkpoint_period_s=3600"});
  ASSERT_TRUE(Until([this] { return OnTheWay() && heard_.size() > 3; })) << Printed();
  kill(PidOf("mapper"), SIGKILL);
  ASSERT_TRUE(run_->WaitForEnd(60s));
  const auto stored = mapper::LoadStoredMap(Out() / "checkpoint.map");
  ASSERT_TRUE(stored && stored->has_value());
  const std::uint64_t number = (*stored)->checkpoint.position.number;
  bus_.SpinUntil([&] { return heard_.contains(number); }, 5s);  // it may still be on its way
  EXPECT_GE(number + 1, heard_.rbegin()->first);
  ASSERT_TRUE(heard_.contains(number)) << number;
  EXPECT_TRUE((*stored)->checkpoint.grid.SameAs(heard_.at(number)));

  const auto more = FolderToResumeIn("more");
  const auto elsewhere = FolderToResumeIn("elsewhere");
  run_.emplace("thalweg", std::vector<std::string>{"run", "tiny", "--out", more}, Screen());
  const auto status = run_->WaitForEnd(200s);
  ASSERT_TRUE(status);
  EXPECT_TRUE(WIFEXITED(*status) && WEXITSTATUS(*status) == 0) << Printed();
  EXPECT_NE(Printed().find("The mapper resumes from checkpoint.map"), std::string::npos) << Printed();
  std::ostringstream log;
  log << std::ifstream(more / "mapper.log").rdbuf();
  EXPECT_NE(log.str().find("after " + std::to_string(number) + " scans"), std::string::npos) << log.str();
  EXPECT_NE(log.str().find("checkpoint.map agrees with"), std::string::npos) << log.str();

  // The same start in another building.
  run_.emplace(
      "thalweg",
      std::vector<std::string>{"run", "kitchen", "--set", "simulator.start_position_m={x: 0.9 y: 1.3 z: 0.8}",
                               "--out", elsewhere},
      Screen());
  ASSERT_TRUE(run_->WaitForEnd(60s)) << Printed();
  EXPECT_NE(Printed().find("checkpoint.map is of another place"), std::string::npos) << Printed();
  EXPECT_NE(Printed().find("choose another --out or remove the file"), std::string::npos) << Printed();
}

TEST_F(RunSystemTest, IsCompletedAlthoughTheControllerIsKilledAndRestartedByHand) {
  Start({"--keep-going"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  kill(PidOf("controller"), SIGKILL);
  const RunningProgram controller("thalweg-controller",
                                  {"--scenario", Out() / "scenario.txtpb", "--out", Out()},
                                  place_.folder() / "controller-2.log");
  ExpectComplete();
}

TEST_F(RunSystemTest, DeathOfAProcessEndsTheRunWithItsName) {
  Start();
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  kill(PidOf("mapper"), SIGKILL);
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_NE(WEXITSTATUS(*status), 0);
  EXPECT_EQ(Report()["stop_reason"].get<std::string>().find("mapper ended with signal 9 (Killed)"), 0U);
}

TEST_F(RunSystemTest, AProcessThatCannotStartIsReportedWithItsOwnWords) {
  Start({"--set", "odometry_source=VISUAL_ODOMETRY", "--set", "visual_odometry.source=FILE", "--set",
         "visual_odometry.file=/nowhere.tum"});
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 1);
  const std::string log = (Out() / "visual-odometry.log").string();
  EXPECT_NE(Printed().find("failed: visual-odometry ended with exit code 1; the last lines of " + log +
                           ":\n    visual-odometry: /nowhere.tum: cannot be read"),
            std::string::npos)
      << Printed();
  EXPECT_EQ(Report()["stop_reason"], "visual-odometry ended with exit code 1");
}

TEST_F(RunSystemTest, AStartWhereTheRobotDoesNotFitIsReportedBeforeAnythingIsStarted) {
  Start({"--set", "simulator.start_position_m={x: 0.05 y: 0.05 z: 0.05}"});
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 1);
  EXPECT_NE(Printed().find("thalweg: simulator.start_position_m: a robot of radius 0.1 m does not fit"),
            std::string::npos)
      << Printed();
  EXPECT_FALSE(std::filesystem::exists(Out()));
}

TEST_F(RunSystemTest, ASecondRunInTheDomainIsRefusedAndDoesNotDisturbTheFirst) {
  Start();
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  const auto second_out = place_.folder() / "second";
  const auto second_screen = place_.folder() / "second.txt";
  RunningProgram second("thalweg", {"run", "tiny", "--out", second_out}, second_screen);
  const auto status = second.WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 1);
  std::ostringstream printed;
  printed << std::ifstream(second_screen).rdbuf();
  EXPECT_NE(
      printed.str().find("thalweg: another run is going on in DDS domain " + std::to_string(place_.domain())),
      std::string::npos)
      << printed.str();
  EXPECT_FALSE(std::filesystem::exists(second_out / "simulator.log"));
  ExpectComplete();
}

TEST_F(RunSystemTest, PrintsItsScenarioAndExploresNothing) {
  Start({"--print-scenario", "--set", "mapper.voxel_size_m=0.05"});
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 0) << Printed();
  EXPECT_NE(Printed().find("  voxel_size_m: 0.05\n"), std::string::npos) << Printed();
  EXPECT_NE(Printed().find("  radius_m: 0.1  # default\n"), std::string::npos) << Printed();
  EXPECT_FALSE(std::filesystem::exists(Out()));
}

TEST_F(RunSystemTest, AnOutsideProcessTakesTheExplorersPlace) {
  Start({"--without", "explorer"});
  const RunningProgram explorer("thalweg-example-outside-explorer", {"--scenario", "tiny"},
                                place_.folder() / "outside.log");
  const auto status = run_->WaitForEnd(100s);
  ASSERT_TRUE(status && WIFEXITED(*status)) << Printed();
  EXPECT_NE(WEXITSTATUS(*status), 0) << "it has explored nothing to the end";
  const auto report = Report();
  EXPECT_EQ(report["stop_reason"], "enough") << Printed();
  EXPECT_TRUE(report["outcome"].is_null());
  EXPECT_EQ(report["strategy"], "outside");
  EXPECT_EQ(report["true_collisions"], 0);
  EXPECT_GT(report["distance_m"], 0.5);
  EXPECT_FALSE(std::filesystem::exists(Out() / "explorer.log"));
}

TEST_F(RunSystemTest, AServiceThatIsNotThereCannotBeLeftOut) {
  Start({"--without", "stereo"});
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 1);
  EXPECT_NE(Printed().find("--without stereo: the scenario has no such service; it has mapper, explorer, "
                           "controller and simulator"),
            std::string::npos)
      << Printed();
}

TEST_F(RunSystemTest, ProgramsGetOneJsonObjectALine) {
  Start({"--json"});
  const auto status = run_->WaitForEnd(200s);
  ASSERT_TRUE(status && WIFEXITED(*status)) << Printed();
  std::map<std::string, int> events;
  nlohmann::json last;
  std::istringstream lines(Printed());
  for (std::string line; std::getline(lines, line); ++events[last["event"]]) {
    last = nlohmann::json::parse(line);  // throws on anything else
  }
  EXPECT_EQ(events["start"], 1);
  EXPECT_GE(events["progress"], 2);
  EXPECT_EQ(last["event"], "end");
  EXPECT_EQ(last["exit_code"], WEXITSTATUS(*status));
  EXPECT_EQ(last["report"]["stop_reason"], "complete");
}

TEST_F(RunSystemTest, CtrlCEndsAllProcessesAndStillLeavesAReport) {
  Start();
  ASSERT_TRUE(Until([this] { return OnTheWay() && pids_.size() >= 5; })) << Printed();
  for (int k = 0; k < 2; ++k) run_->Kill(SIGINT);  // as timeout(1) does, to the process and to its group
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_NE(WEXITSTATUS(*status), 0);
  EXPECT_EQ(Report()["stop_reason"], "interrupted");
  EXPECT_TRUE(std::filesystem::exists(Out() / "report.png"));
  for (const auto& [service, pid] : pids_) EXPECT_EQ(kill(pid, 0), -1) << service << " still runs";
}

TEST_F(RunSystemTest, CtrlCStopsTheRobotFirstAndStillLeavesTheMesh) {
  Start({"--surface"});
  ASSERT_TRUE(Until([this] { return OnTheWay(); })) << Printed();
  run_->Kill(SIGINT);
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_NE(WEXITSTATUS(*status), 0);
  EXPECT_EQ(Report()["stop_reason"], "interrupted");
  EXPECT_GT(std::filesystem::file_size(Out() / "map_surface.ply"), 1000U);
}

/// A disk of its own at a folder, until destroyed; needs the right to mount.
class SmallDisk {
 public:
  SmallDisk(const std::filesystem::path& folder, const char* options) : folder_(folder) {
    std::filesystem::create_directories(folder);
    mounted_ = mount("tmpfs", folder.c_str(), "tmpfs", 0, options) == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  std::filesystem::path folder_;
  bool mounted_ = false;
};

class RunWithoutRoomForItsFiles : public RunSystemTest {
 protected:
  /// Expects that the run is complete, says what is missing, and shows its result before that.
  void ExpectResultWithoutFiles(const std::string& reason) {
    const auto status = run_->WaitForEnd(200s);
    ASSERT_TRUE(status && WIFEXITED(*status)) << Printed();
    EXPECT_EQ(WEXITSTATUS(*status), 3) << Printed();
    const std::string printed = Printed();
    const std::string journal = (Out() / "checkpoint.journal").string() + ": cannot be written: " + reason;
    const auto warned = printed.find("warning: mapper: " + journal + "; the run continues\n");
    const auto result = printed.find("\ncomplete: ");
    const auto missing = printed.find("\nnot saved: mapper ended with exit code 1");
    EXPECT_LT(warned, result) << printed;
    EXPECT_LT(result, missing) << printed;
    EXPECT_LT(missing, printed.size()) << printed;
    for (const auto& entry : std::filesystem::directory_iterator(Out())) {
      EXPECT_NE(entry.path().extension(), ".unfinished") << entry.path();
    }
  }
};

TEST_F(RunWithoutRoomForItsFiles, GoesOnWhenTheDiskFillsUp) {
  const SmallDisk disk(Out(), "size=120k");
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a small disk";
  Start({"--set", "mapper.checkpoint_period_s=1"});
  ExpectResultWithoutFiles("No space left on device");
}

TEST_F(RunWithoutRoomForItsFiles, GoesOnWhenItsFilesMayNotGrow) {
  {
    const FileSizeLimit limit(60'000);
    Start({"--set", "mapper.checkpoint_period_s=1", "--set", "network.shared_memory=false"});
  }
  ExpectResultWithoutFiles("File too large");
}

TEST_F(RunWithoutRoomForItsFiles, IsCompletedAndReportedAlthoughThereIsNoRoomForItsRecording) {
  const SmallDisk disk(place_.folder() / "recordings", "size=2m");
  if (!disk.mounted()) GTEST_SKIP() << "may not mount a small disk";
  const std::filesystem::path recording = place_.folder() / "recordings" / "a.mcap";
  Start({"--record=" + recording.string()});
  const auto status = run_->WaitForEnd(200s);
  ASSERT_TRUE(status && WIFEXITED(*status)) << Printed();
  EXPECT_EQ(WEXITSTATUS(*status), 3) << Printed();
  const std::string printed = Printed();
  const std::string reason = recording.string() + ": ends here, since less than 500 MB are free on its disk";
  const auto result = printed.find("\ncomplete: ");
  EXPECT_LT(result, printed.size()) << printed;
  EXPECT_LT(printed.find(reason), printed.size()) << printed;
  EXPECT_LT(printed.find("\nnot saved: ", result), printed.size()) << printed;
  EXPECT_EQ(Report()["stop_reason"], "complete");
  EXPECT_TRUE(std::filesystem::exists(Out() / "map.bt"));
  const Outcome info = OutcomeOf(BinFolder() + "/thalweg bag info --check " + recording.string());
  EXPECT_EQ(info.exit_code, 0) << "what is there is whole: " << info.text;
}

TEST_F(RunSystemTest, ThatFilesCanBeWrittenAgainIsReportedAndNoScanIsMissing) {
  {
    const FileSizeLimit limit(20'000);
    Start({"--set", "mapper.checkpoint_period_s=0.2", "--set", "network.shared_memory=false"});
  }
  const auto printed = [this](const char* text) {
    return Until([&] { return Printed().find(text) != std::string::npos; });
  };
  ASSERT_TRUE(printed("checkpoint.journal: cannot be written: File too large; the run continues\n"))
      << Printed();
  const rlimit none{.rlim_cur = RLIM_INFINITY, .rlim_max = RLIM_INFINITY};
  for (const auto& [service, pid] : pids_) prlimit(pid, RLIMIT_FSIZE, &none, nullptr);
  prlimit(run_->pid(), RLIMIT_FSIZE, &none, nullptr);
  EXPECT_TRUE(printed("checkpoint.map can be written again, and no scan is missing; the run continues\n"))
      << Printed();
  ExpectComplete();
  const auto stored = mapper::LoadStoredMap(Out() / "checkpoint.map");
  ASSERT_TRUE(stored && stored->has_value());
  EXPECT_EQ((*stored)->journal.problem, "");
}

TEST_F(RunSystemTest, AFolderThatCannotBeWrittenIsReportedBeforeAnythingIsStarted) {
  std::ofstream(place_.folder() / "file") << "a file where a folder should be";
  const std::string out = place_.folder() / "file" / "run";
  run_.emplace("thalweg", std::vector<std::string>{"run", "tiny", "--out", out}, Screen());
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 1);
  EXPECT_EQ(Printed(), "thalweg: " + out + ": cannot be written: Not a directory\n");
}

TEST_F(RunSystemTest, TheMachinesClockIsRefusedWithTheSimulatorAndTakenWithoutIt) {
  Start({"--set", "network.wall_clock=true"});
  const auto status = run_->WaitForEnd(60s);
  ASSERT_TRUE(status && WIFEXITED(*status));
  EXPECT_EQ(WEXITSTATUS(*status), 1);
  EXPECT_NE(Printed().find("--set network.wall_clock=true: network.wall_clock: is true"), std::string::npos)
      << Printed();
  EXPECT_NE(Printed().find("world.file"), std::string::npos) << Printed();
  run_.emplace("thalweg",
               std::vector<std::string>{"run", "tiny", "--set", "network.wall_clock=true", "--without",
                                        "simulator", "--out", place_.folder() / "own"},
               Screen());
  EXPECT_TRUE(Until([this] { return Printed().find("no pose") != std::string::npos; })) << Printed();
}

TEST_F(RunSystemTest, ProcessesEndWhenThalwegIsKilled) {
  Start();
  ASSERT_TRUE(Until([this] { return OnTheWay() && pids_.size() >= 5; })) << Printed();
  std::map<std::string, int> handles;
  for (const auto& [service, pid] : pids_) {
    handles[service] = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  }
  run_->Kill(SIGKILL);
  for (const auto& [service, handle] : handles) {
    pollfd end{.fd = handle, .events = POLLIN, .revents = 0};
    EXPECT_EQ(poll(&end, 1, 15'000), 1) << service << " still runs";
    close(handle);
  }
}

TEST_F(RunSystemTest, TwoRobotsWithNamesExploreOnOneNetworkWithoutHearingEachOther) {
  const std::filesystem::path other = place_.folder() / "rover";
  RunningProgram rover("thalweg", {"run", "tiny", "--set", "robot.name=rover", "--out", other.string()},
                       place_.folder() / "rover.txt");
  Start({"--set", "robot.name=scout"});
  ExpectComplete();
  const auto status = rover.WaitForEnd(std::chrono::seconds(200));
  ASSERT_TRUE(status);
  EXPECT_TRUE(WIFEXITED(*status) && WEXITSTATUS(*status) == 0) << cli::DescribeEnd(*status);
  for (const auto& folder : {Out(), other}) {
    const auto report = nlohmann::json::parse(std::ifstream(folder / "report.json"));
    EXPECT_EQ(report["true_collisions"], 0);
    EXPECT_EQ(report["messages_rejected"]["total"], 0) << report["messages_rejected"];
  }
  EXPECT_TRUE(pids_.empty()) << "a tool without a robot's name hears neither";
}

}  // namespace
}  // namespace thalweg::test
