#include "common/dds/peers.h"

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <fastrtps/utils/IPLocator.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <fastdds/dds/core/policy/ParameterTypes.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <sstream>

#include "common/dds/qos.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

// What a stranger announces must not fill the memory.
constexpr std::size_t kMostPeers = 1000;
constexpr std::size_t kMostKnownEndpoints = 20'000;

std::string AddressOf(const rtps::ParticipantProxyData& peer) {
  for (const rtps::Locator_t& locator : peer.default_locators.unicast) {
    if (locator.kind == LOCATOR_KIND_UDPv4) return rtps::IPLocator::ip_to_string(locator);
  }
  return "";
}

std::string ParticipantId(const rtps::GuidPrefix_t& prefix) {
  std::ostringstream text;
  text << prefix;
  return text.str();
}

/// [OMG DDSI-RTPS 2.5, table 9.2, and https://www.dds-foundation.org/dds-rtps-vendor-and-product-ids]
std::string VendorOf(const rtps::VendorId_t& id) {
  if (id[0] == 1) {
    switch (id[1]) {
      case 0x01:
        return "RTI Connext";
      case 0x02:
        return "OpenSplice";
      case 0x03:
        return "OpenDDS";
      case 0x0F:
        return "eProsima Fast DDS";
      case 0x10:
        return "Eclipse Cyclone DDS";
      case 0x12:
        return "RustDDS";
      default:
        break;
    }
  }
  return fmt::format("vendor {:02x}.{:02x}", id[0], id[1]);
}

/// "1234" of "1234_3", which a statistics tool takes apart; else the text.
std::string ProcessOf(const std::string& property) {
  return property.substr(0, std::min(property.find_first_not_of("0123456789"), property.size()));
}

Participant ParticipantFrom(const rtps::ParticipantProxyData& data) {
  Participant participant{.id = ParticipantId(data.m_guid.guidPrefix),
                          .name = data.m_participantName.to_string(),
                          .address = AddressOf(data),
                          .host = {},
                          .process = {},
                          .vendor = VendorOf(data.m_VendorId),
                          .version = {}};
  const auto found = [](const std::string& value) { return value.substr(0, value.find('\0')); };
  // The copy, since iterating over a constant list is not foreseen.
  fastdds::ParameterPropertyList_t properties = data.m_properties;
  for (auto property = properties.begin(); property != properties.end(); ++property) {
    const std::string name = found(property->first());
    const std::string value = found(property->second());
    if (name == fastdds::parameter_policy_physical_data_host)
      participant.host = value.substr(0, value.find(':'));
    if (name == fastdds::parameter_policy_physical_data_process) participant.process = ProcessOf(value);
    if (name == kVersionProperty) participant.version = value;
    if (name == fastdds::parameter_property_participant_type) {
      participant.is_discovery_server = value == "SERVER" || value == "BACKUP";
    }
  }
  return participant;
}

std::optional<Duration> PeriodFrom(const eprosima::fastrtps::Duration_t& duration) {
  if (duration == eprosima::fastrtps::c_TimeInfinite) return std::nullopt;
  return std::chrono::seconds(duration.seconds) + std::chrono::nanoseconds(duration.nanosec);
}

template <class Qos>
EndpointQos EndpointQosFrom(const Qos& qos) {
  EndpointQos out{
      .reliable = qos.m_reliability.kind == fastdds::RELIABLE_RELIABILITY_QOS,
      .durability = static_cast<Durability>(std::clamp(static_cast<int>(qos.m_durability.kind), 0, 3)),
      .deadline = PeriodFrom(qos.m_deadline.period),
      .liveliness = static_cast<Liveliness>(std::clamp(static_cast<int>(qos.m_liveliness.kind), 0, 2)),
      .lease = PeriodFrom(qos.m_liveliness.lease_duration),
      .exclusive = qos.m_ownership.kind == fastdds::EXCLUSIVE_OWNERSHIP_QOS,
      .by_source_stamp = qos.m_destinationOrder.kind == fastdds::BY_SOURCE_TIMESTAMP_DESTINATIONORDER_QOS};
  return out;
}

/// The endpoint that a writer or a reader announces.
template <class Proxy>
Endpoint EndpointFrom(const Proxy& proxy, bool writes) {
  Endpoint endpoint{.participant = ParticipantId(proxy.guid().guidPrefix),
                    .writes = writes,
                    .topic = proxy.topicName().to_string(),
                    .type = proxy.typeName().to_string(),
                    .qos = EndpointQosFrom(proxy.m_qos)};
  for (const std::string& partition : proxy.m_qos.m_partition.getNames())
    endpoint.partitions.push_back(partition);
  return endpoint;
}

}  // namespace

std::string Peers::Name(const Guid& endpoint) const {
  const std::lock_guard lock(mutex_);
  const auto found = participants_.find(endpoint.guidPrefix);
  if (found == participants_.end()) return "participant " + ParticipantId(endpoint.guidPrefix);
  const Participant& peer = found->second;
  // Without an address it is reached by shared memory alone.
  return fmt::format("\"{}\" ({})", peer.name, peer.address.empty() ? "this machine" : peer.address);
}

std::vector<Mismatch> Peers::MismatchesOf(const Endpoint& writer) const {
  BusGraph graph;
  const std::lock_guard lock(mutex_);
  for (const auto& [prefix, participant] : participants_) graph.participants.push_back(participant);
  Participant& self = graph.participants.emplace_back();
  self.id = writer.participant;
  self.name = "this process";
  graph.endpoints.push_back(writer);
  for (const auto& [guid, reader] : demanding_readers_) {
    if (reader.topic == writer.topic) graph.endpoints.push_back(reader);
  }
  return FindMismatches(graph);
}

BusGraph Peers::Graph() const {
  const std::lock_guard lock(mutex_);
  BusGraph graph;
  for (const auto& [prefix, participant] : participants_) graph.participants.push_back(participant);
  for (const auto& [guid, endpoint] : endpoints_) graph.endpoints.push_back(endpoint);
  return graph;
}

void Peers::Forget() {
  const std::lock_guard lock(mutex_);
  participants_.clear();
  endpoints_.clear();
  reliable_writers_.clear();
  demanding_readers_.clear();
}

bool Peers::IsNamed(const Guid& endpoint, const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = participants_.find(endpoint.guidPrefix);
  return found != participants_.end() && found->second.name == name;
}

bool Peers::IsReliable(const Guid& writer) const {
  const std::lock_guard lock(mutex_);
  return reliable_writers_.contains(writer);
}

void Peers::on_participant_discovery(fastdds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) {
  using Status = rtps::ParticipantDiscoveryInfo;
  const Prefix prefix = info.info.m_guid.guidPrefix;
  const std::lock_guard lock(mutex_);
  if (info.status == Status::REMOVED_PARTICIPANT || info.status == Status::DROPPED_PARTICIPANT) {
    participants_.erase(prefix);
    std::erase_if(reliable_writers_, [&](const Guid& writer) { return writer.guidPrefix == prefix; });
    std::erase_if(demanding_readers_, [&](const auto& entry) { return entry.first.guidPrefix == prefix; });
    std::erase_if(endpoints_, [&](const auto& entry) { return entry.first.guidPrefix == prefix; });
  } else if (participants_.size() < kMostPeers || participants_.contains(prefix)) {
    participants_[prefix] = ParticipantFrom(info.info);
  }
}

void Peers::Set(const Guid& guid, bool removed, Endpoint endpoint) {
  const std::lock_guard lock(mutex_);
  if (removed) {
    endpoints_.erase(guid);
  } else if (endpoints_.size() < kMostKnownEndpoints || endpoints_.contains(guid)) {
    endpoints_[guid] = std::move(endpoint);
  }
}

void Peers::NoteReliability(const rtps::WriterDiscoveryInfo& info) {
  const bool is_gone = info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER;
  const bool is_reliable = info.info.m_qos.m_reliability.kind == fastdds::RELIABLE_RELIABILITY_QOS;
  const std::lock_guard lock(mutex_);
  if (is_gone || !is_reliable) {
    reliable_writers_.erase(info.info.guid());
  } else if (reliable_writers_.size() < kMostKnownEndpoints) {
    reliable_writers_.insert(info.info.guid());
  }
}

void Peers::NoteDemands(const rtps::ReaderDiscoveryInfo& info) {
  constexpr std::size_t kMostDemanding = 1000;
  const EndpointQos qos = EndpointQosFrom(info.info.m_qos);
  const bool demands = qos.durability != Durability::kVolatile || qos.deadline || qos.lease ||
                       qos.exclusive || qos.liveliness != Liveliness::kAutomatic || qos.by_source_stamp;
  const bool is_gone = info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER;
  const std::lock_guard lock(mutex_);
  if (is_gone || !demands) {
    demanding_readers_.erase(info.info.guid());
  } else if (demanding_readers_.size() < kMostDemanding) {
    demanding_readers_[info.info.guid()] = EndpointFrom(info.info, false);
  }
}

void Peers::on_subscriber_discovery(fastdds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) {
  NoteDemands(info);
  if (!keeps_endpoints_) return;
  Set(info.info.guid(), info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER,
      EndpointFrom(info.info, false));
}

void Peers::on_publisher_discovery(fastdds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) {
  NoteReliability(info);
  if (!keeps_endpoints_) return;
  Endpoint endpoint = EndpointFrom(info.info, true);
  endpoint.qos.lifespan = PeriodFrom(info.info.m_qos.m_lifespan.duration);
  Set(info.info.guid(), info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER, std::move(endpoint));
}

Endpoint EndpointOf(const fastdds::DataWriter& writer, const std::vector<std::string>& partitions) {
  const fastdds::DataWriterQos& qos = writer.get_qos();
  EndpointQos offered{
      .reliable = qos.reliability().kind == fastdds::RELIABLE_RELIABILITY_QOS,
      .durability = static_cast<Durability>(std::clamp(static_cast<int>(qos.durability().kind), 0, 3)),
      .deadline = PeriodFrom(qos.deadline().period),
      .liveliness = static_cast<Liveliness>(std::clamp(static_cast<int>(qos.liveliness().kind), 0, 2)),
      .lease = PeriodFrom(qos.liveliness().lease_duration)};
  return {.participant = ParticipantId(writer.guid().guidPrefix),
          .writes = true,
          .topic = writer.get_topic()->get_name(),
          .type = writer.get_topic()->get_type_name(),
          .qos = offered,
          .partitions = partitions};
}

}  // namespace thalweg::dds
