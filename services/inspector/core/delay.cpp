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

/// Farther from a clock, a stamp is by another one: no message takes so long, nor is any clock so wrong.
constexpr Duration kFarthest = std::chrono::hours(1);

/// How far most stamps may be ahead [s]: machines whose clocks are kept together are less apart, and the
/// run's clock is known only in steps, which may come late.
constexpr double kMostAhead = 1.0;

}  // namespace

Time StampIn(const Value& time) {
  const auto part = [&](std::size_t k) {
    return std::visit([](const auto number) { return static_cast<std::int64_t>(number); },
                      time.values()[k].number());
  };
  return Time{std::chrono::seconds(part(0)) + std::chrono::nanoseconds(part(1))};
}

void StampDelay::Add(Time stamp, Time arrival, const std::function<std::string()>& sender) {
  if (!run_time_ && !machine_clock_ && arrival - stamp > kOldest) {
    ++of_unheard_clock_;
    return;
  }
  const Duration delay = (by_run_clock() ? *run_time_ : arrival) - stamp;
  if (delay > kFarthest || delay < -kFarthest) {
    ++of_other_clock_;
    if (const std::string name = sender(); !name.empty()) their_senders_.insert(name);
    if (!machine_clock_) return;
  }
  meter_.Add(delay);
}

std::string StampDelay::ClockText() const {
  if (!meter_.Report() && of_unheard_clock_ > 0 && of_other_clock_ == 0) {
    return "the stamps are more than a day old, as those of simulated time are, and no run's clock has been "
           "heard: --machine-clock compares them with this machine's";
  }
  std::string text = by_run_clock() ? "against the run's clock" : "against this machine's clock";
  if (of_other_clock_ > 0) {
    text += "; more than an hour from it, so by another clock, are the stamps of " +
            (their_senders_.empty() ? "some senders" : Joined(their_senders_));
    if (!machine_clock_) text += ", which are left out";
  } else if (meter_.median() < -kMostAhead) {
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
