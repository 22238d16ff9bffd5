#include "services/cli/adapter/operator_client.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <random>

#include "common/base/text.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"

namespace thalweg::cli {
namespace {

/// A command or reply that is lost while two participants discover each other is not repeated by DDS.
constexpr auto kRepetition = std::chrono::milliseconds(500);

/// Differs for each command of all processes that give the same sender.
std::uint64_t FreshId() {
  std::random_device random;
  return std::uint64_t{random()} << 32U | random();
}

}  // namespace

OperatorClient::OperatorClient(dds::Bus& bus, std::string_view sender)
    : bus_(bus),
      sender_(dds::SenderName(sender)),
      commands_out_(bus.Advertise<dds::topics::OperatorCommands>()) {
  bus.Subscribe<dds::topics::CommandReplies>([this](const auto& reply) {
    if (!awaited_ || reply.id() != *awaited_ || reply.sender() != sender_) return;
    reply_ = reply;
    reply_->service(CleanText(reply.service()));
    reply_->reason(CleanText(reply.reason()));
  });
}

Result<thalweg_msgs::msg::CommandReply> OperatorClient::Send(thalweg_msgs::msg::OperatorCommand command,
                                                             Duration patience) {
  awaited_ = FreshId();
  reply_.reset();
  command.header(dds::MakeHeader(bus_.Now(), dds::kMapFrame));
  command.sender(sender_);
  command.id(*awaited_);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  const auto left = [&] {
    const auto now = std::chrono::steady_clock::now();
    return std::max(Duration::zero(), std::chrono::duration_cast<Duration>(deadline - now));
  };
  const auto matched = [&] {
    return commands_out_.readers() > 0 && bus_.Writers<dds::topics::CommandReplies>() > 0;
  };
  if (!bus_.SpinUntil(matched, patience)) {
    return Error{std::string("nobody listens to ") + dds::topics::OperatorCommands::kName +
                 ": is a run going on in this DDS domain?"};
  }
  while (left() > Duration::zero()) {
    commands_out_.Write(command);
    if (bus_.SpinUntil([&] { return reply_.has_value(); }, std::min<Duration>(kRepetition, left())))
      return *reply_;
  }
  const bool for_mapper = command.kind() == thalweg_msgs::msg::COMMAND_SAVE_MAP;
  return Error{std::string("no reply from the ") + (for_mapper ? "mapper" : "explorer")};
}

}  // namespace thalweg::cli
