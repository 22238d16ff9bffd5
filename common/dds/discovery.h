#pragma once

#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <string>
#include <vector>

#include "common/dds/bus.h"
#include "common/dds/server_farewells.h"

namespace thalweg::dds {

/// The participants of one machine that BusOptions::peers can reach: the first so many that started there.
/// Whoever comes later reaches the others, and is known from then on.
inline constexpr std::uint32_t kParticipantsPerPeer = 16;

/// The hosts in a list like "10.0.0.2,base.local". Throws std::runtime_error if one of them is empty or holds
/// white space.
std::vector<std::string> PeersIn(const std::string& list);

/// A discovery server, the one of `fast-discovery-server -i ID`.
struct NamedServer {
  int id = 0;
  std::string host_and_port;
};

/// The servers in a list like "10.0.0.1:11811;10.0.0.2:11811", with ids from 0 in their order; an empty entry
/// skips an id [as ROS_DISCOVERY_SERVER does]. Clients of several find each other through any of them.
/// Throws std::runtime_error if there is none.
std::vector<NamedServer> ServersIn(const std::string& list);

/// The prefixes of their GUIDs; none if the list is empty. Throws as ServersIn does.
std::vector<ServerFarewells::GuidPrefix> PrefixesOfServers(const std::string& list);

/// Sets how a participant finds others: by multicast; in addition at the addresses of options.peers and on
/// this machine, where peers are named; or through options.discovery_server alone.
/// Throws std::runtime_error naming what is malformed or unknown, or that a server and keys exclude each
/// other: with DDS Security a server's prefix depends on its certificate, and Fast DDS 2.9.1 does not let
/// the endpoints of its clients' liveliness be protected.
void SetDiscovery(const BusOptions& options, bool secured,
                  eprosima::fastdds::dds::WireProtocolConfigQos& protocol);

}  // namespace thalweg::dds
