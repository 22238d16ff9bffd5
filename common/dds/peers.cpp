#include "common/dds/peers.h"

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastrtps/utils/IPLocator.h>
#include <spdlog/fmt/fmt.h>

#include <sstream>

namespace thalweg::dds {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

std::string AddressOf(const rtps::ParticipantProxyData& peer) {
  for (const rtps::Locator_t& locator : peer.default_locators.unicast) {
    if (locator.kind == LOCATOR_KIND_UDPv4) return rtps::IPLocator::ip_to_string(locator);
  }
  return "this machine";  // by shared memory alone
}

}  // namespace

std::string Peers::Name(const rtps::GUID_t& endpoint) const {
  const std::lock_guard lock(mutex_);
  if (const auto found = names_.find(endpoint.guidPrefix); found != names_.end()) return found->second;
  std::ostringstream prefix;
  prefix << "participant " << endpoint.guidPrefix;
  return prefix.str();
}

void Peers::on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                     rtps::ParticipantDiscoveryInfo&& info) {
  using Status = rtps::ParticipantDiscoveryInfo;
  constexpr std::size_t kMostPeers = 1000;  // what a stranger announces must not fill the memory
  const rtps::GuidPrefix_t prefix = info.info.m_guid.guidPrefix;
  const std::lock_guard lock(mutex_);
  if (info.status == Status::REMOVED_PARTICIPANT || info.status == Status::DROPPED_PARTICIPANT) {
    names_.erase(prefix);
  } else if (names_.size() < kMostPeers) {
    names_[prefix] =
        fmt::format("\"{}\" ({})", info.info.m_participantName.to_string(), AddressOf(info.info));
  }
}

}  // namespace thalweg::dds
