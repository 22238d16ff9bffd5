#include "common/dds/health.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <utility>

#include "common/dds/convert.h"

namespace thalweg::dds {

void Health::Count(Entries& entries, const char* topic, const char* what, std::string_view reason) {
  Entry& entry = entries[topic];
  ++entry.count;
  ++entry.unlogged;
  entry.last = reason;
  const auto now = std::chrono::steady_clock::now();
  if (entry.count > 1 && now - entry.logged < std::chrono::seconds(1)) return;
  spdlog::warn("{} {}: {} ({} more, {} in total)", topic, what, reason, entry.unlogged - 1, entry.count);
  entry.logged = now;
  entry.unlogged = 0;
}

unsigned long long Health::Total(const Entries& entries) {
  unsigned long long total = 0;
  for (const auto& [name, entry] : entries) total += entry.count;
  return total;
}

thalweg_msgs::msg::ServiceHealth Health::ToMessage(Time now) const {
  thalweg_msgs::msg::ServiceHealth message;
  message.header(MakeHeader(now, ""));
  message.service(service_);
  message.process_id(static_cast<std::uint32_t>(getpid()));
  const auto add = [](const Entries& entries, std::vector<thalweg_msgs::msg::Counter>& counters) {
    for (const auto& [name, entry] : entries) {
      thalweg_msgs::msg::Counter& counter = counters.emplace_back();
      counter.name(name);
      counter.count(entry.count);
      counter.last(entry.last);
    }
  };
  add(rejected_, message.rejected());
  add(dropped_, message.dropped());
  for (const auto& [name, timing] : timings_) {
    message.timings().push_back(ToIdl(name, timing.Summarize()));
  }
  return message;
}

}  // namespace thalweg::dds
