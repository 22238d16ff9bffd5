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
std::string AddressText(const InterfaceAddress& entry) {
  return entry.address + " (" + entry.interface + ")";
}

std::set<InterfaceAddress> SetOf(const std::vector<InterfaceAddress>& addresses) {
  return {addresses.begin(), addresses.end()};
}

std::set<std::string> TextsOf(const std::vector<InterfaceAddress>& addresses) {
  std::set<std::string> texts;
  for (const InterfaceAddress& entry : addresses) texts.insert(AddressText(entry));
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
    constexpr unsigned kUsable = IFF_UP | IFF_RUNNING;
    const bool usable = (entry->ifa_flags & kUsable) == kUsable;
    if (!usable || entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, entry->ifa_addr, sizeof address);
    std::array<char, INET_ADDRSTRLEN> text{};
    inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    addresses.push_back({.interface = entry->ifa_name,
                         .address = text.data(),
                         .is_loopback = (entry->ifa_flags & IFF_LOOPBACK) != 0,
                         .has_multicast = (entry->ifa_flags & IFF_MULTICAST) != 0,
                         .index = if_nametoindex(entry->ifa_name)});
  }
  return addresses;
}

void CheckInterfaceExists(const std::string& address) {
  const std::vector<InterfaceAddress> addresses = InterfaceAddresses();
  if (std::ranges::count(addresses, address, &InterfaceAddress::address) > 0) return;
  const std::string existing = Joined(TextsOf(addresses));
  throw std::runtime_error(
      "network interface \"" + address +
      "\": this machine has no such address, or not while its interface has no carrier; it has " +
      (existing.empty() ? "none" : existing));
}

AddressWatch::AddressWatch(const std::vector<InterfaceAddress>& now)
    : now_(SetOf(now)),
      made_with_(now_),
      began_in_a_network_(!std::ranges::all_of(now_, &InterfaceAddress::is_loopback)) {}

std::string AddressWatch::Changes(const std::vector<InterfaceAddress>& now) {
  const std::set<InterfaceAddress> before = std::exchange(now_, SetOf(now));
  std::vector<std::string> changes;
  for (const InterfaceAddress& address : before) {
    if (!now_.contains(address)) changes.push_back(AddressText(address) + " gone");
  }
  for (const InterfaceAddress& address : now_) {
    if (!before.contains(address)) changes.push_back(AddressText(address) + " new");
  }
  return Joined(changes);
}

bool AddressWatch::has_unknown() const {
  return !std::ranges::includes(made_with_, now_);
}

}  // namespace thalweg::dds
