#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

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

/// A UDP transport that hands only well-formed RTPS messages (rtps_message.h) to Fast DDS and, if
/// `local_only`, only those that this machine sent.
struct GuardedTransportDescriptor : public eprosima::fastdds::rtps::ChainingTransportDescriptor {
  GuardedTransportDescriptor(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> udp,
                             std::uint32_t largest_sent, bool only_this_machine,
                             std::shared_ptr<RefusedDatagrams> refused_datagrams)
      : ChainingTransportDescriptor(std::move(udp)),
        local_only(only_this_machine),
        refused(std::move(refused_datagrams)) {
    maxMessageSize = largest_sent;
  }
  std::uint32_t max_message_size() const override { return maxMessageSize; }
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  bool local_only;
  std::shared_ptr<RefusedDatagrams> refused;
};

}  // namespace thalweg::dds
