// Explores a scenario once for each fault, provokes the fault while the robot moves, and prints what became
// of the robot as a row of a Markdown table. tests/faults/run starts it.

#include <fmt/format.h>
#include <poll.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "services/cli/process/child_process.h"

namespace thalweg::test {
namespace {

namespace fs = std::filesystem;
namespace topics = dds::topics;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""us;
using Steady = std::chrono::steady_clock;

struct Args {
  std::string scenario = "tiny";
  fs::path bin;
  fs::path out;
  int domain = 90;
  std::vector<std::string> only;
};

dds::BusOptions BusOptionsFor(const Args& args, const std::string& partition) {
  dds::BusOptions options;
  options.name = "faults";
  options.domain = args.domain;
  options.partition = partition;
  options.publish_health = false;
  return options;
}

/// When the robot came to rest after a moment and when it moved again, by its odometry, on the run's clock.
class Rest {
 public:
  void Add(Time stamp, const Eigen::Vector3d& p_W) {
    constexpr double kLeastStep = 1e-4;  // [m] between two poses
    constexpr auto kRest = 300ms;
    if (p_W_ && (p_W - *p_W_).norm() > kLeastStep) {
      if (stood_ && !went_on_) went_on_ = stamp;
      moved_ = stamp;
    } else if (begun_ && !stood_ && stamp - std::max(moved_, *begun_) >= kRest) {
      stood_ = std::max(moved_, *begun_);
    }
    p_W_ = p_W;
    now_ = stamp;
  }
  void Begin() { begun_ = now_; }
  void End() { ended_ = now_; }  ///< The fault is over.
  bool moving() const { return now_ - moved_ < 100ms; }
  bool went_on() const { return went_on_.has_value(); }

  std::string StoodText() const {
    return stood_ ? fmt::format("{:.2f} s", Seconds(*stood_ - *begun_)) : "continues";
  }
  std::string WentOnText() const {
    if (!stood_) return "-";
    if (!went_on_) return "stays";
    return *went_on_ <= ended_ ? "during the fault" : fmt::format("{:.2f} s", Seconds(*went_on_ - ended_));
  }

 private:
  std::optional<Eigen::Vector3d> p_W_;
  Time now_;
  Time moved_;
  Time ended_;
  std::optional<Time> begun_;
  std::optional<Time> stood_;
  std::optional<Time> went_on_;
};

/// A run of all processes, observed over the bus.
class Run {
 public:
  Run(const Args& args, const std::string& name, const std::vector<std::string>& more)
      : folder_(args.out / name),
        bus_(BusOptionsFor(args, name)),
        path_out_(bus_.Advertise<topics::Path>()),
        request_out_(bus_.Advertise<topics::MapRequests>()) {
    bus_.Subscribe<topics::Health>(
        [this](const auto& message) { pids_[message.service()] = static_cast<pid_t>(message.process_id()); });
    bus_.Subscribe<topics::Odometry>([this](const auto& message) {
      const auto pose = dds::FromIdl(message);
      if (pose) rest_.Add(pose->stamp, pose->T.translation());
    });
    bus_.Subscribe<topics::SimulationStatus>([this](const auto& message) { simulation_ = message; });
    bus_.EveryWall(10ms, [] {});  // conditions are checked after each event, also when nothing is heard
    fs::create_directories(folder_.parent_path());
    setenv("THALWEG_DOMAIN", std::to_string(args.domain).c_str(), 1);
    setenv("THALWEG_PARTITION", name.c_str(), 1);
    cli::Program program{.name = "thalweg",
                         .executable = args.bin / "thalweg",
                         .arguments = {"run", args.scenario, "--respawn", "--out", folder_.string(), "--set",
                                       "simulator.time_scale=1", "--set", "mapper.checkpoint_period_s=1"},
                         .log = args.out / (name + ".screen")};
    program.arguments.insert(program.arguments.end(), more.begin(), more.end());
    pid_ = cli::StartProcess(program);
  }
  ~Run() {
    if (!status_) kill(pid_, SIGTERM);
    while (!Ended()) bus_.SpinUntil([] { return false; }, 50ms);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  bool Ended() {
    int status = 0;
    if (!status_ && waitpid(pid_, &status, WNOHANG) == pid_) status_ = status;
    return status_.has_value();
  }
  bool Until(const std::function<bool()>& done, Duration limit) {
    return bus_.SpinUntil([&] { return done() || Ended(); }, limit) && done();
  }
  void For(Duration time) {
    Until([] { return false; }, time);
  }
  bool IsUnderWay() const { return simulation_ && simulation_->distance_m() > 0.3 && rest_.moving(); }
  pid_t PidOf(const std::string& service) const {
    const auto found = pids_.find(service);
    if (found == pids_.end()) throw std::runtime_error(service + " was not heard");
    return found->second;
  }

  /// Exit code, coverage, collisions and what was refused, as the run reports them.
  std::string Outcome() {
    Until([] { return false; }, 240s);
    if (!status_) return "does not end within 240 s";
    const std::string end = WIFEXITED(*status_) ? fmt::format("exit {}", WEXITSTATUS(*status_)) : "died";
    std::ifstream in(folder_ / "report.json");
    if (!in) return end + ", no report";
    const auto report = nlohmann::json::parse(in);
    return fmt::format("{}, {}; coverage {:.1f} %, {} collisions, {} messages refused", end,
                       report["stop_reason"].get<std::string>(), 100.0 * report["coverage"].get<double>(),
                       report["true_collisions"].get<int>(), report["messages_rejected"]["total"].get<int>());
  }

  fs::path folder_;
  dds::Bus bus_;
  dds::Bus::Publisher<topics::Path> path_out_;
  dds::Bus::Publisher<topics::MapRequests> request_out_;
  Rest rest_;
  std::optional<thalweg_msgs::msg::SimulationStatus> simulation_;

 private:
  std::map<std::string, pid_t> pids_;
  pid_t pid_ = 0;
  std::optional<int> status_;
};

struct Fault {
  std::string name;
  std::string text;
  std::vector<std::string> options;
  std::function<void(Run&, const Args&)> provoke;
};

Fault Killed(const std::string& service) {
  return {"kill-" + service, "`kill -9` of the " + service, {}, [=](Run& run, const Args&) {
            kill(run.PidOf(service), SIGKILL);
          }};
}

Fault Stopped(std::string name, const std::string& service, Duration time, std::string text,
              std::vector<std::string> options) {
  return {std::move(name), std::move(text), std::move(options), [=](Run& run, const Args&) {
            const pid_t pid = run.PidOf(service);
            kill(pid, SIGSTOP);
            run.For(time);
            kill(pid, SIGCONT);
          }};
}

void StartSecondMapper(Run& run, const Args& args) {
  const fs::path folder = args.out / "second-mapper";
  fs::create_directories(folder);
  const pid_t pid = cli::StartProcess({.name = "mapper",
                                       .executable = args.bin / "thalweg-mapper",
                                       .arguments = {"--scenario", args.scenario, "--out", folder.string()},
                                       .log = args.out / "second-mapper.log"});
  int status = 0;
  if (!run.Until([&] { return waitpid(pid, &status, WNOHANG) == pid; }, 30s)) {
    kill(pid, SIGKILL);
    waitpid(pid, &status, 0);
  }
}

/// Sends once per period for some time, on a thread of its own, so that the run is observed meanwhile.
void Repeat(Run& run, const std::function<void()>& send, Duration period, Duration time) {
  const std::jthread sender([&](const std::stop_token& stop) {
    for (auto next = Steady::now(); !stop.stop_requested(); next += period) {
      send();
      std::this_thread::sleep_until(next + period);
    }
  });
  run.For(time);
}

/// A straight path of 100 m, which leads through a wall wherever the robot is.
void ForgePaths(Run& run, Duration period, Duration time) {
  const auto T_WB = dds::FromIdl(run.simulation_->map_from_body_true());
  RigidTransform end = *T_WB;
  end.translation().x() += 100.0;
  const auto message = dds::ToIdl(dds::StampedPath{Time{} + 1s, {*T_WB, end}});
  Repeat(
      run, [&] { run.path_out_.Write(message); }, period, time);
}

void FloodWithRequests(Run& run, const Args&) {
  thalweg_msgs::msg::MapRequest request;
  request.header(dds::MakeHeader(Time{} + 1s, dds::kMapFrame));
  request.reader("flood");
  Repeat(
      run, [&] { run.request_out_.Write(request); }, 100us, 5s);
}

std::vector<Fault> AllFaults() {
  std::vector<Fault> faults{{"none", "none", {}, [](Run&, const Args&) {}}};
  for (const char* service : {"mapper", "explorer", "controller"}) faults.push_back(Killed(service));
  for (const std::string service : {"mapper", "explorer", "controller"}) {
    faults.push_back(Stopped("stop-" + service, service, 5s, "`SIGSTOP` of the " + service + " for 5 s", {}));
  }
  faults.push_back(Stopped("cut-home", "explorer", 15s,
                           "explorer cut off for 15 s, `on_cut_off: HOME` after 2 s",
                           {"--set", "controller.on_cut_off=HOME", "--set", "controller.cut_off_after_s=2"}));
  faults.push_back(Stopped("cut-go-on", "explorer", 15s, "explorer cut off for 15 s, `on_cut_off: GO_ON`",
                           {"--set", "controller.on_cut_off=GO_ON", "--set", "controller.check_paths=true"}));
  faults.push_back({"second-copy", "a second mapper is started", {}, StartSecondMapper});
  faults.push_back(
      {"forged-path", "a stranger sends a path through a wall, for 5 s", {}, [](Run& run, const Args&) {
         ForgePaths(run, 100ms, 5s);
       }});
  faults.push_back({"forged-alone", "the same while the explorer is stopped", {}, [](Run& run, const Args&) {
                      const pid_t explorer = run.PidOf("explorer");
                      kill(explorer, SIGSTOP);
                      ForgePaths(run, 100ms, 8s);
                      kill(explorer, SIGCONT);
                    }});
  faults.push_back(
      {"flood-path", "5 s of forged paths, up to 10 000 a second", {}, [](Run& run, const Args&) {
         ForgePaths(run, 100us, 5s);
       }});
  faults.push_back({"flood-requests", "5 s of map requests, up to 10 000 a second", {}, FloodWithRequests});
  faults.push_back({"full-disk", "the disk of the run is full (120 kB)", {}, [](Run&, const Args&) {}});
  return faults;
}

void Measure(const Fault& fault, const Args& args) {
  const fs::path folder = args.out / fault.name;
  const bool own_disk = fault.name == "full-disk";
  if (own_disk) {
    fs::create_directories(folder);
    if (mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=120k") != 0) {
      fmt::print("| {} | not measured: may not mount a disk | | |\n", fault.text);
      return;
    }
  }
  {
    Run run(args, fault.name, fault.options);
    if (!run.Until([&] { return run.IsUnderWay(); }, 60s)) {
      throw std::runtime_error(fault.name + ": the robot does not move, see " + folder.string() + ".screen");
    }
    run.rest_.Begin();
    fault.provoke(run, args);
    run.rest_.End();
    run.Until([&] { return run.rest_.went_on(); }, 30s);
    const std::string outcome = run.Outcome();
    fmt::print("| {} | {} | {} | {} |\n", fault.text, run.rest_.StoodText(), run.rest_.WentOnText(), outcome);
    std::fflush(stdout);
  }
  if (own_disk) umount2(folder.c_str(), MNT_DETACH);
}

int Main(int argc, char** argv) {
  Args args;
  CLI::App app("Measures what faults do to a run.");
  app.add_option("--scenario", args.scenario)->capture_default_str();
  app.add_option("--bin", args.bin)->required();
  app.add_option("--out", args.out)->required();
  app.add_option("--domain", args.domain)->capture_default_str();
  app.add_option("--fault", args.only, "Only these")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  fmt::print("| fault | stands after | goes on after its end | outcome |\n|---|---|---|---|\n");
  std::fflush(stdout);
  for (const Fault& fault : AllFaults()) {
    if (args.only.empty() || std::ranges::count(args.only, fault.name) > 0) Measure(fault, args);
  }
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace thalweg::test

int main(int argc, char** argv) try {
  return thalweg::test::Main(argc, argv);
} catch (const std::exception& error) {
  std::cerr << "measure: " << error.what() << '\n';
  return EXIT_FAILURE;
}
