#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "common/base/time.h"
#include "services/inspector/core/meters.h"
#include "services/inspector/core/value.h"

namespace thalweg::inspector {

/// The value of a builtin_interfaces/Time.
Time StampIn(const Value& time);

/// How late stamped messages are, by the clock that stamps them: the run's once that has been heard, which a
/// simulator's messages need, else this machine's. Stamps that are farther than an hour from it are of
/// another clock, and no part of the figures.
class StampDelay {
 public:
  /// @param machine_clock  Compare with this machine's clock whatever is heard, and however far stamps are.
  StampDelay(std::size_t most_messages, bool machine_clock)
      : machine_clock_(machine_clock), meter_(most_messages) {}

  void SetRunTime(Time now) { run_time_ = now; }  ///< The run's clock now.
  /// @param arrival  By this machine's clock.
  /// @param sender  Who sent it, for people; empty if that is not known. Asked for only if it is to be named.
  void Add(Time stamp, Time arrival, const std::function<std::string()>& sender);

  bool by_run_clock() const { return run_time_ && !machine_clock_; }
  /// As DelayMeter prints it; nothing while no message could be compared with a clock.
  std::optional<std::string> Report() const { return meter_.Report(); }
  /// Which clock the report is against, and whose stamps show that it is not the one that made them. Has no
  /// figures, so that it changes only when there is something new to say.
  std::string ClockText() const;

 private:
  bool machine_clock_;
  std::optional<Time> run_time_;
  DelayMeter meter_;
  std::size_t of_unheard_clock_ = 0;  ///< Messages whose stamps are by a clock that is not heard.
  std::size_t of_other_clock_ = 0;    ///< Messages whose stamps are far from the clock.
  std::set<std::string> their_senders_;
};

/// What a person reads of a delay: its figures, and once each what there is to know about the clocks.
class DelayReport {
 public:
  /// @param delay  Outlives the report.
  explicit DelayReport(const StampDelay& delay) : delay_(delay) {}

  /// Lines that no earlier call returned, then the figures, without a line break at the end; nothing if there
  /// is neither.
  /// @param other_hosts  The other machines on which the topic is published.
  std::optional<std::string> Text(const std::set<std::string>& other_hosts);

 private:
  const StampDelay& delay_;
  std::set<std::string> printed_;
};

}  // namespace thalweg::inspector
