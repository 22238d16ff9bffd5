#include "common/dds/network_interfaces.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

#include "common/base/text.h"

namespace thalweg::dds {
namespace {

/// "192.168.1.20 (eth0)"
std::string TextOf(const InterfaceAddress& entry) {
  return entry.address + " (" + entry.interface + ")";
}

std::set<std::string> TextsOf(const std::vector<InterfaceAddress>& addresses) {
  std::set<std::string> texts;
  for (const InterfaceAddress& entry : addresses) texts.insert(TextOf(entry));
  return texts;
}

}  // namespace

std::vector<InterfaceAddress> InterfaceAddresses() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    throw std::runtime_error(std::string("cannot list the network interfaces: ") + std::strerror(errno));
  }
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  std::vector<InterfaceAddress> addresses;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    const bool up = (entry->ifa_flags & IFF_UP) != 0;
    if (!up || entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, entry->ifa_addr, sizeof address);
    std::array<char, INET_ADDRSTRLEN> text{};
    inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    addresses.push_back({.interface = entry->ifa_name,
                         .address = text.data(),
                         .is_loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0,
                         .has_multicast = (entry->ifa_flags & IFF_MULTICAST) != 0});
  }
  return addresses;
}

void CheckInterfaceExists(const std::string& address) {
  const std::vector<InterfaceAddress> addresses = InterfaceAddresses();
  if (std::ranges::count(addresses, address, &InterfaceAddress::address) > 0) return;
  const std::string existing = Joined(TextsOf(addresses));
  throw std::runtime_error("network interface \"" + address +
                           "\": this machine has no such address; it has " +
                           (existing.empty() ? "none" : existing));
}

AddressWatch::AddressWatch(const std::vector<InterfaceAddress>& now) : known_(TextsOf(now)) {}

std::string AddressWatch::Changes(const std::vector<InterfaceAddress>& now) {
  const std::set<std::string> before = std::exchange(known_, TextsOf(now));
  std::vector<std::string> changes;
  for (const std::string& address : before) {
    if (!known_.contains(address)) changes.push_back(address + " gone");
  }
  for (const std::string& address : known_) {
    if (!before.contains(address)) changes.push_back(address + " new");
  }
  return Joined(changes);
}

}  // namespace thalweg::dds
