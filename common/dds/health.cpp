#include "common/dds/health.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <utility>

#include "common/base/fresh_id.h"
#include "common/base/text.h"
#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

std::string HostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "an unnamed host";
}

/// " (3 more, 7 in total)"; nothing for the first one.
/// @param more  Since the line before.
std::string CountText(unsigned long long more, unsigned long long total) {
  if (total <= 1) return "";
  return more > 0 ? fmt::format(" ({} more, {} in total)", more, total)
                  : fmt::format(" ({} in total)", total);
}

}  // namespace

Health::Health(std::string service) : service_(std::move(service)), instance_(FreshId()) {}

void Health::Count(Entries& entries, const char* topic, const char* what, std::string_view reason,
                   unsigned long long count) {
  Entry& entry = entries[topic];
  const bool is_first = entry.count == 0;
  entry.count += count;
  entry.unlogged += count;
  entry.last = CleanText(reason);  // it may quote what a peer sent
  if (count == 0) return;          // a remark on what was counted before
  const auto now = std::chrono::steady_clock::now();
  if (!is_first && now - entry.logged < std::chrono::seconds(1)) return;
  spdlog::warn("{} {}: {}{}", topic, what, entry.last, CountText(entry.unlogged - 1, entry.count));
  entry.logged = now;
  entry.unlogged = 0;
}

void Health::FileNotWritten(std::string_view reason) {
  Entry& entry = dropped_[kFiles];
  ++entry.count;
  entry.last = CleanText(reason);
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
  message.host(HostName());
  message.process_id(static_cast<std::uint32_t>(getpid()));
  message.instance(instance_);
  message.uptime_s(std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
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
  add(crossed_, message.crossed());
  for (const auto& [name, timing] : timings_) {
    message.timings().push_back(ToIdl(name, timing.Summarize()));
  }
  return message;
}

}  // namespace thalweg::dds
