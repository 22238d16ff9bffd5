#include "common/dds/guarded_transport.h"

#include <arpa/inet.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastrtps/utils/IPFinder.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "common/dds/jump_budget.h"
#include "common/dds/rtps_message.h"

namespace thalweg::dds {
namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

/// The IPv4 addresses of this machine. The system does not deliver datagrams from outside that bear one of
/// them as their source [RFC 1812, section 5.3.8; Linux: accept_local = 0], so that they identify local
/// peers.
///
/// Threading: any thread.
class LocalAddresses {
 public:
  bool Holds(const rtps::Locator_t& sender) {
    if (rtps::IPLocator::isLocal(sender)) return true;
    const std::lock_guard lock(mutex_);
    if (Knows(sender)) return true;
    // The machine may have received an address in the meantime.
    const auto now = std::chrono::steady_clock::now();
    if (now - updated_ < std::chrono::seconds(1)) return false;
    updated_ = now;
    Update();
    return Knows(sender);
  }

 private:
  bool Knows(const rtps::Locator_t& sender) const {
    return std::ranges::any_of(addresses_, [&](const rtps::Locator_t& address) {
      return rtps::IPLocator::compareAddress(address, sender);
    });
  }
  void Update() {
    std::vector<rtps::IPFinder::info_IP> found;
    rtps::IPFinder::getIPs(&found, true);
    addresses_.clear();
    for (const auto& interface : found) {
      rtps::Locator_t& address = addresses_.emplace_back();
      rtps::IPLocator::setIPv4(address, interface.name);
    }
  }

  std::mutex mutex_;
  std::vector<rtps::Locator_t> addresses_;
  std::chrono::steady_clock::time_point updated_;
};

/// Copies a message with fragments to the beginning of a larger buffer. Of a sample's last fragments, Fast
/// DDS 2.9.1 reads as many bytes as they have by the size that the sample's first one gave, which need not be
/// the one that this message gives and that was checked. Here it reads zeros then.
///
/// @return The copy, valid until the thread's next call.
const rtps::octet* WithRoomBehind(const rtps::octet* bytes, std::uint32_t size) {
  constexpr std::size_t kLargestFragment = 1U << 16;
  constexpr std::size_t kLargestDatagram = 1U << 16;
  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };
  // By calloc, since the system then provides what is never touched only as an address.
  static thread_local const std::unique_ptr<rtps::octet, Free> buffer(static_cast<rtps::octet*>(
      std::calloc(kLargestDatagram + kMostFragments * kLargestFragment, sizeof(rtps::octet))));
  if (!buffer || size > kLargestDatagram) return nullptr;
  std::memcpy(buffer.get(), bytes, size);
  return buffer.get();
}

class GuardedTransport final : public transport::ChainingTransport {
 public:
  explicit GuardedTransport(const GuardedTransportDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor), farewells_(descriptor.servers) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* sender, const rtps::octet* bytes, std::uint32_t size,
            rtps::LocatorsIterator* first, rtps::LocatorsIterator* last,
            const std::chrono::steady_clock::time_point& deadline) override {
    return sender->send(bytes, size, first, last, deadline);
  }

  void receive(transport::TransportReceiverInterface* receiver, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    Guard& guard = *descriptor_.guard;
    const RtpsRules rules{.largest_sample = guard.largest_sample, .secured = descriptor_.secured};
    if (descriptor_.local_only && !own_addresses_.Holds(remote)) {
      return guard.refused.Add("from another machine, while the network is limited to this one",
                               Name(remote));
    }
    if (const auto problem = FindRtpsError({bytes, size}, rules)) {
      return guard.refused.Add(*problem, Name(remote));
    }
    const RtpsContents contents = ContentsOf({bytes, size});
    const auto now = std::chrono::steady_clock::now();
    for (const auto& [writer, first] : contents.heartbeats) {
      if (!jumps_.Allows(writer, first, now)) {
        return guard.refused.Add("a heartbeat with too large a jump of its sequence number", Name(remote));
      }
    }
    size = static_cast<std::uint32_t>(farewells_.Heard(contents.sender, size, contents.farewell, now));
    if (size == 0) return;
    if (contents.has_fragments) bytes = WithRoomBehind(bytes, size);
    if (bytes == nullptr) return;
    std::unique_lock one_at_a_time(guard.introductions, std::defer_lock);
    if (descriptor_.secured && contents.introduces) one_at_a_time.lock();
    receiver->OnDataReceived(bytes, size, local, remote);
  }

 private:
  static std::string Name(const rtps::Locator_t& locator) { return rtps::IPLocator::ip_to_string(locator); }

  GuardedTransportDescriptor descriptor_;
  LocalAddresses own_addresses_;
  JumpBudget jumps_;
  ServerFarewells farewells_;
};

}  // namespace

void RefusedDatagrams::Add(std::string_view reason, const std::string& sender) {
  constexpr std::size_t kMostEntries = 16;
  const std::string text = std::string(reason) + ", from " + sender;
  const std::lock_guard lock(mutex_);
  auto entry = std::ranges::find(entries_, text, &Entry::reason);
  if (entry == entries_.end()) {
    if (entries_.size() < kMostEntries) entries_.push_back({text, 0});
    entry = std::prev(entries_.end());
  }
  ++entry->count;
}

std::vector<RefusedDatagrams::Entry> RefusedDatagrams::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(entries_, {});
}

transport::TransportInterface* GuardedTransportDescriptor::create_transport() const {
  return new GuardedTransport(*this);
}

}  // namespace thalweg::dds
