#include "services/inspector/adapter/gather_facts.h"

#include <algorithm>
#include <map>
#include <utility>

#include "common/base/environment.h"
#include "common/base/megabytes.h"
#include "common/base/text.h"
#include "common/base/version.h"
#include "common/dds/convert.h"
#include "common/dds/discovery.h"
#include "common/dds/qos.h"
#include "services/inspector/adapter/machine.h"
#include "services/inspector/adapter/survey.h"

namespace thalweg::inspector {
namespace {

/// The run's clock, if somebody publishes one: how far it is from this machine's.
class RunClock {
 public:
  explicit RunClock(dds::Bus& bus) {
    bus.SubscribeBytes(dds::InfoOf<dds::topics::Clock>(), [this](const dds::RawSample& sample) {
      const auto message = dds::Decode<dds::topics::Clock>(sample.bytes);
      const auto time = message ? dds::FromIdl(message->clock()) : Result<Time>(Error{"not decoded"});
      if (time) ahead_s_ = Seconds(*time - sample.reception_stamp);
    });
  }
  std::optional<double> ahead_s() const { return ahead_s_; }

 private:
  std::optional<double> ahead_s_;
};

/// Topics of the table under another name on the wire than the table gives them: no process of thalweg hears
/// them, nor is heard.
std::vector<WireNameFacts> MisnamedTopics(const dds::BusGraph& graph) {
  std::vector<WireNameFacts> misnamed;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    std::string name = endpoint.topic;
    while (const auto inner = dds::TopicName(name)) name = *inner;
    if (name.starts_with('/')) name.erase(0, 1);
    const dds::TopicInfo* const known = dds::FindTopic(name);
    if (known == nullptr || endpoint.topic == dds::WireTopic(name)) continue;
    misnamed.push_back({.participant = graph.NameOf(endpoint.participant),
                        .writes = endpoint.writes,
                        .topic = CleanText(endpoint.topic),
                        .meant = dds::WireTopic(name)});
  }
  return misnamed;
}

/// The offsets of other machines' clocks, from the messages of health that they write about once a second.
/// Their stamps are by the run's clock; the bus reports by which system clocks they were written and arrived.
class ClockComparison {
 public:
  explicit ClockComparison(dds::Bus& bus) {
    bus.SubscribeBytes(dds::InfoOf<dds::topics::Health>(), [this](const dds::RawSample& sample) {
      const auto health = dds::Decode<dds::topics::Health>(sample.bytes);
      if (!health || health->host() == own_host_ || hosts_.size() >= kMostHosts) return;
      const double difference = Seconds(sample.reception_stamp - sample.source_stamp);
      ClockFacts& host = hosts_[CleanText(health->host())];
      host.least_difference_s =
          host.samples == 0 ? difference : std::min(host.least_difference_s, difference);
      ++host.samples;
    });
  }
  std::vector<ClockFacts> Take() {
    std::vector<ClockFacts> clocks;
    for (auto& [host, facts] : hosts_) {
      facts.host = host;
      clocks.push_back(facts);
    }
    return clocks;
  }

 private:
  static constexpr std::size_t kMostHosts = 100;
  std::string own_host_ = OwnHost();
  std::map<std::string, ClockFacts> hosts_;
};

KernelFacts ReadKernel() {
  return {.rmem_max = NumberInFile("/proc/sys/net/core/rmem_max"),
          .wmem_max = NumberInFile("/proc/sys/net/core/wmem_max"),
          .ipfrag_high_thresh = NumberInFile("/proc/sys/net/ipv4/ipfrag_high_thresh"),
          .wanted_socket_bytes = dds::kSocketBufferBytes};
}

void LookAtBus(const dds::BusOptions& options, const std::stop_token& stop, Facts& facts) {
  dds::Bus bus(options);
  ClockComparison clocks(bus);
  const RunClock run_clock(bus);
  const dds::BusGraph graph = Survey(bus, stop);
  for (const dds::Participant& peer : graph.participants) {
    if (peer.is_discovery_server) ++facts.discovery_servers_answering;
    if (!peer.is_discovery_server) facts.peers.push_back({graph.NameOf(peer.id), CleanText(peer.version)});
  }
  for (const dds::Mismatch& mismatch : dds::FindMismatches(graph)) {
    facts.mismatches.push_back({mismatch.topic, mismatch.text, mismatch.advice});
  }
  facts.clocks = clocks.Take();
  facts.run_clock_ahead_s = run_clock.ahead_s();
  facts.misnamed = MisnamedTopics(graph);
  for (const dds::Participant& peer : graph.participants) {
    if (peer.host.empty() || peer.host == OwnHost()) continue;
    const std::string host = CleanText(peer.host);
    const bool compared = std::ranges::count(facts.clocks, host, &ClockFacts::host) > 0;
    if (!compared && std::ranges::count(facts.uncompared_hosts, host) == 0)
      facts.uncompared_hosts.push_back(host);
  }
}

}  // namespace

Facts GatherFacts(const dds::BusOptions& options, const std::filesystem::path& out_folder,
                  const std::stop_token& stop) {
  Facts facts;
  facts.version = Version();
  facts.domain = options.domain;
  facts.ros_domain_id = Environment("ROS_DOMAIN_ID");
  // Fast DDS itself follows the variable where nothing else is set.
  const std::string servers =
      options.discovery_server.empty() ? Environment("ROS_DISCOVERY_SERVER") : options.discovery_server;
  if (!servers.empty()) {
    for (auto& [id, host_and_port] : dds::ServersIn(servers)) {
      facts.discovery_servers.push_back({id, std::move(host_and_port)});
    }
  }
  facts.named_peers = options.peers;
  facts.kernel = ReadKernel();
  facts.shared_memory = ReadSharedMemory();  // before the bus removes what is stale
  facts.shared_memory.is_used = options.shared_memory;
  facts.shared_memory.segment = static_cast<std::uint64_t>(options.segment_mb) * kMegabyte;
  facts.interfaces = ReadInterfaces();
  facts.domains_in_use = DomainsInUse();
  facts.out_folder = out_folder.string();
  facts.out_available = FreeBytes(out_folder);
  LookAtBus(options, stop, facts);
  return facts;
}

}  // namespace thalweg::inspector
