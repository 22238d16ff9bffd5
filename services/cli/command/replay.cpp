#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <thread>

#include "common/service/service.h"
#include "services/cli/command/command.h"
#include "services/cli/command/recording_args.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/player.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;

struct Args {
  NetworkArgs network;
  std::filesystem::path file;
  std::vector<std::string> remap;  ///< "A:=B"
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

/// Pauses and resumes with each Enter, until `ended`.
void FollowEnter(recorder::Player& player, const std::stop_token& ended) {
  constexpr int kTurnMs = 100;
  pollfd in{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  std::array<char, 256> line{};
  while (!ended.stop_requested()) {
    if (poll(&in, 1, kTurnMs) <= 0) continue;
    if (read(STDIN_FILENO, line.data(), line.size()) <= 0) return;
    player.Toggle();
  }
}

int Replay(Args& args) {
  const std::stop_token stop = StopOnSignals();
  SetUpLog("replay");
  const bool has_keys = isatty(STDIN_FILENO) != 0;
  if (args.player.paused && !has_keys) {
    throw std::runtime_error("--pause waits for Enter, but standard input is no terminal");
  }
  args.player.remap = RemapFrom(args.remap);
  const recorder::MappedFile file(args.file);
  const auto reader = recorder::McapReader::Open(file.bytes());
  if (!reader) throw std::runtime_error(args.file.string() + ": " + reader.error());
  ReportProblems(reader->problems());
  dds::Bus bus(BusOptionsFrom(args.network, "replay"));
  recorder::Player player(*reader, args.player, bus);
  for (const std::string& remark : player.remarks()) std::cout << remark << '\n';
  std::cout << "playing";
  for (const std::string& topic : player.topics()) std::cout << ' ' << topic;
  std::cout << std::endl;
  // Matching takes up to 2.5 s; a topic that nobody reads must not hold up the others.
  player.AwaitReaders(2s);
  std::jthread keys;
  if (has_keys) {
    std::cout << (args.player.paused ? "paused; Enter begins" : "Enter pauses") << std::endl;
    keys = std::jthread([&](const std::stop_token& ended) { FollowEnter(player, ended); });
  }
  player.Run(stop);
  // Large messages are sent by another thread, which ends with the bus.
  bus.SpinUntil([] { return false; }, 1s);
  const recorder::Player::Status& status = player.status();
  std::cout << fmt::format("{} messages; late by {:.2f} ms rms, {:.1f} ms at most\n", status.messages,
                           status.late_rms_ms, status.late_max_ms);
  return ReportProblems(status.problems);
}

}  // namespace

void AddReplay(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<Args>();
  CLI::App* command = app.add_subcommand("replay", "Publish the messages of an MCAP file");
  command->add_option("file", args->file, "Recording")->required();
  command->add_option("--rate", args->player.rate, "Seconds of the recording per second")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--loop", args->player.loop, "Begin again at the end");
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
  command->add_flag("--pause", args->player.paused,
                    "Wait for Enter, at a terminal, before the first message");
  AddNetworkArgs(*command, args->network);
  command->callback([args, &exit_code] { exit_code = Replay(*args); });
}

}  // namespace thalweg::cli
