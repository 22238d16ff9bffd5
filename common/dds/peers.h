#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <string>

#include "common/dds/bus_graph.h"

namespace thalweg::dds {

/// The participants that were discovered, so that messages for people can name their senders; and, if asked
/// for, all their writers and readers.
///
/// Threading: any thread.
class Peers final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  explicit Peers(bool keeps_endpoints) : keeps_endpoints_(keeps_endpoints) {}

  /// The participant of an endpoint, e.g. "mapper" (192.168.1.5), or its prefix if it was not discovered.
  std::string Name(const eprosima::fastrtps::rtps::GUID_t& endpoint) const;

  /// All that is known of the others; without endpoints unless these are kept.
  BusGraph Graph() const;

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant*,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  using Guid = eprosima::fastrtps::rtps::GUID_t;
  using Prefix = eprosima::fastrtps::rtps::GuidPrefix_t;
  void Set(const Guid& guid, bool removed, Endpoint endpoint);

  bool keeps_endpoints_;
  mutable std::mutex mutex_;
  std::map<Prefix, Participant> participants_;
  std::map<Guid, Endpoint> endpoints_;
};

}  // namespace thalweg::dds
