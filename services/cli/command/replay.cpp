#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <memory>
#include <stdexcept>
#include <thread>

#include "common/base/text.h"
#include "common/service/service.h"
#include "services/cli/adapter/replay_terminal.h"
#include "services/cli/command/command.h"
#include "services/cli/command/network_args.h"
#include "services/cli/command/number_range.h"
#include "services/cli/command/recording_args.h"
#include "services/cli/report/live_display.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/player.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;

struct ReplayArgs {
  NetworkArgs network;
  std::filesystem::path file;
  std::vector<std::string> remap;  ///< "A:=B"
  /// [s] Matching takes up to 2.5 s on a good network. A topic that nobody reads must not hold up the others.
  double wait = 3.0;
  recorder::PlayerOptions player;
};

std::map<std::string, std::string> RemapFrom(const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> remap;
  for (const std::string& pair : pairs) {
    const std::size_t middle = pair.find(":=");
    if (middle == 0 || middle == std::string::npos || middle + 2 == pair.size()) {
      throw std::runtime_error("--remap " + pair + ": must be RECORDED:=PLAYED");
    }
    remap[pair.substr(0, middle)] = pair.substr(middle + 2);
  }
  return remap;
}

/// With health, by which a page lists it, unless that is played.
dds::BusOptions BusForReplay(const ReplayArgs& args) {
  dds::BusOptions options = BusOptionsFrom(args.network, "replay");
  options.publish_health = !recorder::Names(args.player, dds::topics::Health::kName);
  options.log = nullptr;  // rosout is the recording's
  return options;
}

int Replay(ReplayArgs& args) {
  const std::stop_token stop = StopOnSignals();
  SetUpLog("replay");
  const bool has_keys = isatty(STDIN_FILENO) != 0;
  if (args.player.paused && !args.player.stay && !has_keys) {
    throw std::runtime_error(
        "--pause waits for Enter, but standard input is no terminal; with --stay the page can end it");
  }
  args.player.name = args.file.filename();
  args.player.remap = RemapFrom(args.remap);
  const recorder::MappedFile file(args.file);
  const auto reader = recorder::McapReader::Open(file.bytes());
  if (!reader) throw std::runtime_error(args.file.string() + ": " + reader.error());
  ReportProblems(reader->problems());
  dds::Bus bus(BusForReplay(args));
  recorder::Player player(*reader, args.player, bus);
  for (const std::string& remark : player.remarks()) std::cout << CleanText(remark) << '\n';
  std::cout << "playing";
  for (const std::string& topic : player.topics()) std::cout << ' ' << CleanText(topic);
  std::cout << std::endl;
  player.AwaitReaders(FromSeconds(args.wait));
  {
    std::jthread keys;
    std::jthread progress;
    if (has_keys) {
      std::cout << (IsInForeground(STDIN_FILENO) ? "" : "in the foreground: ") << kReplayKeys
                << (args.player.paused ? "; paused, Enter begins" : "") << std::endl;
      keys = std::jthread([&](const std::stop_token& ended) { FollowKeys(player, ended); });
    }
    if (LiveDisplay::StyleFor(false) == LiveDisplay::Style::kTerminal)
      progress = std::jthread([&](const std::stop_token& ended) { ShowProgress(player, std::cout, ended); });
    player.Run(stop);
  }
  // Large messages are sent by another thread, which ends with the bus.
  bus.SpinUntil([] { return false; }, 1s);
  const recorder::Player::Status& status = player.status();
  std::cout << fmt::format("{} messages; late by {:.2f} ms rms, {:.1f} ms at most\n", status.messages,
                           status.late_rms_ms, status.late_max_ms);
  return ReportProblems(status.problems);
}

}  // namespace

void AddReplay(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<ReplayArgs>();
  CLI::App* command = app.add_subcommand("replay", "Publish the messages of an MCAP file");
  command->add_option("file", args->file, "Recording")->required();
  command->add_option("--rate", args->player.rate, "Seconds of the recording per second")
      ->check(NumberFrom(recorder::PlaybackClock::kSlowest, recorder::PlaybackClock::kFastest))
      ->capture_default_str();
  command
      ->add_option(
          "--wait", args->wait,
          "[s] Wait this long for a reader of each topic, which would miss what is published before it "
          "is found")
      ->check(NumberFrom(0.0, 3600.0))
      ->capture_default_str();
  command->add_flag("--loop", args->player.loop, "Begin again at the end");
  command->add_flag(
      "--stay", args->player.stay,
      "Pause at the end instead of ending, to be steered from there, by the page or replay/command");
  command
      ->add_option("--start", args->player.start, "[s] Begin this long after the recording's first message")
      ->capture_default_str();
  command
      ->add_option("--topics", args->player.topics,
                   "Topics to play, separated by commas, or patterns; default: all on which nothing that "
                   "runs now would act")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--remap", args->remap,
                   "RECORDED:=PLAYED plays a topic by another name, without patterns; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--clock", args->player.clock,
                    "Publish the time of the recording as the clock, if it has none of its own");
  command->add_flag(
      "--pause", args->player.paused,
      "Wait before the first message: for Enter at a terminal, or with --stay for replay/command");
  AddNetworkArgs(*command, args->network);
  command->callback([args, &exit_code] { exit_code = Replay(*args); });
}

}  // namespace thalweg::cli
