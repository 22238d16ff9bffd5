#include "services/inspector/adapter/gather_facts.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>

#include "common/base/text.h"
#include "common/base/version.h"
#include "common/dds/qos.h"
#include "services/inspector/adapter/machine.h"
#include "services/inspector/adapter/survey.h"

namespace thalweg::inspector {
namespace {

std::string Environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string OwnHost() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// The offsets of other machines' clocks, from the messages of health that they write about once a second.
/// Their stamps are by the run's clock; the bus tells by which system clocks they were written and arrived.
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
  const dds::BusGraph graph = Survey(bus, stop);
  for (const dds::Participant& peer : graph.participants) {
    facts.discovery_server_answers = facts.discovery_server_answers || peer.is_discovery_server;
    if (!peer.is_discovery_server) facts.peers.push_back({graph.NameOf(peer.id), CleanText(peer.version)});
  }
  for (const dds::Mismatch& mismatch : dds::FindMismatches(graph)) {
    facts.mismatches.push_back({mismatch.topic, mismatch.text, mismatch.advice});
  }
  facts.clocks = clocks.Take();
}

}  // namespace

Facts GatherFacts(const dds::BusOptions& options, const std::filesystem::path& out_folder,
                  const std::stop_token& stop) {
  Facts facts;
  facts.version = Version();
  facts.domain = options.domain;
  facts.ros_domain_id = Environment("ROS_DOMAIN_ID");
  // Fast DDS itself follows the variable where nothing else is set.
  facts.discovery_server =
      options.discovery_server.empty() ? Environment("ROS_DISCOVERY_SERVER") : options.discovery_server;
  facts.named_peers = options.peers;
  facts.kernel = ReadKernel();
  facts.shared_memory = ReadSharedMemory();  // before the bus removes what is stale
  facts.shared_memory.is_used = options.shared_memory;
  facts.shared_memory.segment = static_cast<std::uint64_t>(options.segment_mb) * 1'000'000;
  facts.interfaces = ReadInterfaces();
  facts.domains_in_use = DomainsInUse();
  facts.out_folder = out_folder.string();
  facts.out_available = FreeBytes(out_folder);
  LookAtBus(options, stop, facts);
  return facts;
}

}  // namespace thalweg::inspector
