#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/dds/bus.h"

namespace thalweg::dds {

/// Follows `thalweg replay` by replay/status, and steers it. Its commands have no replies: that one is obeyed
/// shows in the status, and so does a refusal.
///
/// Threading: the bus's thread. Lives as long as the bus spins.
class ReplayClient {
 public:
  /// What happens now, or the error that says why not.
  using Answer = Result<std::string>;
  using AnswerHandler = std::function<void(const Answer&)>;
  using StatusHandler = std::function<void(const thalweg_msgs::msg::ReplayStatus&)>;

  /// @param may_steer  Whether it announces that it may send commands.
  /// @param on_status  Called with each status.
  explicit ReplayClient(Bus& bus, bool may_steer = true, StatusHandler on_status = {});
  ReplayClient(const ReplayClient&) = delete;
  ReplayClient& operator=(const ReplayClient&) = delete;

  /// The last status, unless nothing is replayed: it comes once a second at least.
  const thalweg_msgs::msg::ReplayStatus* status() const;
  /// The log time of what stands so long after the beginning of the recording. Precondition: status().
  Time TimeAt(Duration since_beginning) const;

  /// Sends a command and calls `handler` once, within `patience` of wall time. Precondition: may_steer.
  void Send(thalweg_msgs::msg::ReplayCommand command, Duration patience, AnswerHandler handler);
  /// The same, once something is replayed and can hear it, and spins the bus until the answer is there.
  /// @param make  Makes the command from the status.
  Answer SendAndWait(const std::function<thalweg_msgs::msg::ReplayCommand()>& make, Duration patience);

  static constexpr auto kNothing = "nothing is replayed here";

 private:
  using Clock = std::chrono::steady_clock;
  struct Pending {
    thalweg_msgs::msg::ReplayCommand command;
    Clock::time_point sent;
    Clock::time_point deadline;
    std::string refusal_before;  ///< Why an earlier command was refused.
    AnswerHandler handler;
  };
  void OnStatus(const thalweg_msgs::msg::ReplayStatus& status);
  bool IsObeyed(const Pending& pending) const;
  /// The answer that the last status gives, if it does.
  std::optional<Answer> AnswerTo(const Pending& pending) const;
  void Tick();

  Bus& bus_;
  std::optional<Bus::Publisher<topics::ReplayCommands>> commands_out_;
  StatusHandler on_status_;
  std::optional<thalweg_msgs::msg::ReplayStatus> status_;
  Clock::time_point heard_;
  std::vector<Pending> pending_;
};

/// Where a replay is, for people: "playing at 0:12 of 1:30", "paused at ...".
std::string Described(const thalweg_msgs::msg::ReplayStatus& status);

}  // namespace thalweg::dds
