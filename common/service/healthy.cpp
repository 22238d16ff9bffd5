#include "common/service/healthy.h"

#include <spdlog/fmt/fmt.h>

#include <optional>

namespace thalweg {

Healthiness CheckHealthy(dds::BusOptions options, Duration patience) {
  const std::string name = options.name;
  options.clock = dds::ClockSource::kSystem;
  options.publish_health = false;
  options.sole = false;
  dds::Bus bus(options);
  const std::string host = bus.health().ToMessage(Time{}).host();
  std::optional<thalweg_msgs::msg::ServiceHealth> first;
  std::optional<thalweg_msgs::msg::ServiceHealth> second;
  bus.Subscribe<dds::topics::Health>([&](const auto& message) {
    if (message.service() != name || message.host() != host) return;
    const bool advances =
        first && first->instance() == message.instance() && message.uptime_s() > first->uptime_s();
    (advances ? second : first) = message;
  });
  if (bus.SpinUntil([&] { return second.has_value(); }, patience)) {
    return {true, fmt::format("process {} works, since {:.0f} s", second->process_id(), second->uptime_s())};
  }
  const std::string where = fmt::format("in DDS domain {} on {}", options.domain, host);
  if (first) {
    return {false, fmt::format("process {} was heard only once in {:.0f} s {}: its loop does not advance",
                               first->process_id(), Seconds(patience), where)};
  }
  return {false,
          fmt::format("not heard in {:.0f} s {}: it does not run, or hangs", Seconds(patience), where)};
}

}  // namespace thalweg
