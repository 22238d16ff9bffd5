#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/dds/bus.h"

namespace thalweg::cli {

/// Sends operators' commands and waits for the replies.
///
/// Threading: the bus's thread.
class OperatorClient {
 public:
  /// @param sender  Person or tool; sent as SenderName makes it, so that replies can be told by it.
  OperatorClient(dds::Bus& bus, std::string_view sender);

  /// Sends a command, and sends it again until the explorer, or for SAVE_MAP the mapper, replies. Fills in
  /// its header, sender and id. The texts of the reply are cleaned for a terminal. Error: nobody listens, or
  /// nobody replies, within `patience` of wall time.
  Result<thalweg_msgs::msg::CommandReply> Send(thalweg_msgs::msg::OperatorCommand command, Duration patience);

 private:
  dds::Bus& bus_;
  std::string sender_;
  dds::Bus::Publisher<dds::topics::OperatorCommands> commands_out_;
  std::optional<std::uint64_t> awaited_;  ///< Id of the command.
  std::optional<thalweg_msgs::msg::CommandReply> reply_;
};

}  // namespace thalweg::cli
