#include <fmt/format.h>

#include <iostream>
#include <map>
#include <memory>

#include "common/base/megabytes.h"
#include "common/base/text.h"
#include "common/base/version.h"
#include "common/scenario/scenario.h"
#include "common/service/service.h"
#include "services/cli/adapter/defaults.h"
#include "services/cli/adapter/observation.h"
#include "services/cli/adapter/outside_topics.h"
#include "services/cli/command/command.h"
#include "services/cli/command/network_args.h"
#include "services/cli/command/number_range.h"
#include "services/cli/command/recording_args.h"
#include "services/recorder/adapter/recorder.h"
#include "services/recorder/core/topic_name.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;

/// After so many seconds everybody who was there before is known.
constexpr int kLooksOfDiscovery = 4;

struct RecordArgs {
  NetworkArgs network;
  recorder::RecorderOptions recorder;
  bool names_scenario = false;  ///< Whether the recording is of that scenario.
  std::string name;             ///< The scenario's name; empty = that of its file.
};

std::string ScenarioText(const std::string& name_or_file) {
  const Scenario scenario = LoadScenario(name_or_file);
  return CommentedText(WithDefaults(scenario), scenario);
}

/// Topics that the table does not have are recorded as they appear on the bus.
void RecordNew(OutsideTopics& outside, const dds::BusGraph& graph, recorder::Recorder& recorder) {
  for (const Result<recorder::OutsideTopic>& topic : outside.FindNew(graph)) {
    if (!topic) {
      std::cerr << "thalweg: not recorded: " << topic.error() << std::endl;
      continue;
    }
    recorder.Add(*topic);
    std::cout << "recording " << CleanText(recorder::BusName(topic->info.name)) << ", too (" << topic->type
              << ")" << std::endl;
  }
}

std::uint64_t Total(const std::map<std::string, std::uint64_t>& counts) {
  std::uint64_t total = 0;
  for (const auto& [topic, count] : counts) total += count;
  return total;
}

std::string Progress(const recorder::Recorder::Status& status) {
  return fmt::format("{} messages, {}, in the file {}, {} dropped, {} lost", status.messages,
                     MegabytesText(static_cast<double>(status.payload_bytes)),
                     MegabytesText(static_cast<double>(status.file_bytes)), Total(status.dropped),
                     Total(status.lost));
}

int Record(RecordArgs& args) {
  const std::stop_token stop = StopOnSignals();
  SetUpLog("recorder");
  args.recorder.recording.metadata.push_back({"thalweg", {{"version", std::string(Version())}}});
  if (args.names_scenario) {
    const std::string& scenario = args.network.scenario;
    args.recorder.recording.metadata.push_back(
        {"scenario",
         {{"name", args.name.empty() ? ScenarioName(scenario) : args.name},
          {"text", ScenarioText(scenario)}}});
  }
  dds::BusOptions options = BusOptionsFrom(args.network, "recorder");
  options.surveys = true;
  args.recorder.map_frame = options.names.Frame(dds::kMapFrame);
  dds::Bus bus(options);
  recorder::Recorder recorder(args.recorder, bus);
  std::cout << "recording " << recorder.topics().size() << " topics to "
            << recorder.status().files.front().string() << ", until Ctrl-C" << std::endl;
  OutsideTopics outside(args.recorder.topics, options.names);
  int looks = 0;
  bus.EveryWall(1s, [&] {
    RecordNew(outside, bus.Graph(), recorder);
    if (++looks != kLooksOfDiscovery) return;
    for (const std::string& line : outside.Unmatched()) std::cerr << "thalweg: " << line << std::endl;
  });
  bool failed = false;
  bus.EveryWall(1s, [&] { failed = recorder.status().failure.has_value(); });
  bus.EveryWall(10s, [&] { std::cout << Progress(recorder.status()) << std::endl; });
  bus.SpinUntil([&] { return stop.stop_requested() || failed; }, kForEver);
  recorder.Finish();
  const recorder::Recorder::Status status = recorder.status();
  std::cout << Progress(status) << '\n';
  for (const auto& [topic, count] : status.dropped) {
    std::cout << "dropped " << count << " of " << topic << ": they came faster than they could be written\n";
  }
  for (const auto& [topic, count] : status.lost) {
    std::cout << "lost " << count << " of " << topic << ": they were sent, but did not arrive\n";
  }
  for (const auto& file : status.files) std::cout << file.string() << '\n';
  if (!status.failure) return EXIT_SUCCESS;
  std::cerr << "thalweg: the recording ended: " << *status.failure << '\n';
  return EXIT_FAILURE;
}

}  // namespace

void AddRecord(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<RecordArgs>();
  CLI::App* command = app.add_subcommand("record", "Record topics in an MCAP file");
  command->add_option("topics", args->recorder.topics,
                      "Names of topics, or patterns such as 'stereo/*'; default: all");
  AddRecordingArgs(*command, args->recorder.recording);
  command
      ->add_option_function<double>(
          "--keep-free",
          [args](double megabytes) { args->recorder.recording.keep_free = BytesFromMegabytes(megabytes); },
          "[MB] End the recording while this much is free on its disk; default: " +
              std::to_string(args->recorder.recording.keep_free / kMegabyte))
      ->check(NumberFrom(0.0, 1e9));
  AddNetworkArgs(*command, args->network);
  command->add_option("--name", args->name,
                      "Name of the scenario, for the recording's metadata; default: that of its file");
  command->callback([args, command, &exit_code] {
    args->names_scenario = command->count("--scenario") > 0;
    exit_code = Record(*args);
  });
}

}  // namespace thalweg::cli
