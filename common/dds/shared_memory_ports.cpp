#include "common/dds/shared_memory_ports.h"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/TransportInterface.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

namespace thalweg::dds {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using SteadyClock = std::chrono::steady_clock;

// A listener waits a third of a second for a message, then a second for the mutex.
constexpr auto kLongestReplacement = 3s;
// A header alone, of a sender that nobody knows [RTPS 2.3, section 8.3.3.1].
constexpr std::array<rtps::octet, 20> kEmptyMessage = {'R', 'T', 'P', 'S', 2, 3};

/// Writes into the port as a peer does; if it is locked, that is where Fast DDS replaces it.
void SendThrough(eprosima::fastdds::rtps::TransportInterface& transport, std::uint32_t port) {
  rtps::LocatorList_t list;
  rtps::Locator_t locator(LOCATOR_KIND_SHM, port);
  locator.address[0] = 'U';  // unicast
  list.push_back(locator);
  eprosima::fastdds::rtps::SendResourceList senders;
  if (!transport.OpenOutputChannel(senders, locator) || senders.empty()) return;
  eprosima::fastdds::rtps::Locators begin(list.begin());
  eprosima::fastdds::rtps::Locators end(list.end());
  senders.front()->send(kEmptyMessage.data(), kEmptyMessage.size(), &begin, &end, SteadyClock::now() + 100ms);
}

/// Whether this process still has a port in memory whose file was removed.
bool MapsReplaced(const std::array<std::uint32_t, 2>& ports) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const auto is_replaced = [&](std::uint32_t port) {
      return line.find("/fastrtps_port" + std::to_string(port) + " (deleted)") != std::string::npos;
    };
    if (std::any_of(ports.begin(), ports.end(), is_replaced)) return true;
  }
  return false;
}

}  // namespace

void ReplaceLockedPorts(std::uint32_t first) {
  const std::array<std::uint32_t, 2> ports = {first, first + 1};
  eprosima::fastdds::rtps::SharedMemTransportDescriptor descriptor;
  const std::unique_ptr<eprosima::fastdds::rtps::TransportInterface> transport(descriptor.create_transport());
  if (!transport->init()) return;
  for (const std::uint32_t port : ports) SendThrough(*transport, port);
  const auto latest = SteadyClock::now() + kLongestReplacement;
  while (MapsReplaced(ports) && SteadyClock::now() < latest) std::this_thread::sleep_for(5ms);
}

}  // namespace thalweg::dds
