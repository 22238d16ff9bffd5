#pragma once

#include <set>
#include <string>
#include <vector>

namespace thalweg::dds {

/// An IPv4 address of this machine.
struct InterfaceAddress {
  std::string interface;  ///< "eth0"
  std::string address;    ///< "192.168.1.20"
  bool is_loopback = false;
  bool has_multicast = false;  ///< By the interface's flags.
};

/// The addresses of all interfaces that are up. Throws std::runtime_error if the system does not list them.
std::vector<InterfaceAddress> InterfaceAddresses();

/// Throws std::runtime_error with the addresses that exist unless this machine has the IPv4 address. Fast DDS
/// itself ignores an address that does not exist: nothing is sent, without a word.
void CheckInterfaceExists(const std::string& address);

/// Notices when this machine gets other addresses, e.g. in another wireless network.
class AddressWatch {
 public:
  explicit AddressWatch(const std::vector<InterfaceAddress>& now);

  /// What changed since the last call: "10.0.0.2 (eth0) gone, 10.0.0.7 (eth0) new"; empty if nothing did.
  std::string Changes(const std::vector<InterfaceAddress>& now);

 private:
  std::set<std::string> known_;  ///< "10.0.0.2 (eth0)"
};

}  // namespace thalweg::dds
