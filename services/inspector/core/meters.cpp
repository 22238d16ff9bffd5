#include "services/inspector/core/meters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/median.h"
#include "common/base/megabytes.h"

namespace thalweg::inspector {
namespace {

std::string SpreadText(const Spread& spread, std::size_t messages) {
  return fmt::format("\tmin: {:.5f}s max: {:.5f}s std dev: {:.5f}s window: {}", spread.min, spread.max,
                     spread.deviation, messages);
}

/// "2.17 MB": with the largest unit of which there is one.
std::string Bytes(double bytes) {
  if (bytes < 1e3) return fmt::format("{:.0f} B", bytes);
  if (bytes < 1e6) return fmt::format("{:.2f} KB", 1e-3 * bytes);
  return fmt::format("{:.2f} MB", Megabytes(bytes));
}

double Sum(const std::deque<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

}  // namespace

void Window::Add(double number) {
  if (numbers_.size() == most_) numbers_.pop_front();
  numbers_.push_back(number);
}

Spread Window::Summarize() const {
  if (numbers_.empty()) return {};
  const auto count = static_cast<double>(numbers_.size());
  Spread spread{.count = numbers_.size(), .mean = Sum(numbers_) / count};
  const auto [min, max] = std::ranges::minmax_element(numbers_);
  spread.min = *min;
  spread.max = *max;
  double squares = 0.0;
  for (const double number : numbers_) squares += (number - spread.mean) * (number - spread.mean);
  spread.deviation = std::sqrt(squares / count);
  return spread;
}

void RateMeter::Add(Time arrival) {
  if (last_) periods_.Add(Seconds(arrival - *last_));
  last_ = arrival;
}

double RateMeter::hz() const {
  const Spread spread = periods_.Summarize();
  return spread.mean > 0.0 ? 1.0 / spread.mean : 0.0;
}

std::optional<std::string> RateMeter::Report() const {
  const Spread spread = periods_.Summarize();
  if (spread.count == 0) return std::nullopt;
  return fmt::format("average rate: {:.3f}\n", hz()) + SpreadText(spread, spread.count + 1);
}

void BandwidthMeter::Add(Time arrival, std::size_t bytes) {
  if (last_) {
    periods_.Add(Seconds(arrival - *last_));
    sizes_.Add(static_cast<double>(bytes));
  }
  last_ = arrival;
}

double BandwidthMeter::bytes_per_second() const {
  const double span = Sum(periods_.numbers());
  return span > 0.0 ? Sum(sizes_.numbers()) / span : 0.0;
}

std::optional<std::string> BandwidthMeter::Report() const {
  const Spread sizes = sizes_.Summarize();
  if (sizes.count == 0) return std::nullopt;
  return fmt::format("{}/s from {} messages\n\tMessage size mean: {} min: {} max: {}",
                     Bytes(bytes_per_second()), sizes.count, Bytes(sizes.mean), Bytes(sizes.min),
                     Bytes(sizes.max));
}

ArrivalWatch::Finding ArrivalWatch::Look(std::uint64_t received) {
  const bool is_new = received > before_;
  before_ = received;
  if (is_new) {
    silent_ = 0;
    return Finding::kNew;
  }
  return ++silent_ == kSilentLooks ? Finding::kSilent : Finding::kNone;
}

double DelayMeter::median() const {
  return Median({delays_.numbers().begin(), delays_.numbers().end()});
}

std::optional<std::string> DelayMeter::Report() const {
  const Spread spread = delays_.Summarize();
  if (spread.count == 0) return std::nullopt;
  return fmt::format("average delay: {:.3f}\n", spread.mean) + SpreadText(spread, spread.count);
}

}  // namespace thalweg::inspector
