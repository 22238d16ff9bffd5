#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "common/dds/bus_graph.h"

namespace thalweg::dds {

/// What was discovered of other participants: their names, so that messages for people can name senders, how
/// their writers deliver, and, if asked for, all their writers and readers.
///
/// Threading: any thread.
class Peers final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  explicit Peers(bool keeps_endpoints) : keeps_endpoints_(keeps_endpoints) {}

  /// The participant of an endpoint, e.g. "mapper" (192.168.1.5), or its prefix if it was not discovered.
  std::string Name(const eprosima::fastrtps::rtps::GUID_t& endpoint) const;
  /// Whether the participant of an endpoint exists and has this name.
  bool IsNamed(const eprosima::fastrtps::rtps::GUID_t& endpoint, const std::string& name) const;
  /// Whether a writer exists and offers reliable delivery.
  bool IsReliable(const eprosima::fastrtps::rtps::GUID_t& writer) const;

  /// What each known reader of a writer's topic requests that the writer does not offer.
  /// @param writer  A writer of this participant.
  std::vector<Mismatch> MismatchesOf(const Endpoint& writer) const;

  /// All that is known of the others; without endpoints unless these are kept.
  BusGraph Graph() const;

  /// Forgets all, since the participant that learned of them has ended.
  void Forget();

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant*,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  using Guid = eprosima::fastrtps::rtps::GUID_t;
  using Prefix = eprosima::fastrtps::rtps::GuidPrefix_t;
  void NoteReliability(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& info);
  void NoteDemands(const eprosima::fastrtps::rtps::ReaderDiscoveryInfo& info);
  void Set(const Guid& guid, bool removed, Endpoint endpoint);

  bool keeps_endpoints_;
  mutable std::mutex mutex_;
  std::map<Prefix, Participant> participants_;
  std::map<Guid, Endpoint> endpoints_;
  std::set<Guid> reliable_writers_;
  std::map<Guid, Endpoint> demanding_readers_;  ///< Those that request more than ROS 2's do by default.
};

/// A writer as discovery would describe it.
Endpoint EndpointOf(const eprosima::fastdds::dds::DataWriter& writer,
                    const std::vector<std::string>& partitions);

}  // namespace thalweg::dds
