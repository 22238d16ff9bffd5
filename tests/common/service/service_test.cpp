#include "common/service/service.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

namespace thalweg {
namespace {

/// Sets an environment variable, or unsets it if null, until destroyed.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before;
    Set(value);
  }
  ~Variable() { Set(before_ ? before_->c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void Set(const char* value) {
    if (value != nullptr) {
      setenv(name_, value, 1);
    } else {
      unsetenv(name_);
    }
  }

  const char* name_;
  std::optional<std::string> before_;
};

ServiceArgs Parse(std::initializer_list<const char*> args) {
  std::vector<std::string> strings = {"thalweg-mapper"};
  strings.insert(strings.end(), args.begin(), args.end());
  std::vector<char*> pointers;
  for (std::string& text : strings) pointers.push_back(text.data());
  return ParseServiceArgs(static_cast<int>(pointers.size()), pointers.data(), "mapper", "draws the map");
}

TEST(ParseServiceArgs, ReadsWhatIsThere) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("thalweg_service_test_out_" + std::to_string(getpid()));
  const std::string out = folder.string();
  const ServiceArgs args = Parse({"--scenario", "flat", "--set", "mapper.fill=true", "--set",
                                  "robot.radius_m=0.2", "--domain", "7", "--out", out.c_str()});
  EXPECT_EQ(args.scenario, "flat");
  EXPECT_EQ(args.overrides, (std::vector<std::string>{"mapper.fill=true", "robot.radius_m=0.2"}));
  EXPECT_EQ(args.domain, 7);
  EXPECT_EQ(args.out, out);
  std::filesystem::remove_all(folder);
}

TEST(ParseServiceArgs, AFolderThatCannotBeWrittenIsRefusedAtOnce) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("thalweg_service_test_" + std::to_string(getpid()));
  std::ofstream(file) << "a file where a folder should be";
  const std::string out = (file / "run").string();
  try {
    Parse({"--out", out.c_str()});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), out + ": cannot be written: Not a directory");
  }
  std::filesystem::remove(file);
}

TEST(ParseServiceArgs, KeepsTheDefaultsOtherwise) {
  const ServiceArgs args = Parse({});
  EXPECT_EQ(args.scenario, ServiceArgs{}.scenario);
  EXPECT_EQ(args.domain, -1);
  EXPECT_EQ(args.out, ".");
}

TEST(ParseServiceArgs, TakesTheScenarioFromTheEnvironment) {
  const Variable scenario("THALWEG_SCENARIO", "flat");
  EXPECT_EQ(Parse({}).scenario, "flat");
  EXPECT_EQ(Parse({"--scenario", "kitchen"}).scenario, "kitchen");
}

TEST(ParseServiceArgsDeathTest, EndsOnAMistakeAndOnHelp) {
  EXPECT_EXIT(Parse({"--domain", "233"}), testing::ExitedWithCode(2), "^mapper: --domain: .*233");
  EXPECT_EXIT(Parse({"--spped", "3"}), testing::ExitedWithCode(2), "^mapper: .*--spped");
  EXPECT_EXIT(Parse({"--help"}), testing::ExitedWithCode(0), "");
}

TEST(ParseServiceArgsDeathTest, HelpBeginsWithWhatTheProgramDoes) {
  const auto help_on_stderr = [] {
    dup2(STDERR_FILENO, STDOUT_FILENO);
    Parse({"--help"});
  };
  EXPECT_EXIT(help_on_stderr(), testing::ExitedWithCode(0), "^thalweg-mapper: draws the map\\.\n");
}

/// Stands in for a service: waits for the stop request and reports it by its exit code.
[[noreturn]] void WaitForStop(int signal) {
  const std::stop_token stop = StopOnSignals();
  kill(getpid(), signal);
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  wake.wait(lock, stop, [] { return false; });
  std::_Exit(stop.stop_requested() ? 42 : 1);
}

/// Keeps running after a stop request, though it is asked again and again.
[[noreturn]] void IgnoreTheFirst() {
  const std::stop_token stop = StopOnSignals();
  for (;;) {
    kill(getpid(), SIGTERM);
    std::this_thread::yield();
  }
}

/// Is asked a hundred times at once, and then ends by itself.
[[noreturn]] void TakeAllForOne() {
  const std::stop_token stop = StopOnSignals();
  for (int k = 0; k < 100; ++k) {
    kill(getpid(), SIGINT);
    sigset_t pending;
    do sigpending(&pending);
    while (sigismember(&pending, SIGINT) == 1);
  }
  std::_Exit(stop.stop_requested() ? 42 : 1);
}

TEST(StopOnSignalsDeathTest, AsksToStopOnInterruptAndTermination) {
  EXPECT_EXIT(WaitForStop(SIGINT), testing::ExitedWithCode(42), "");
  EXPECT_EXIT(WaitForStop(SIGTERM), testing::ExitedWithCode(42), "");
}

/// Reports by its exit code whether a closed terminal is a signal to wait for.
[[noreturn]] void TakeHangupsAs(void (*disposition)(int)) {
  std::signal(SIGHUP, disposition);
  StopOnSignals();
  sigset_t blocked;
  pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
  std::_Exit(sigismember(&blocked, SIGHUP) == 1 ? 42 : 1);
}

TEST(StopOnSignalsDeathTest, AClosedTerminalAsksToStopUnlessTheCallerAskedToIgnoreThat) {
  const auto closed = [] {
    std::signal(SIGHUP, SIG_DFL);
    WaitForStop(SIGHUP);
  };
  EXPECT_EXIT(closed(), testing::ExitedWithCode(42), "");
  EXPECT_EXIT(TakeHangupsAs(SIG_DFL), testing::ExitedWithCode(42), "");
  EXPECT_EXIT(TakeHangupsAs(SIG_IGN), testing::ExitedWithCode(1), "");
}

TEST(StopOnSignalsDeathTest, EndsAtOnceWhenAskedAgain) {
  EXPECT_EXIT(IgnoreTheFirst(), testing::ExitedWithCode(128 + SIGTERM), "");
}

TEST(StopOnSignalsDeathTest, SignalsThatComeTogetherAreOneRequest) {
  EXPECT_EXIT(TakeAllForOne(), testing::ExitedWithCode(42), "");
}

TEST(BusOptionsFrom, CommandLineWinsOverEnvironmentOverScenario) {
  const Variable of_the_shell("THALWEG_DOMAIN", nullptr);
  Scenario scenario;
  ServiceArgs args;
  EXPECT_EQ(BusOptionsFrom(scenario, args, "mapper").domain, dds::BusOptions{}.domain);
  scenario.mutable_network()->set_domain(3);
  EXPECT_EQ(BusOptionsFrom(scenario, args, "mapper").domain, 3);
  const Variable domain("THALWEG_DOMAIN", "4");
  EXPECT_EQ(BusOptionsFrom(scenario, args, "mapper").domain, 4);
  args.domain = 5;
  EXPECT_EQ(BusOptionsFrom(scenario, args, "mapper").domain, 5);
}

TEST(BusOptionsFrom, BringsTheLinesOfTheLogToTheBus) {
  const dds::BusOptions options = BusOptionsFrom({}, Parse({}), "mapper");
  options.log->Take();
  SetUpLog("mapper");
  spdlog::warn("disk {} % full", 99);
  const std::vector<dds::LogLine> lines = options.log->Take();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].text, "disk 99 % full");
  EXPECT_EQ(lines[0].level, dds::LogLevel::kWarning);
}

TEST(BusOptionsFrom, SaysWhichScenarioAndWhereFilesGo) {
  ServiceArgs args = {.scenario = "flat", .overrides = {}, .domain = -1, .out = "/tmp/x/../y"};
  EXPECT_EQ(BusOptionsFrom({}, args, "mapper").about, "scenario flat, files in /tmp/y");
  args.out = ".";
  EXPECT_EQ(BusOptionsFrom({}, args, "mapper").about,
            "scenario flat, files in " + std::filesystem::current_path().string());
  args.files = Files::kNone;
  EXPECT_EQ(BusOptionsFrom({}, args, "controller").about, "scenario flat");
}

TEST(BusOptionsFrom, TakesNetworkAndClockFromTheScenario) {
  Scenario scenario;
  const dds::BusOptions standard = BusOptionsFrom(scenario, {}, "mapper");
  EXPECT_EQ(standard.name, "mapper");
  EXPECT_EQ(standard.clock, dds::ClockSource::kTopic);
  EXPECT_EQ(standard.segment_mb, dds::BusOptions{}.segment_mb);
  EXPECT_TRUE(standard.shared_memory);
  scenario.mutable_network()->set_wall_clock(true);
  scenario.mutable_network()->set_shared_memory(false);
  scenario.mutable_network()->set_segment_mb(8);
  scenario.mutable_network()->set_network_interface("10.0.0.1");
  scenario.mutable_network()->set_discovery_server("base:11811");
  scenario.mutable_network()->set_security_dir("keys");
  scenario.mutable_network()->set_peers("robot,10.0.0.2");
  const dds::BusOptions options = BusOptionsFrom(scenario, {}, "mapper");
  EXPECT_EQ(options.clock, dds::ClockSource::kSystem);
  EXPECT_FALSE(options.shared_memory);
  EXPECT_EQ(options.segment_mb, 8);
  EXPECT_EQ(options.network_interface, "10.0.0.1");
  EXPECT_EQ(options.discovery_server, "base:11811");
  EXPECT_EQ(options.peers, "robot,10.0.0.2");
  EXPECT_EQ(options.security_dir, "keys");
}

TEST(BusOptionsFrom, TakesTheNetworkFromTheEnvironment) {
  const Variable partition("THALWEG_PARTITION", "robot7");
  const Variable address("THALWEG_INTERFACE", "127.0.0.1");
  const Variable server("THALWEG_DISCOVERY_SERVER", "base:1");
  const Variable peers("THALWEG_PEERS", "base,relay");
  const Variable keys("THALWEG_SECURITY", "/robot/keys");
  Scenario scenario;
  scenario.mutable_network()->set_security_dir("keys");
  scenario.mutable_network()->set_network_interface("10.0.0.1");
  const dds::BusOptions options = BusOptionsFrom(scenario, {}, "mapper");
  EXPECT_EQ(options.partition, "robot7");
  EXPECT_EQ(options.network_interface, "127.0.0.1");
  EXPECT_EQ(options.discovery_server, "base:1");
  EXPECT_EQ(options.peers, "base,relay");
  EXPECT_EQ(options.security_dir, "/robot/keys");
}

TEST(BusOptionsFrom, RefusesADomainThatIsNone) {
  for (const char* const text : {"x", "233", "-1", "7 ", "1e1"}) {
    const Variable domain("THALWEG_DOMAIN", text);
    EXPECT_THROW(BusOptionsFrom({}, {}, "mapper"), std::runtime_error) << text;
  }
}

}  // namespace
}  // namespace thalweg
