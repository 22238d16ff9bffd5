#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/statistics.h"
#include "common/base/time.h"
#include "common/dds/topics.h"

namespace thalweg::dds {

/// Counts a service's rejected and dropped messages and times its work; its Bus publishes this once a second.
/// Logs the first event of each kind immediately, then at most one a second.
///
/// Threading: the bus's thread.
class Health {
 public:
  explicit Health(std::string service);

  /// Counts an invalid message under the topic's name.
  template <class Topic>
  void Reject(std::string_view reason) {
    Reject(Topic::kName, reason);
  }
  void Reject(const char* topic, std::string_view reason, unsigned long long count = 1) {
    Count(rejected_, topic, "rejected", reason, count);
  }
  /// Counts a valid message that came too late or could not be placed.
  template <class Topic>
  void Drop(std::string_view reason) {
    Drop(Topic::kName, reason);
  }
  /// The same for tools that handle topics by their names.
  void Drop(const char* topic, std::string_view reason, unsigned long long count = 1) {
    Count(dropped_, topic, "dropped", reason, count);
  }
  /// States what has crossed a link so far.
  /// @param name  Topic and direction.
  void SetCrossed(const std::string& name, unsigned long long messages, std::string figures) {
    Entry& entry = crossed_[name];
    entry.count = messages;
    entry.last = std::move(figures);
  }
  /// States what another bus of this process has rejected so far, which has logged it.
  void SetRejected(const std::string& name, unsigned long long count, std::string last) {
    Entry& entry = rejected_[name];
    entry.count = count;
    entry.last = std::move(last);
  }
  /// Counts a file that the service could not write, as dropped `files`. Does not log: a full disk may stay
  /// full for hours, so the caller logs when that changes.
  void FileNotWritten(std::string_view reason);
  static constexpr auto kFiles = "files";  ///< Name of that counter.
  /// Name of the counter of datagrams that are not well-formed RTPS, rejected: strangers may send them.
  static constexpr auto kDatagrams = "datagram";

  /// Adds a duration to the timing of the given name.
  void Timed(const std::string& name, double milliseconds) { timings_[name].Add(milliseconds); }

  const std::string& service() const { return service_; }
  unsigned long long rejected() const { return Total(rejected_); }
  unsigned long long dropped() const { return Total(dropped_); }
  thalweg_msgs::msg::ServiceHealth ToMessage(Time now) const;

 private:
  struct Entry {
    unsigned long long count = 0;
    std::string last;
    unsigned long long unlogged = 0;
    std::chrono::steady_clock::time_point logged;
  };
  using Entries = std::map<std::string, Entry>;
  void Count(Entries& entries, const char* topic, const char* what, std::string_view reason,
             unsigned long long count);
  static unsigned long long Total(const Entries& entries);

  std::string service_;
  std::uint64_t instance_;  ///< Distinguishes this start of the service from others.
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  Entries rejected_;
  Entries dropped_;
  Entries crossed_;
  std::map<std::string, TimingStatistics> timings_;
};

}  // namespace thalweg::dds
