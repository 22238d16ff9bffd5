#pragma once

#include <chrono>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "common/dds/bus.h"

namespace thalweg::dds {

/// Sends operators' commands, each again and again until the explorer, or for SAVE_MAP the mapper, replies.
///
/// Threading: the bus's thread. Lives as long as the bus spins.
class OperatorClient {
 public:
  /// The reply, its texts cleaned for a terminal, or the error that nobody listens or that nobody replies.
  using Answer = Result<thalweg_msgs::msg::CommandReply>;
  using AnswerHandler = std::function<void(const Answer&)>;

  explicit OperatorClient(Bus& bus);
  OperatorClient(const OperatorClient&) = delete;
  OperatorClient& operator=(const OperatorClient&) = delete;

  /// Sends a command that names its sender, and calls `handler` once, within `patience` of wall time. Fills
  /// in the command's header and id.
  void Send(thalweg_msgs::msg::OperatorCommand command, Duration patience, AnswerHandler handler);
  /// The same, and spins the bus until the answer is there. Waits a fifth of a second for others who read
  /// commands, such as a recorder, to be discovered, and at most as long for those who have been to have it.
  Answer SendAndWait(thalweg_msgs::msg::OperatorCommand command, Duration patience);
  /// Readers of commands that have been discovered.
  int readers() const { return commands_out_.readers(); }

 private:
  struct Pending {
    thalweg_msgs::msg::OperatorCommand command;
    std::chrono::steady_clock::time_point deadline;
    std::chrono::steady_clock::time_point next;  ///< When it is sent again.
    bool sent = false;
    AnswerHandler handler;
  };
  bool Matched() const;
  void OnReply(const thalweg_msgs::msg::CommandReply& reply);
  void Tick();

  Bus& bus_;
  Bus::Publisher<topics::OperatorCommands> commands_out_;
  std::vector<Pending> pending_;
};

}  // namespace thalweg::dds
