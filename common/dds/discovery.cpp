#include "common/dds/discovery.h"

#include <arpa/inet.h>
#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace thalweg::dds {
namespace {

namespace fastrtps = eprosima::fastrtps;
namespace rtps = eprosima::fastrtps::rtps;
namespace transport = eprosima::fastdds::rtps;

constexpr std::uint16_t kUnknownPort = 0;  // the transport replaces it by the ports of the domain

std::runtime_error BadOption(const std::string& what, const std::string& name, const std::string& problem) {
  return std::runtime_error(what + " \"" + name + "\": " + problem);
}

/// @param what  What it is the host of, for errors.
rtps::Locator_t LocatorOf(const std::string& what, const std::string& host, std::uint16_t port) {
  in_addr parsed{};
  std::string address = host;
  if (inet_pton(AF_INET, host.c_str(), &parsed) != 1) {
    const auto addresses = rtps::IPLocator::resolveNameDNS(host).first;
    if (addresses.empty()) throw BadOption(what, host, "no such host");
    address = *addresses.begin();
  }
  rtps::Locator_t locator;
  rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, address, port, locator);
  return locator;
}

rtps::Locator_t ServerLocator(const std::string& host_and_port) {
  constexpr auto kWhat = "discovery server";
  const std::size_t colon = host_and_port.rfind(':');
  if (colon == std::string::npos) throw BadOption(kWhat, host_and_port, "must be HOST:PORT");
  const char* const end = host_and_port.data() + host_and_port.size();
  std::uint16_t port = 0;
  const auto [rest, error] = std::from_chars(host_and_port.data() + colon + 1, end, port);
  if (error != std::errc() || rest != end || port == 0) {
    throw BadOption(kWhat, host_and_port, "port must be 1 to 65535");
  }
  return LocatorOf(kWhat, host_and_port.substr(0, colon), port);
}

/// That of `fast-discovery-server -i ID`.
rtps::GuidPrefix_t PrefixOf(const NamedServer& server) {
  rtps::GuidPrefix_t prefix;
  transport::get_server_client_default_guidPrefix(server.id, prefix);
  return prefix;
}

void UseServers(const std::string& list, bool surveys, rtps::DiscoverySettings& discovery) {
  // A server announces to a client only the endpoints that it matches.
  discovery.discoveryProtocol =
      surveys ? rtps::DiscoveryProtocol_t::SUPER_CLIENT : rtps::DiscoveryProtocol_t::CLIENT;
  for (const NamedServer& named : ServersIn(list)) {
    rtps::RemoteServerAttributes server;
    server.guidPrefix = PrefixOf(named);
    server.metatrafficUnicastLocatorList.push_back(ServerLocator(named.host_and_port));
    discovery.m_DiscoveryServers.push_back(server);
  }
}

void AnnounceTo(const std::vector<std::string>& peers, rtps::BuiltinAttributes& builtin) {
  // A list of peers replaces the group that participants are announced to.
  builtin.initialPeersList.push_back(LocatorOf("multicast group", "239.255.0.1", kUnknownPort));
  builtin.initialPeersList.push_back(LocatorOf("peer", "127.0.0.1", kUnknownPort));
  for (const std::string& host : peers) {
    builtin.initialPeersList.push_back(LocatorOf("peer", host, kUnknownPort));
  }
}

}  // namespace

std::vector<std::string> PeersIn(const std::string& list) {
  std::vector<std::string> peers;
  for (std::size_t begin = 0; begin <= list.size() && !list.empty();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string host = list.substr(begin, end - begin);
    if (host.empty() || host.find_first_of(" \t:") != std::string::npos) {
      throw BadOption("peers", list, "must be HOST,HOST,...");
    }
    peers.push_back(host);
    begin = end + 1;
  }
  return peers;
}

std::vector<NamedServer> ServersIn(const std::string& list) {
  constexpr std::size_t kMostServers = 256;  // ids that have a prefix
  std::vector<NamedServer> servers;
  std::size_t id = 0;
  for (std::size_t begin = 0; begin <= list.size(); ++id) {
    const std::size_t end = std::min(list.find(';', begin), list.size());
    if (end > begin) servers.push_back({static_cast<int>(id), list.substr(begin, end - begin)});
    begin = end + 1;
  }
  if (servers.empty() || id > kMostServers) {
    throw BadOption("discovery server", list, "must be HOST:PORT, or up to 256 of them with ; between");
  }
  return servers;
}

std::vector<ServerFarewells::GuidPrefix> PrefixesOfServers(const std::string& list) {
  std::vector<ServerFarewells::GuidPrefix> prefixes;
  if (list.empty()) return prefixes;
  for (const NamedServer& server : ServersIn(list)) {
    std::ranges::copy(PrefixOf(server).value, prefixes.emplace_back().begin());
  }
  return prefixes;
}

void SetDiscovery(const BusOptions& options, bool secured,
                  eprosima::fastdds::dds::WireProtocolConfigQos& protocol) {
  auto& discovery = protocol.builtin.discovery_config;
  discovery.leaseDuration = fastrtps::Duration_t(10, 0);  // until a killed peer is considered gone
  discovery.leaseDuration_announcementperiod = fastrtps::Duration_t(2, 0);
  if (options.discovery_server.empty()) {
    if (!options.peers.empty()) AnnounceTo(PeersIn(options.peers), protocol.builtin);
    return;
  }
  if (!options.peers.empty()) {
    throw BadOption("discovery server", options.discovery_server, "not together with peers");
  }
  if (secured) {
    throw BadOption("discovery server", options.discovery_server,
                    "not together with keys; where there is no multicast, name the other machines "
                    "(network.peers, THALWEG_PEERS)");
  }
  UseServers(options.discovery_server, options.surveys, discovery);
}

}  // namespace thalweg::dds
