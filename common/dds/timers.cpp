#include "common/dds/timers.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "common/base/check.h"
#include "common/dds/convert.h"

namespace thalweg::dds {

void Timers::AddWall(Duration period, std::function<void()> handler) {
  THALWEG_CHECK(period > Duration::zero());
  wall_timers_.push_back({period, std::move(handler), std::chrono::steady_clock::now() + period});
}

void Timers::AddTopic(Duration period, std::function<void()> handler) {
  THALWEG_CHECK(period > Duration::zero());
  topic_timers_.push_back({period, std::move(handler), topic_now() + period});
}

void Timers::OnClock(const rosgraph_msgs::msg::Clock& message) {
  const Result<Time> now = FromIdl(message.clock());
  if (!now) return health_.Reject<topics::Clock>(now.error());
  SetTopicNow(*now);
}

void Timers::SetTopicNow(Time now) {
  const Time before = topic_now();
  const bool restarted = topic_clock_runs_ && now < before;
  if (restarted) {
    const SteadyTime wall = std::chrono::steady_clock::now();
    if (wall - last_restart_ < std::chrono::seconds(1)) {
      health_.Reject<topics::Clock>("jumps back and forth: there are two simulators in this domain");
    } else {
      spdlog::warn("clock jumped back by {:.3f} s: the simulator was restarted, or a replay goes back",
                   Seconds(before - now));
    }
    last_restart_ = wall;
  }
  if (restarted || !topic_clock_runs_) {
    for (Timer<Time>& timer : topic_timers_) timer.due = now + timer.period;
  }
  topic_clock_runs_ = true;
  topic_now_ = now.time_since_epoch().count();
}

void Timers::RunDue() {
  const SteadyTime now = std::chrono::steady_clock::now();
  for (std::size_t k = 0; k < wall_timers_.size(); ++k) {
    if (!wall_timers_[k].Take(now)) continue;
    doing_("a timer");
    wall_timers_[k].handler();
  }
  if (!topic_clock_runs_) return;
  const Time simulated = topic_now();
  for (std::size_t k = 0; k < topic_timers_.size(); ++k) {
    if (!topic_timers_[k].Take(simulated)) continue;
    doing_("a timer");
    topic_timers_[k].handler();
  }
}

Timers::SteadyTime Timers::Next() const {
  SteadyTime next = SteadyTime::max();
  for (const Timer<SteadyTime>& timer : wall_timers_) next = std::min(next, timer.due);
  return next;
}

}  // namespace thalweg::dds
