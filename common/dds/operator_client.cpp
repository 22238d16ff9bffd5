#include "common/dds/operator_client.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "common/base/fresh_id.h"
#include "common/base/text.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kOperatorTick = std::chrono::milliseconds(50);
/// A command or reply that is lost while two participants discover each other is not repeated by DDS.
constexpr auto kRepetition = std::chrono::milliseconds(500);
/// Readers that are there when a participant joins have been discovered this long after the first of them.
constexpr auto kCompany = std::chrono::milliseconds(200);

Error Unanswered(const thalweg_msgs::msg::OperatorCommand& command, bool sent) {
  if (!sent) {
    return {std::string("nobody listens to ") + topics::OperatorCommands::kName +
            ": is a run going on in this DDS domain?"};
  }
  const bool for_mapper = command.kind() == thalweg_msgs::msg::COMMAND_SAVE_MAP;
  return {std::string("no reply from the ") + (for_mapper ? "mapper" : "explorer")};
}

}  // namespace

OperatorClient::OperatorClient(Bus& bus)
    : bus_(bus), commands_out_(bus.Advertise<topics::OperatorCommands>()) {
  bus.Subscribe<topics::CommandReplies>([this](const auto& reply) { OnReply(reply); });
  bus.EveryWall(kOperatorTick, [this] { Tick(); });
}

void OperatorClient::Send(thalweg_msgs::msg::OperatorCommand command, Duration patience,
                          AnswerHandler handler) {
  command.header(MakeHeader(bus_.Now(), kMapFrame));
  command.id(FreshId());
  const auto now = Clock::now();
  const auto deadline = now + std::chrono::duration_cast<Clock::duration>(patience);
  pending_.push_back({std::move(command), deadline, now, false, std::move(handler)});
  Tick();
}

OperatorClient::Answer OperatorClient::SendAndWait(thalweg_msgs::msg::OperatorCommand command,
                                                   Duration patience) {
  const auto begin = Clock::now();
  if (bus_.SpinUntil([&] { return Matched(); }, patience)) {
    bus_.SpinUntil([] { return false; }, std::min<Duration>(kCompany, patience));
  }
  std::optional<Answer> answer;
  Send(std::move(command), patience - (Clock::now() - begin), [&](const Answer& its) { answer = its; });
  // The answer comes at the deadline at the latest
  while (!answer) bus_.SpinUntil([&] { return answer.has_value(); }, patience);
  commands_out_.AwaitDelivery(kCompany);
  return *answer;
}

bool OperatorClient::Matched() const {
  return commands_out_.readers() > 0 && bus_.Writers<topics::CommandReplies>() > 0;
}

void OperatorClient::OnReply(const thalweg_msgs::msg::CommandReply& reply) {
  const auto found = std::ranges::find_if(pending_, [&](const Pending& pending) {
    return IdOf(pending.command) == CommandId{reply.sender(), reply.id()};
  });
  if (found == pending_.end()) return;
  const AnswerHandler handler = std::move(found->handler);
  pending_.erase(found);
  thalweg_msgs::msg::CommandReply clean = reply;
  clean.service(CleanText(reply.service()));
  clean.reason(CleanText(reply.reason()));
  handler(clean);
}

void OperatorClient::Tick() {
  const auto now = Clock::now();
  const bool matched = !pending_.empty() && Matched();
  std::vector<Pending> late;
  for (auto pending = pending_.begin(); pending != pending_.end();) {
    if (now >= pending->deadline) {
      late.push_back(std::move(*pending));
      pending = pending_.erase(pending);
      continue;
    }
    if (matched && now >= pending->next) {
      commands_out_.Write(pending->command);
      pending->sent = true;
      pending->next = now + kRepetition;
    }
    ++pending;
  }
  // Last, since a handler may send the next command
  for (const Pending& each : late) each.handler(Unanswered(each.command, each.sent));
}

}  // namespace thalweg::dds
