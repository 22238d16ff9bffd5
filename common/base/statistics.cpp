#include "common/base/statistics.h"

#include <algorithm>
#include <cmath>

namespace thalweg {
namespace {

constexpr double kShortest_ms = 1e-4;  // The first bin holds everything shorter.
constexpr double kBinsPerOctave = 64.0;
constexpr std::size_t kOctaves = 40;  // up to three years

std::size_t BinOf(double milliseconds) {
  if (!(milliseconds > kShortest_ms)) return 0;
  const double bin = 1.0 + std::log2(milliseconds / kShortest_ms) * kBinsPerOctave;
  return std::min(static_cast<std::size_t>(bin), kOctaves * static_cast<std::size_t>(kBinsPerOctave));
}

double MiddleOf(std::size_t bin) {
  if (bin == 0) return 0.0;
  return kShortest_ms * std::exp2((static_cast<double>(bin) - 0.5) / kBinsPerOctave);
}

}  // namespace

void TimingStatistics::Add(double milliseconds) {
  if (bins_.empty()) bins_.resize(kOctaves * static_cast<std::size_t>(kBinsPerOctave) + 1);
  ++bins_[BinOf(milliseconds)];
  ++count_;
  max_ms_ = std::max(max_ms_, milliseconds);
}

double TimingStatistics::Percentile(double share) const {
  const auto rank = static_cast<std::size_t>(std::max(1.0, std::ceil(share * static_cast<double>(count_))));
  std::size_t seen = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    seen += bins_[bin];
    if (seen >= rank) return std::min(MiddleOf(bin), max_ms_);
  }
  return max_ms_;
}

TimingStatistics::Summary TimingStatistics::Summarize() const {
  if (count_ == 0) return {};
  return {.count = count_, .p50_ms = Percentile(0.50), .p95_ms = Percentile(0.95), .max_ms = max_ms_};
}

}  // namespace thalweg
