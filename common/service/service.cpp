#include "common/service/service.h"

#include <pthread.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "common/base/environment.h"
#include "common/files/write_file.h"
#include "common/scenario/option_binding.h"
#include "common/service/command_line.h"
#include "common/service/healthy.h"

namespace thalweg {
namespace {

constexpr auto kOneRequest = std::chrono::milliseconds(500);  // signals within it are one wish to end

int DomainFrom(const std::string& text) {
  int domain = -1;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, domain);
  if (error != std::errc() || rest != end || domain < 0 || domain > 232) {
    throw std::runtime_error("THALWEG_DOMAIN is \"" + text + "\", must be 0 to 232");
  }
  return domain;
}

bool SwitchFrom(const std::string& variable, const std::string& text) {
  if (text == "0") return false;
  if (text == "1") return true;
  throw std::runtime_error(variable + " is \"" + text + "\", must be 0 or 1");
}

/// The lines of this process's log, from SetUpLog to the bus.
const std::shared_ptr<dds::LogLines>& ProcessLog() {
  static const auto log = std::make_shared<dds::LogLines>();
  return log;
}

dds::LogLevel LevelOf(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::trace:
    case spdlog::level::debug:
      return dds::LogLevel::kDebug;
    case spdlog::level::warn:
      return dds::LogLevel::kWarning;
    case spdlog::level::err:
      return dds::LogLevel::kError;
    case spdlog::level::critical:
      return dds::LogLevel::kFatal;
    default:
      return dds::LogLevel::kInfo;
  }
}

class ProcessLogSink final : public spdlog::sinks::base_sink<std::mutex> {
 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    ProcessLog()->Add({.stamp = std::chrono::time_point_cast<Duration>(message.time),
                       .level = LevelOf(message.level),
                       .text = {message.payload.data(), message.payload.size()}});
  }
  void flush_() override {}
};

/// Prints whether the running copy of the service works. Returns the exit code.
int ReportHealth(const ServiceArgs& args, const std::string& name) try {
  constexpr Duration kPatience = std::chrono::seconds(8);  // peers take up to 2.5 s to find each other
  dds::BusOptions options = BusOptionsFrom(LoadScenario(args.scenario, args.overrides), args, name);
  options.local_only = true;
  const Healthiness found = CheckHealthy(options, kPatience);
  std::cout << name << ": " << found.text << '\n';
  return found.healthy ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception& error) {
  std::cout << name << ": " << error.what() << '\n';
  return EXIT_FAILURE;
}

}  // namespace

ServiceArgs ParseServiceArgs(int argc, char** argv, const std::string& name, const std::string& summary,
                             Files files, const std::function<void(CLI::App&)>& add_options,
                             const std::function<std::string()>& name_on_bus) {
  ServiceArgs args;
  args.files = files;
  CLI::App app("thalweg-" + name + ": " + summary + ".", "thalweg-" + name);
  AddVersion(app);
  app.add_option("--scenario", args.scenario, "Name of a scenario in deploy/scenarios, or a file")
      ->envname("THALWEG_SCENARIO")
      ->capture_default_str();
  app.add_option("--set", args.overrides,
                 "field=value, overrides the scenario's, e.g. mapper.voxel_size_m=0.05")
      ->allow_extra_args(false);
  app.add_option("--domain", args.domain, "DDS domain; overrides THALWEG_DOMAIN and the scenario's")
      ->check(CLI::Range(0, 232));
  app.add_option("--out", args.out,
                 files == Files::kWritten
                     ? "Folder for the files that it writes and resumes from; default: the current one"
                     : "Accepted so that all services start alike; this one writes no files")
      ->capture_default_str();
  bool healthy = false;
  app.add_flag("--healthy", healthy,
               "Start nothing: exit with 0 if the copy that runs on this machine works, else with 1");
  if (add_options) add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(ReportParseError(app, error, name));
  }
  SetUpLog(name);
  if (healthy) std::exit(ReportHealth(args, name_on_bus ? name_on_bus() : name));
  if (files == Files::kWritten) CheckFolderWritable(args.out);
  return args;
}

void SetUpLog(const std::string& name) {
  const auto log = std::make_shared<spdlog::logger>(
      name, spdlog::sinks_init_list{std::make_shared<spdlog::sinks::stderr_color_sink_mt>(),
                                    std::make_shared<ProcessLogSink>()});
  log->set_pattern("[%H:%M:%S.%e] [%n] [%^%l%$] %v");
  log->flush_on(spdlog::level::info);
  spdlog::set_default_logger(log);
}

std::stop_token StopOnSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  // A closed terminal. Linux hands a signal that is blocked to sigwait even if it is ignored, as nohup(1)
  // asks.
  struct sigaction hangup {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the process's limit is an error like a full disk
  std::stop_source source;
  std::thread([signals, source]() mutable {
    int signal = 0;
    sigwait(&signals, &signal);
    source.request_stop();
    // A later second signal: the user does not want to wait. Some senders, such as timeout(1), signal a
    // process and its group, so that two come at once.
    const auto asked = std::chrono::steady_clock::now();
    do sigwait(&signals, &signal);
    while (std::chrono::steady_clock::now() - asked < kOneRequest);
    _exit(128 + signal);
  }).detach();
  return source.get_token();
}

void Visit(OptionVisitor& visitor, dds::BusOptions& options) {
  visitor.Whole("domain", options.domain);
  visitor.Switch("shared_memory", options.shared_memory);
  visitor.Whole("segment_mb", options.segment_mb);
  visitor.Text("network_interface", options.network_interface);
  visitor.Text("discovery_server", options.discovery_server);
  visitor.Text("peers", options.peers);
  visitor.Switch("local_only", options.local_only);
  visitor.Text("security_dir", options.security_dir);
  visitor.Seconds("watchdog_s", options.watchdog);
  bool wall_clock = options.clock == dds::ClockSource::kSystem;
  if (visitor.Switch("wall_clock", wall_clock)) {
    options.clock = wall_clock ? dds::ClockSource::kSystem : dds::ClockSource::kTopic;
  }
}

/// The field of a topic is its name, with underscores for slashes.
void Visit(OptionVisitor& visitor, dds::TopicNames& names) {
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    std::string field = topic.name;
    std::ranges::replace(field, '/', '_');
    const auto renamed = names.find(topic.name);
    std::string name = renamed == names.end() ? topic.name : renamed->second;
    visitor.Text(field.c_str(), name);
    if (name != topic.name) names[topic.name] = name;
  }
}

void Visit(OptionVisitor& visitor, dds::FrameNames& names) {
  visitor.Text("map", names.map);
  visitor.Text("odom", names.odometry);
  visitor.Text("base_link", names.body);
  visitor.Text("camera", names.camera);
}

void Visit(OptionVisitor& visitor, RobotName& robot) {
  visitor.Text("name", robot.name);
}

dds::Names NamesFrom(const Scenario& scenario) {
  return {.robot = ReadOptions<RobotName>(scenario.robot()).name,
          .topics = ReadOptions<dds::TopicNames>(scenario.topics()),
          .frames = ReadOptions<dds::FrameNames>(scenario.frames())};
}

dds::BusOptions NetworkFrom(const Scenario& scenario) {
  dds::BusOptions options;
  // A bus on its own follows the system clock, since it has no simulator
  options.clock = dds::ClockSource::kTopic;
  options.names = NamesFrom(scenario);
  ReadOptions(scenario.network(), options);
  return options;
}

dds::BusOptions BusOptionsFrom(const Scenario& scenario, const ServiceArgs& args, const std::string& name) {
  dds::BusOptions options = NetworkFrom(scenario);
  options.name = name;
  options.sole = true;
  options.log = ProcessLog();
  options.about = "scenario " + args.scenario;
  if (args.files == Files::kWritten) {
    options.about += ", files in " + std::filesystem::weakly_canonical(args.out).string();
  }
  options.partition = Environment("THALWEG_PARTITION");
  if (const auto domain = Environment("THALWEG_DOMAIN"); !domain.empty()) options.domain = DomainFrom(domain);
  if (const auto address = Environment("THALWEG_INTERFACE"); !address.empty()) {
    options.network_interface = address;
  }
  if (const auto server = Environment("THALWEG_DISCOVERY_SERVER"); !server.empty()) {
    options.discovery_server = server;
  }
  if (const auto peers = Environment("THALWEG_PEERS"); !peers.empty()) options.peers = peers;
  if (const auto local = Environment("THALWEG_LOCAL_ONLY"); !local.empty()) {
    options.local_only = SwitchFrom("THALWEG_LOCAL_ONLY", local);
  }
  if (const auto keys = Environment("THALWEG_SECURITY"); !keys.empty()) options.security_dir = keys;
  if (args.domain >= 0) options.domain = args.domain;
  return options;
}

}  // namespace thalweg
