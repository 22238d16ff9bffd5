#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "common/base/time.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Collects the explorer's decisions from what it publishes: a status when a plan is made or ends, and the
/// path of each plan on a topic of its own, which may arrive before or after the status.
///
/// Memory: at most kMost decisions; the earliest are forgotten.
class DecisionLog {
 public:
  static constexpr std::size_t kMost = 2000;

  /// The part of a status that matters here.
  struct Status {
    Time stamp;
    double time = 0.0;            ///< [s] On the run's clock.
    std::uint64_t plans = 0;      ///< Made so far by this explorer.
    std::uint64_t abandoned = 0;  ///< How many of them were abandoned.
    std::string activity;
    std::string last_interruption;
    std::optional<Eigen::Vector3d> target_W;
  };
  /// Fewer plans than before mean that the explorer was restarted.
  void OnStatus(const Status& status);
  /// @param stamp  Stamp of the path: when its plan was made. Repetitions of the same path are ignored.
  void OnPath(Time stamp, double length);

  const std::deque<Decision>& decisions() const { return decisions_; }
  std::size_t forgotten() const { return forgotten_; }

 private:
  void AddLength();

  std::deque<Decision> decisions_;
  std::size_t forgotten_ = 0;
  std::uint64_t plans_before_ = 0;  ///< Made by explorers that have since been restarted.
  std::uint64_t plans_ = 0;
  std::uint64_t abandoned_ = 0;
  Time decided_at_;                              ///< Stamp of the latest decision's status.
  Time decided_before_;                          ///< Stamp of the one before.
  std::optional<std::pair<Time, double>> path_;  ///< The latest: stamp and length.
};

}  // namespace thalweg::cli
