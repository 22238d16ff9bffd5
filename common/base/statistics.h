#pragma once

#include <cstddef>
#include <vector>

namespace thalweg {

/// Keeps the durations of one repeated piece of work and tells their percentiles.
class TimingStatistics {
 public:
  void Add(double milliseconds) { samples_ms_.push_back(milliseconds); }
  std::size_t count() const { return samples_ms_.size(); }

  struct Summary {
    std::size_t count = 0;
    double p50_ms = 0.0;
    double p95_ms = 0.0;
    double max_ms = 0.0;
  };
  Summary Summarize() const;  ///< Nearest-rank percentiles; all 0 without samples. O(n log n).

 private:
  std::vector<double> samples_ms_;
};

}  // namespace thalweg
