#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/dds/server_farewells.h"

namespace thalweg::dds {

/// Datagrams that a guarded transport refused, collected for the participant's health.
///
/// Threading: any thread.
class RefusedDatagrams {
 public:
  struct Entry {
    std::string reason;  ///< What was wrong, and the address of the sender.
    std::uint64_t count = 0;
  };

  void Add(std::string_view reason, const std::string& sender);
  /// The refusals since the last call, of at most 16 kinds; others are counted with the last of them.
  std::vector<Entry> Take();

 private:
  std::mutex mutex_;
  std::vector<Entry> entries_;
};

/// What a participant and its guarded transport share.
///
/// Threading: any thread.
struct Guard {
  RefusedDatagrams refused;
  /// [bytes] Greatest sizes of the topics that the participant reads; discovery needs less than the least.
  std::atomic<std::uint32_t> largest_sample = 1U << 20;
  /// Held while a participant with keys is handed an announcement or a part of a handshake: Fast DDS 2.9.1
  /// loses messages of handshakes that several threads process at the same time.
  std::mutex introductions;
};

/// A UDP transport that hands only well-formed RTPS messages (rtps_message.h) to Fast DDS: if `local_only`,
/// only those that this machine sent; if `secured`, only those that are encrypted; nothing of a discovery
/// server of `servers` behind its farewell.
struct GuardedTransportDescriptor : public eprosima::fastdds::rtps::ChainingTransportDescriptor {
  GuardedTransportDescriptor(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> udp,
                             std::uint32_t largest_sent, bool only_this_machine, bool with_keys,
                             std::vector<ServerFarewells::GuidPrefix> its_servers,
                             std::shared_ptr<Guard> its_guard)
      : ChainingTransportDescriptor(std::move(udp)),
        local_only(only_this_machine),
        secured(with_keys),
        servers(std::move(its_servers)),
        guard(std::move(its_guard)) {
    maxMessageSize = largest_sent;
  }
  std::uint32_t max_message_size() const override { return maxMessageSize; }
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  bool local_only;
  bool secured;
  std::vector<ServerFarewells::GuidPrefix> servers;
  std::shared_ptr<Guard> guard;
};

}  // namespace thalweg::dds
