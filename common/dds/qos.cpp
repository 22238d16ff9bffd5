#include "common/dds/qos.h"

#include <arpa/inet.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "common/base/megabytes.h"
#include "common/base/version.h"
#include "common/dds/discovery.h"
#include "common/dds/guarded_transport.h"
#include "common/dds/network_interfaces.h"
#include "common/dds/rtps_ports.h"
#include "common/dds/shared_memory_files.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
namespace fastrtps = eprosima::fastrtps;
namespace rtps = eprosima::fastrtps::rtps;
namespace transport = eprosima::fastdds::rtps;

// The largest RTPS message on a network: with the headers of UDP and IP it fits a link of 1400 bytes, such as
// a tunnel, in one packet. Of a message that IP has to cut, the loss of one piece loses the whole: with
// messages of 64 kB, 2 % of lost packets leave 40 % of them.
constexpr std::uint32_t kNetworkMessageBytes = 1372;
// The same with security: two participants introduce themselves by one message each with certificate and
// permissions, about 5 kB, which Fast DDS 2.9 does not cut. IP cuts a message of this size into six.
constexpr std::uint32_t kSecureMessageBytes = 8192;
// A reliable writer announces what it has sent in this period, so that readers notice a loss at a sample's
// end. With the 3 s that are Fast DDS's default, a map could lag by as much.
const fastrtps::Duration_t kHeartbeatPeriod(0, 20'000'000);
// A writer repairs a loss this long after the reader's request.
const fastrtps::Duration_t kRepairDelay(0, 1'000'000);
// Samples that wait for a recorder, which handles one of each topic a turn.
constexpr std::int32_t kRecordedDepth = 100;

// Frames of a link that may be unacknowledged.
constexpr std::int32_t kMostFrames = 512;

// Our largest system has 12 participants, and none has more than 40 readers or writers. A process of ROS 2
// has about 20 of its own.
constexpr std::size_t kMostParticipants = 128;
constexpr std::size_t kMostMatchedEndpoints = 128;
// A forged sample takes the place of a genuine one in a reader's history, although it is then refused. Of
// these many, a reader that follows one writer still finds the newest genuine one.
constexpr std::int32_t kLeastReadDepth = 16;

struct Policy {
  bool written_reliably;
  bool read_reliably;
  bool late_joiners;
  std::int32_t depth;  ///< 0 = all samples, until they are acknowledged.
  bool asynchronous;
  fastrtps::Duration_t deadline;
  fastrtps::Duration_t lifespan;
};

Policy PolicyOf(Delivery delivery) {
  Policy policy{.written_reliably = true,
                .read_reliably = true,
                .late_joiners = false,
                .depth = 1,
                .asynchronous = false,
                .deadline = fastrtps::c_TimeInfinite,
                .lifespan = fastrtps::c_TimeInfinite};
  switch (delivery) {
    case Delivery::kStream:
      // So that a lost piece can be repaired after the next samples have been written: over a link that
      // delays by 20 ms and loses 5 %, 46 of 2088 clouds arrived with a depth of 1.
      policy.depth = 8;
      policy.asynchronous = true;
      break;
    case Delivery::kSamples:
      policy.read_reliably = false;
      policy.depth = 100;
      break;
    case Delivery::kLog:
      policy.depth = 200;
      policy.asynchronous = true;
      break;
    case Delivery::kState:
      policy.late_joiners = true;
      break;
    case Delivery::kDiary:
      policy.late_joiners = true;
      policy.depth = 100;
      policy.asynchronous = true;
      break;
    case Delivery::kCommand:
      policy.deadline = fastrtps::Duration_t(0, 250'000'000);
      policy.lifespan = fastrtps::Duration_t(0, 500'000'000);
      break;
    case Delivery::kFrames:
      policy.depth = 0;
      break;
  }
  return policy;
}

/// The policies that a writer and a reader have in common.
template <class Qos>
Qos QosFrom(const Policy& policy, bool reliable) {
  Qos qos;
  qos.reliability().kind =
      reliable ? fastdds::RELIABLE_RELIABILITY_QOS : fastdds::BEST_EFFORT_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = fastrtps::Duration_t(0, 100'000'000);
  qos.durability().kind =
      policy.late_joiners ? fastdds::TRANSIENT_LOCAL_DURABILITY_QOS : fastdds::VOLATILE_DURABILITY_QOS;
  if (policy.depth > 0) {
    qos.history().kind = fastdds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = policy.depth;
  } else {
    qos.history().kind = fastdds::KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples = kMostFrames;
    qos.resource_limits().max_instances = 1;
    qos.resource_limits().max_samples_per_instance = kMostFrames;
  }
  qos.lifespan().duration = policy.lifespan;
  qos.liveliness().kind = fastdds::AUTOMATIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = fastrtps::c_TimeInfinite;
  qos.ownership().kind = fastdds::SHARED_OWNERSHIP_QOS;
  qos.destination_order().kind = fastdds::BY_RECEPTION_TIMESTAMP_DESTINATIONORDER_QOS;
  // Data sharing needs bounded types and the same user on all peers that share /dev/shm; the shared-memory
  // transport needs neither.
  qos.data_sharing().off();
  // Streams reuse their buffers, while a log must not keep 200 buffers of the size of its largest message.
  qos.endpoint().history_memory_policy =
      policy.depth <= 8 ? rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE : rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  return qos;
}

/// Lets a participant listen, by UDP, at the first ports of its domain that are free, whatever its ID is,
/// since peers try only the first ones; through shared memory at fresh ports.
/// @param has_server  Whether it takes part in discovery through a server, and then by UDP alone:
///                    ServerFarewells must hear all that a server says, and shared memory is not guarded.
void SetPorts(int domain, bool has_server, fastdds::DomainParticipantQos& qos) {
  auto& protocol = qos.wire_protocol();
  auto& builtin = protocol.builtin;
  // Two ports for each participant; the last domain has fewer of them, since ports end.
  builtin.mutation_tries = static_cast<std::uint32_t>(
      std::min(kParticipantsPerDomain - 1, (kLastPort - 1 - FirstPortOf(domain, 0)) / 2));
  for (const auto& descriptor : qos.transport().user_transports) {
    const std::unique_ptr<transport::TransportInterface> its(descriptor->create_transport());
    const bool is_udp = its->kind() == LOCATOR_KIND_UDPv4;
    const std::uint32_t first =
        is_udp ? static_cast<std::uint32_t>(FirstPortOf(domain, 0)) : FreshSharedPorts(domain);
    // Not through shared memory, as Fast DDS chooses by itself: all share that port, and what breaks one
    // breaks all.
    if (is_udp && !has_server) {
      its->getDefaultMetatrafficMulticastLocators(
          builtin.metatrafficMulticastLocatorList,
          static_cast<std::uint32_t>(kFirstPort + kPortsOfDomain * domain));
    }
    if (is_udp || !has_server) {
      its->getDefaultMetatrafficUnicastLocators(builtin.metatrafficUnicastLocatorList, first);
    }
    its->getDefaultUnicastLocators(protocol.default_unicast_locator_list, first + 1);
  }
}

}  // namespace

std::uint32_t LargestMessageBytes(bool local_only, bool has_keys) {
  if (local_only) return transport::UDPv4TransportDescriptor().maxMessageSize;
  return has_keys ? kSecureMessageBytes : kNetworkMessageBytes;
}

fastdds::DomainParticipantQos ParticipantQosFrom(const BusOptions& options, std::shared_ptr<Guard> guard,
                                                 const std::optional<SecurityKeys>& keys) {
  fastdds::DomainParticipantQos qos;
  qos.name(options.name);
  if (keys) qos.properties() = PropertiesFrom(*keys);
  qos.properties().properties().emplace_back(kVersionProperty, std::string(Version()), true);

  auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
  udp->sendBufferSize = kSocketBufferBytes;
  udp->receiveBufferSize = kSocketBufferBytes;
  udp->maxInitialPeersRange = kParticipantsPerPeer;
  if (options.local_only) udp->TTL = 0;  // multicast stays on this machine
  if (!options.network_interface.empty()) {
    in_addr parsed{};
    if (inet_pton(AF_INET, options.network_interface.c_str(), &parsed) != 1) {
      throw std::runtime_error("network interface \"" + options.network_interface +
                               "\": must be an IPv4 address");
    }
    CheckInterfaceExists(options.network_interface);
    udp->interfaceWhiteList.push_back(options.network_interface);
  }
  qos.transport().use_builtin_transports = false;
  qos.transport().send_socket_buffer_size = kSocketBufferBytes;
  qos.transport().listen_socket_buffer_size = kSocketBufferBytes;
  if (options.shared_memory && !keys && options.peers.empty()) {
    auto shared_memory = std::make_shared<transport::SharedMemTransportDescriptor>();
    shared_memory->segment_size(
        static_cast<std::uint32_t>(static_cast<std::uint64_t>(options.segment_mb) * kMegabyte));
    qos.transport().user_transports.push_back(shared_memory);
  }
  qos.transport().user_transports.push_back(std::make_shared<GuardedTransportDescriptor>(
      udp, LargestMessageBytes(options.local_only, keys.has_value()), options.local_only, keys.has_value(),
      PrefixesOfServers(options.discovery_server), std::move(guard)));

  // So that announcements of strangers do not fill the memory: 512 participants that announce all that they
  // may take about 100 MB.
  qos.allocation().participants.maximum = kMostParticipants;
  qos.allocation().readers.maximum = kMostMatchedEndpoints;
  qos.allocation().writers.maximum = kMostMatchedEndpoints;

  SetDiscovery(options, keys.has_value(), qos.wire_protocol());
  SetPorts(options.domain, !options.discovery_server.empty(), qos);
  return qos;
}

std::optional<std::uint32_t> SharedPortsOf(const fastdds::DomainParticipantQos& qos) {
  for (const auto& locator : qos.wire_protocol().default_unicast_locator_list) {
    if (locator.kind == LOCATOR_KIND_SHM) return locator.port - 1;
  }
  return std::nullopt;
}

fastdds::DataWriterQos WriterQosFrom(Delivery delivery) {
  const Policy policy = PolicyOf(delivery);
  auto qos = QosFrom<fastdds::DataWriterQos>(policy, policy.written_reliably);
  qos.deadline().period = policy.deadline;
  qos.publish_mode().kind =
      policy.asynchronous ? fastdds::ASYNCHRONOUS_PUBLISH_MODE : fastdds::SYNCHRONOUS_PUBLISH_MODE;
  qos.reliable_writer_qos().times.heartbeatPeriod = kHeartbeatPeriod;
  qos.reliable_writer_qos().times.nackResponseDelay = kRepairDelay;
  return qos;
}

fastdds::DataReaderQos ReaderQosFrom(Delivery delivery, bool best_effort, Keep keep) {
  Policy policy = PolicyOf(delivery);
  if (keep == Keep::kForRecording) {
    policy.depth = std::max(policy.depth, kRecordedDepth);
    policy.lifespan = fastrtps::c_TimeInfinite;
  }
  // Without a deadline, so that commanders that state none are heard as well.
  auto qos = QosFrom<fastdds::DataReaderQos>(policy, policy.read_reliably && !best_effort);
  // A reader's lifespan would be counted from the writer's clock to this machine's: where that is ahead by
  // half a second, no command would arrive, and nothing would say so.
  qos.lifespan().duration = fastrtps::c_TimeInfinite;
  qos.history().depth = std::max(qos.history().depth, kLeastReadDepth);
  return qos;
}

std::size_t KeptForLateJoiners(Delivery delivery) {
  const Policy policy = PolicyOf(delivery);
  return policy.late_joiners ? static_cast<std::size_t>(policy.depth) : 0;
}

Duration LongestWaitOf(Delivery delivery) {
  const fastrtps::Duration_t lifespan = PolicyOf(delivery).lifespan;
  return lifespan == fastrtps::c_TimeInfinite ? Duration::max() : Duration(lifespan.to_ns());
}

}  // namespace thalweg::dds
