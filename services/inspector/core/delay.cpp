#include "services/inspector/core/delay.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <variant>
#include <vector>

#include "common/base/text.h"

namespace thalweg::inspector {
namespace {

/// A message that is older was stamped by another clock: simulated time begins near 0.
constexpr Duration kOldest = std::chrono::hours(24);

// How far a stamp may be ahead of the clock that it is compared with: machines whose clocks are kept together
// are less apart, and the run's clock is known only in steps.
constexpr Duration kMachinesApart = std::chrono::milliseconds(5);
constexpr Duration kRunClockStep = std::chrono::milliseconds(100);

}  // namespace

Time StampIn(const Value& time) {
  const auto part = [&](std::size_t k) {
    return std::visit([](const auto number) { return static_cast<std::int64_t>(number); },
                      time.values()[k].number());
  };
  return Time{std::chrono::seconds(part(0)) + std::chrono::nanoseconds(part(1))};
}

void StampDelay::Add(Time stamp, Time arrival) {
  if (!run_time_ && !machine_clock_ && arrival - stamp > kOldest) {
    ++of_unheard_clock_;
    return;
  }
  const Duration delay = (by_run_clock() ? *run_time_ : arrival) - stamp;
  earliest_ = std::min(earliest_, delay);
  meter_.Add(delay);
}

std::string StampDelay::ClockText() const {
  if (!meter_.Report() && of_unheard_clock_ > 0) {
    return "the stamps are more than a day old, as those of simulated time are, and no run's clock has been "
           "heard: --machine-clock compares them with this machine's";
  }
  std::string text = by_run_clock() ? "against the run's clock" : "against this machine's clock";
  if (-earliest_ > (by_run_clock() ? kRunClockStep : kMachinesApart)) {
    text +=
        "; stamps are ahead of it, so another clock made them: thalweg doctor compares the machines' clocks";
  }
  return text;
}

std::optional<std::string> DelayReport::Text(const std::set<std::string>& other_hosts) {
  std::vector<std::string> parts;
  const auto add_once = [&](const std::string& text) {
    if (printed_.insert(text).second) parts.push_back(text);
  };
  add_once(delay_.ClockText());
  if (!other_hosts.empty() && !delay_.by_run_clock()) {
    add_once("published on " + Joined(other_hosts) +
             ": a delay contains the difference between the machines' clocks");
  }
  if (const auto figures = delay_.Report()) parts.push_back(*figures);
  return parts.empty() ? std::nullopt : std::optional(Joined(parts, "\n"));
}

}  // namespace thalweg::inspector
