// libFuzzer target: whatever frames a client of the gateway sends, what it is answered is well-formed JSON,
// what waits for it is bounded, a command that is passed on is finite and has a kind, and after enough
// invalid frames the connection is to be closed.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "services/gateway/core/session.h"

namespace {

using namespace thalweg;
using namespace thalweg::gateway;

constexpr std::size_t kMostWaiting = 16U << 20U;  // [byte]

void Require(bool good) {
  if (!good) __builtin_trap();
}

const ServerContent& Content() {
  static const ServerContent content = [] {
    ServerContent made{.name = "fuzz",
                       .session_id = "1",
                       .with_time = true,
                       .command_topics = {{"operator/command", CommandGroup::kOperator},
                                          {"replay/command", CommandGroup::kReplay}},
                       .channels = {},
                       .parameters = {},
                       .feeds = {}};
    for (const std::uint32_t id : {1U, 2U, 3U}) {
      made.channels.push_back({.id = id,
                               .topic = "/t" + std::to_string(id),
                               .encoding = "cdr",
                               .schema_name = "a/msg/B",
                               .schema = "float64 x",
                               .schema_encoding = "ros2msg"});
    }
    made.parameters = {{"robot.radius_m", "0.1"}, {"name", "\"kitchen\""}};
    return made;
  }();
  return content;
}

void CheckFrames(Session& session) {
  while (const auto frame = session.Next()) {
    if (!frame->binary) Require(nlohmann::json::accept(frame->head));
  }
}

void AnswerCommands(Session& session) {
  for (const ClientCommand& command : session.TakeCommands()) {
    if (const auto* parsed = std::get_if<Command>(&command.content)) {
      for (const double value : parsed->point) Require(std::isfinite(value));
      for (const double value : parsed->corner) Require(std::isfinite(value));
      Require(std::isfinite(parsed->rate));
      session.Answer(command.ticket, {});
    } else {
      session.AnswerInvalid(command.ticket, "no CDR");
    }
  }
}

/// Frames, each after two bytes: whether it is binary and the milliseconds since the last, and its length.
void Converse(std::string_view input) {
  Session session(Content(), {.name = "fuzz", .address = "127.0.0.1:1", .no_steering = {}});
  const auto message = std::make_shared<const std::vector<std::uint8_t>>(1000, std::uint8_t{1});
  Duration now{};
  while (input.size() >= 2 && !session.closing()) {
    const auto head = static_cast<std::uint8_t>(input[0]);
    const std::size_t length =
        std::min<std::size_t>(static_cast<std::uint8_t>(input[1]) * 4U, input.size() - 2);
    const std::string_view frame = input.substr(2, length);
    input.remove_prefix(2 + length);
    now += std::chrono::milliseconds(head >> 1U);
    const int invalid = session.invalid_frames();
    if ((head & 1U) != 0) {
      session.OnBinary({reinterpret_cast<const std::uint8_t*>(frame.data()), frame.size()}, now);
    } else {
      session.OnText(frame, now);
    }
    Require(session.invalid_frames() <= invalid + 1);
    AnswerCommands(session);
    for (const std::uint32_t channel : {1U, 2U, 3U}) session.Offer(channel, Time{now}, message);
    session.OfferTime(Time{now});
    Require(session.waiting_bytes() < kMostWaiting);
    if ((head & 2U) != 0) CheckFrames(session);
  }
  Require(session.invalid_frames() <= Session::kMaxInvalidFrames + 1);
  CheckFrames(session);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  Converse(text);
  for (const CommandService& service : CommandServices()) {
    const auto request = ParseRequest(service, text);
    Require(request || !request.error().empty());
  }
  for (const CommandGroup group : {CommandGroup::kOperator, CommandGroup::kReplay}) {
    const auto command = ParseCommand(group, text);
    Require(command || !command.error().empty());
  }
  return 0;
}
