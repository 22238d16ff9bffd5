#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <string>

namespace thalweg::dds {

/// Names of the participants that were discovered, so that messages for people can name their senders.
///
/// Threading: any thread.
class Peers final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// The participant of an endpoint, e.g. "mapper" (192.168.1.5), or its prefix if it was not discovered.
  std::string Name(const eprosima::fastrtps::rtps::GUID_t& endpoint) const;

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;

 private:
  mutable std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GuidPrefix_t, std::string> names_;
};

}  // namespace thalweg::dds
