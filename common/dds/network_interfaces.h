#pragma once

#include <compare>
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
  unsigned index = 0;  ///< The system's number of the interface: another one if it is plugged in again.

  auto operator<=>(const InterfaceAddress&) const = default;
};

/// The addresses of all interfaces that are up and have a carrier: Fast DDS uses no others. Throws
/// std::runtime_error if the system does not list them.
std::vector<InterfaceAddress> InterfaceAddresses();

/// Throws std::runtime_error with the addresses that exist unless this machine has the IPv4 address. Fast DDS
/// itself ignores an address that does not exist: nothing is sent, without a word.
void CheckInterfaceExists(const std::string& address);

/// Notices when this machine gets other addresses, e.g. in another wireless network, and whether a
/// participant has to be made again: Fast DDS 2.9 announces and uses those that there were when it was made.
/// One that is gone for a while needs nothing, since sockets outlive it.
class AddressWatch {
 public:
  /// @param now  The addresses when a participant is made.
  explicit AddressWatch(const std::vector<InterfaceAddress>& now);

  /// What changed since the last call: "10.0.0.2 (eth0) gone, 10.0.0.7 (eth0) new"; empty if nothing did.
  std::string Changes(const std::vector<InterfaceAddress>& now);
  /// Whether there were addresses, at the last call, that the participant does not know.
  bool has_unknown() const;
  /// A participant is made again, with the addresses of the last call.
  void Renew() { made_with_ = now_; }
  /// Whether other machines could be reached when the first participant was made.
  bool began_in_a_network() const { return began_in_a_network_; }

 private:
  std::set<InterfaceAddress> now_;
  std::set<InterfaceAddress> made_with_;
  bool began_in_a_network_;
};

}  // namespace thalweg::dds
