#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/base/angles.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"
#include "common/dds/operator_client.h"
#include "common/dds/replay_client.h"
#include "common/service/service.h"
#include "services/cli/adapter/observation.h"
#include "services/cli/command/command.h"
#include "services/cli/command/network_args.h"
#include "services/cli/command/number_range.h"
#include "services/inspector/adapter/machine.h"
#include "services/recorder/adapter/describe.h"

namespace thalweg::cli {
namespace {

using std::chrono_literals::operator""s;
using Kind = thalweg_msgs::msg::CommandKind;

struct SendArgs {
  NetworkArgs network;
  double patience_s = 20.0;
  std::vector<double> numbers;  ///< The command's coordinates [m].
  double yaw_deg = std::numeric_limits<double>::quiet_NaN();
  std::string strategy;
  double value = 0.0;  ///< What a command to a replay needs: [s] since the beginning, or the rate.
};

constexpr double kAnyNumber = 1e9;      // that is one; who carries out a command knows its limits
constexpr double kLongestReplay = 1e9;  // [s] which a Duration can hold

geometry_msgs::msg::Point PointAt(const std::vector<double>& numbers, std::size_t first) {
  geometry_msgs::msg::Point point;
  point.x(numbers.at(first));
  point.y(numbers.at(first + 1));
  point.z(numbers.at(first + 2));
  return point;
}

dds::BusOptions BusForCommands(const SendArgs& args) {
  // A scenario that contradicts itself is no place to send commands to.
  RunArgs run;
  run.scenario = args.network.scenario;
  return BusOptionsFrom(ScenarioOfRun(run, Robot::kOwn), args.network.domain, "thalweg");
}

std::string Sender() {
  return fmt::format("thalweg send of {}@{} ({})", inspector::OwnUser(), inspector::OwnHost(), getpid())
      .substr(0, dds::kLongestSender);
}

/// Says after a while that the command still waits, since a wait without a word looks like a hang.
void SayThatItWaits(dds::Bus& bus, const dds::BusOptions& options, const SendArgs& args) {
  bus.EveryWall(2s,
                [text = fmt::format("thalweg: no answer in DDS domain {} yet; waiting for {:.0f} s in all",
                                    options.domain, args.patience_s),
                 said = false]() mutable {
                  if (!std::exchange(said, true)) std::cerr << text << std::endl;
                });
}

std::string WhereText(const dds::BusOptions& options, const SendArgs& args) {
  return " (DDS domain " + std::to_string(options.domain) + ", waited " +
         std::to_string(static_cast<int>(args.patience_s)) + " s)";
}

/// Throws std::runtime_error for a time so far beyond the end that no command could hold it.
thalweg_msgs::msg::ReplayCommand ReplayCommandFrom(const SendArgs& args,
                                                   thalweg_msgs::msg::ReplayCommandKind kind,
                                                   const dds::ReplayClient& client) {
  thalweg_msgs::msg::ReplayCommand command;
  command.sender(Sender());
  command.kind(kind);
  if (kind == thalweg_msgs::msg::REPLAY_SEEK) {
    const Duration to = FromSeconds(args.value);
    const Result<Time> end = dds::FromIdl(client.status()->end());
    if (end && client.TimeAt(to) > *end) {
      throw std::runtime_error("the replay cannot seek to " + recorder::SecondsText(to) + ": it ends after " +
                               recorder::SecondsText(*end - client.TimeAt(Duration(0))));
    }
    command.time(dds::ToIdl(client.TimeAt(to)));
  }
  if (kind == thalweg_msgs::msg::REPLAY_RATE) command.rate(args.value);
  return command;
}

int SendToReplay(const SendArgs& args, thalweg_msgs::msg::ReplayCommandKind kind) {
  const dds::BusOptions options = BusForCommands(args);
  dds::Bus bus(options);
  dds::ReplayClient client(bus);
  SayThatItWaits(bus, options, args);
  const auto answer =
      client.SendAndWait([&] { return ReplayCommandFrom(args, kind, client); }, FromSeconds(args.patience_s));
  if (!answer && answer.error() == dds::ReplayClient::kNothing)
    throw std::runtime_error(answer.error() + WhereText(options, args));
  std::cout << "replay: " << (answer ? *answer : "refused: " + answer.error()) << '\n';
  return answer ? EXIT_SUCCESS : EXIT_FAILURE;
}

int Send(const SendArgs& args, Kind kind) {
  const dds::BusOptions options = BusForCommands(args);
  dds::Bus bus(options);
  dds::OperatorClient client(bus);
  SayThatItWaits(bus, options, args);
  thalweg_msgs::msg::OperatorCommand command;
  command.sender(Sender());
  command.kind(kind);
  if (args.numbers.size() >= 3) command.point(PointAt(args.numbers, 0));
  if (args.numbers.size() == 6) command.corner(PointAt(args.numbers, 3));
  command.yaw_rad(args.yaw_deg * kDegree);
  command.strategy(args.strategy);
  const auto reply = client.SendAndWait(command, FromSeconds(args.patience_s));
  if (!reply) {
    throw std::runtime_error(reply.error() + WhereText(options, args));
  }
  std::cout << reply->service() << ": " << (reply->accepted() ? "" : "refused: ") << reply->reason() << '\n';
  return reply->accepted() ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

void AddSend(CLI::App& app, int& exit_code) {
  const auto args = std::make_shared<SendArgs>();
  CLI::App* const send =
      app.add_subcommand("send", "Send a command to a robot that explores, or to a replay");
  send->require_subcommand(1);
  AddNetworkArgs(*send, args->network);
  send->add_option("--timeout", args->patience_s, "Wait at most this long for the reply [s]")
      ->check(NumberFrom(0.1, 3600.0))
      ->capture_default_str();
  const auto add = [&](const char* name, const char* help, Kind kind) {
    CLI::App* const command = send->add_subcommand(name, help);
    command->fallthrough();  // the options of send may follow the command
    command->callback([args, kind, &exit_code] { exit_code = Send(*args, kind); });
    return command;
  };
  const auto add_at = [&](const char* name, const char* help, Kind kind, int count) {
    CLI::App* const command = add(name, help, kind);
    command
        ->add_option("coordinates", args->numbers,
                     count == 3 ? "X Y Z [m], map" : "X0 Y0 Z0 X1 Y1 Z1 [m], map")
        ->required()
        ->expected(count)
        ->check(NumberFrom(-kAnyNumber, kAnyNumber));
    return command;
  };
  using namespace thalweg_msgs::msg;
  add("pause", "Stop wherever the robot is, and wait", COMMAND_PAUSE);
  add("resume", "Continue exploring", COMMAND_RESUME);
  add("step", "Make one decision, carry it out and pause", COMMAND_STEP);
  add("stop", "End the exploration here", COMMAND_STOP);
  add("home", "Go to where the robot set out, and end there", COMMAND_HOME);
  add_at("goto", "Go to a point in known free space and pause", COMMAND_GOTO, 3)
      ->add_option("--yaw", args->yaw_deg, "Heading at the end [deg]; default: that of the path")
      ->check(NumberFrom(-360.0, 360.0));
  add_at("look-at", "Look at a point, from here or from the nearest place that sees it, and pause",
         COMMAND_LOOK_AT, 3);
  add_at("ignore", "Never go for the frontier nearest to a point", COMMAND_IGNORE_FRONTIER, 3);
  add_at("no-go", "Keep out of a box until it is cleared", COMMAND_NO_GO_BOX, 6);
  add("clear-no-go", "Remove all boxes that commands have drawn", COMMAND_CLEAR_NO_GO);
  add("strategy", "Choose by another strategy from the next decision on", COMMAND_STRATEGY)
      ->add_option("name", args->strategy, "One of those that thalweg evaluate --help lists")
      ->required();
  add("save-map", "Write the map's files now", COMMAND_SAVE_MAP);

  CLI::App* const replay = send->add_subcommand("replay", "Steer thalweg replay");
  replay->require_subcommand(1);
  replay->fallthrough();
  const auto add_to_replay = [&](const char* name, const char* help, ReplayCommandKind kind) {
    CLI::App* const command = replay->add_subcommand(name, help);
    command->fallthrough();
    command->callback([args, kind, &exit_code] { exit_code = SendToReplay(*args, kind); });
    return command;
  };
  add_to_replay("pause", "Pause the replay", REPLAY_PAUSE);
  add_to_replay("resume", "Go on with the replay", REPLAY_RESUME);
  add_to_replay("seek", "Go on from another time", REPLAY_SEEK)
      ->add_option("seconds", args->value, "[s] After the recording's beginning")
      ->required()
      ->check(NumberFrom(0.0, kLongestReplay));
  add_to_replay("rate", "Play so many seconds of the recording per second", REPLAY_RATE)
      ->add_option("rate", args->value, "0.001 to 1000")
      ->required();
}

}  // namespace thalweg::cli
