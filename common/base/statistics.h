#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thalweg {

/// Collects the durations of one repeated operation and computes their percentiles, to 1 %.
///
/// Counts samples in bins that grow by 1/64 of an octave each, which takes a fixed 10 kB however long the
/// service runs.
class TimingStatistics {
 public:
  void Add(double milliseconds);
  std::size_t count() const { return count_; }

  struct Summary {
    std::size_t count = 0;
    double p50_ms = 0.0;
    double p95_ms = 0.0;
    double max_ms = 0.0;  ///< Exact.
  };
  Summary Summarize() const;  ///< Nearest-rank percentiles; all 0 without samples.

 private:
  double Percentile(double share) const;

  std::vector<std::uint32_t> bins_;  ///< Empty without samples.
  std::size_t count_ = 0;
  double max_ms_ = 0.0;
};

}  // namespace thalweg
