#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <linux/if_ether.h>
#include <net/if.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <netpacket/packet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/qos.h"
#include "common/dds/security.h"
#include "tests/common/dds/security_fixture.h"

namespace thalweg::dds {
namespace {

using test::AwaitMatch;
using test::BusOptionsForTest;
using test::KeyFolder;
using test::kPatience;
using Bytes = std::vector<std::uint8_t>;

/// Records the RTPS datagrams of a domain that cross this machine's loopback interface. Needs CAP_NET_RAW.
class Eavesdropper {
 public:
  struct Datagram {
    sockaddr_in to;
    Bytes bytes;
  };

  explicit Eavesdropper(int domain)
      : first_port_(7400 + 250 * domain), socket_(socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP))) {
    if (socket_ < 0) return;
    sockaddr_ll interface {};
    interface.sll_family = AF_PACKET;
    interface.sll_protocol = htons(ETH_P_IP);
    interface.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    bind(socket_, reinterpret_cast<const sockaddr*>(&interface), sizeof interface);
    const timeval patience{.tv_sec = 0, .tv_usec = 50'000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    recording_ = std::thread([this] { Record(); });
  }
  ~Eavesdropper() {
    stopped_ = true;
    if (recording_.joinable()) recording_.join();
    if (socket_ >= 0) close(socket_);
  }
  Eavesdropper(const Eavesdropper&) = delete;
  Eavesdropper& operator=(const Eavesdropper&) = delete;

  bool hears() const { return socket_ >= 0; }
  std::vector<Datagram> Recorded() const {
    const std::lock_guard lock(mutex_);
    return recorded_;
  }

 private:
  void Record() {
    Bytes packet(1 << 16);
    while (!stopped_) {
      const ssize_t size = recv(socket_, packet.data(), packet.size(), 0);
      if (size < 0) continue;
      const std::size_t ip_bytes = std::size_t{4} * (packet[0] & 0x0fU);
      const std::size_t header = ip_bytes + sizeof(udphdr);
      if (packet[9] != IPPROTO_UDP || static_cast<std::size_t>(size) < header + 4) continue;
      const int port = packet[ip_bytes + 2] << 8 | packet[ip_bytes + 3];
      if (port < first_port_ || port >= first_port_ + 250) continue;
      if (std::memcmp(&packet[header], "RTPS", 4) != 0) continue;
      Datagram datagram{};
      datagram.to.sin_family = AF_INET;
      datagram.to.sin_port = htons(static_cast<std::uint16_t>(port));
      std::memcpy(&datagram.to.sin_addr, &packet[16], 4);
      datagram.bytes.assign(packet.begin() + static_cast<std::ptrdiff_t>(header), packet.begin() + size);
      const std::lock_guard lock(mutex_);
      recorded_.push_back(std::move(datagram));
    }
  }

  int first_port_;
  int socket_;
  std::atomic<bool> stopped_ = false;
  mutable std::mutex mutex_;
  std::vector<Datagram> recorded_;
  std::thread recording_;
};

/// Where the submessage of this kind begins; 0 if there is none.
std::size_t FindSubmessage(const Bytes& datagram, std::uint8_t kind) {
  std::size_t at = 20;
  while (at + 4 <= datagram.size()) {
    if (datagram[at] == kind) return at;
    const std::size_t length = datagram[at + 2] | std::size_t{datagram[at + 3]} << 8;  // little-endian
    if (length == 0) return 0;
    at += 4 + length;
  }
  return 0;
}

bool IsEncrypted(const Bytes& datagram) {
  constexpr std::uint8_t kSecurePrefix = 0x31;  // DDS-SECURITY 1.1, section 7.3.6.2
  return FindSubmessage(datagram, kSecurePrefix) > 0;
}

void Send(const Eavesdropper::Datagram& datagram) {
  static const int sender = socket(AF_INET, SOCK_DGRAM, 0);
  sendto(sender, datagram.bytes.data(), datagram.bytes.size(), 0,
         reinterpret_cast<const sockaddr*>(&datagram.to), sizeof datagram.to);
}

TEST_F(Security, WithoutItAnEavesdropperRepeatsAPathAsANewOne) {
  Controller controller(WithoutKeys("controller"));
  Bus explorer(WithoutKeys("explorer"));
  const auto path_out = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, path_out, controller.bus);
  const Eavesdropper attacker(BusOptionsForTest("").domain);
  if (!attacker.hears()) GTEST_SKIP() << "needs the capability to read raw packets";
  path_out.Write(PathNamed("overheard"));
  ASSERT_TRUE(controller.Hears("overheard"));

  const auto repeat = [&] {
    for (Eavesdropper::Datagram datagram : attacker.Recorded()) {
      const std::string text(datagram.bytes.begin(), datagram.bytes.end());
      constexpr std::uint8_t kData = 0x15;
      const std::size_t data = FindSubmessage(datagram.bytes, kData);
      if (data == 0 || text.find("overheard") == std::string::npos) continue;
      ++datagram.bytes[data + 20];  // the low byte of its sequence number
      Send(datagram);
    }
  };
  controller.bus.EveryWall(std::chrono::milliseconds(20), repeat);
  EXPECT_TRUE(controller.bus.SpinUntil([&] { return controller.heard.size() >= 2; }, kPatience));
}

Bytes Joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    for (const std::uint8_t byte : part) all.push_back(byte);
  }
  return all;
}

/// A submessage in little-endian order.
Bytes PlainSubmessage(std::uint8_t kind, std::uint8_t flags, const std::vector<Bytes>& parts) {
  const Bytes body = Joined(parts);
  const auto low = static_cast<std::uint8_t>(body.size());
  const auto high = static_cast<std::uint8_t>(body.size() >> 8U);
  return Joined({{kind, flags, low, high}, body});
}

/// A path in plain text with the sender's prefix of another, as the 5000th sample of a writer.
Bytes ForgedPath(const Bytes& prefix, std::uint8_t writer_number, std::uint8_t writer_kind) {
  const Bytes entities = {0, 0, 0, 0, 0, 0, writer_number, writer_kind};  // to any reader
  const Bytes number = {0, 0, 0, 0, 0x88, 0x13, 0, 0};
  const Bytes before = {0, 0, 0, 0, 0x88, 0x0f, 0, 0};  // by 1024
  return Joined({{'R', 'T', 'P', 'S', 2, 3, 1, 15},
                 prefix,
                 // A heartbeat as well: the reader then waits for nothing before that sample.
                 PlainSubmessage(0x07, 1, {entities, number, number, {0xff, 0xff, 0, 0}}),
                 PlainSubmessage(0x08, 1, {entities, before, number, Bytes(4)}),
                 PlainSubmessage(
                     0x15, 5, {{0, 0, 16, 0}, entities, number, Encode<topics::Path>(PathNamed("forged"))})});
}

TEST_F(Security, PlainTextUnderTheNameOfAPeerIsRefused) {
  const KeyFolder keys("keys", "--role explorer --role controller");
  const Eavesdropper attacker(BusOptionsForTest("").domain);
  if (!attacker.hears()) GTEST_SKIP() << "needs the capability to read raw packets";
  BusOptions options = Secure("controller", keys);
  options.publish_health = true;  // and count what is refused
  Controller controller(options);
  Bus explorer(Secure("explorer", keys));
  const auto path_out = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, path_out, controller.bus);

  Bytes prefix;  // of the explorer, from its announcement, which is in clear text
  std::set<std::uint16_t> ports;
  for (const auto& datagram : attacker.Recorded()) {
    ports.insert(datagram.to.sin_port);
    const std::string text(datagram.bytes.begin(), datagram.bytes.end());
    if (text.find(std::string("explorer") + '\0') == std::string::npos) continue;
    prefix.assign(datagram.bytes.begin() + 8, datagram.bytes.begin() + 20);
  }
  ASSERT_EQ(prefix.size(), 12U);
  for (std::uint8_t number = 1; number < 20; ++number) {
    for (const std::uint8_t kind : {0x02, 0x03}) {  // with a key and without
      Eavesdropper::Datagram forged{.to = {}, .bytes = ForgedPath(prefix, number, kind)};
      forged.to.sin_family = AF_INET;
      forged.to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      for (const std::uint16_t port : ports) {
        forged.to.sin_port = port;
        Send(forged);
      }
    }
  }
  const auto refused = [&] {
    const thalweg_msgs::msg::ServiceHealth health = controller.bus.health().ToMessage(Time{});
    for (const auto& counter : health.rejected()) {
      if (counter.last().find("not encrypted") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(controller.bus.SpinUntil([&] { return refused() || !controller.heard.empty(); }, kPatience));
  path_out.Write(PathNamed("genuine"));
  EXPECT_TRUE(controller.Hears("genuine"));
  EXPECT_EQ(controller.heard, std::vector<std::string>{"genuine"});
}

TEST_F(Security, WithKeysNothingArrivesPastTheGuard) {
  const KeyFolder keys("keys", "--role mapper");
  const auto now = std::chrono::system_clock::now();
  const auto transports = [&](const std::optional<SecurityKeys>& its) {
    const BusOptions options = BusOptionsForTest("mapper");
    return ParticipantQosFrom(options, std::make_shared<Guard>(), its).transport().user_transports.size();
  };
  EXPECT_EQ(transports(std::nullopt), 2U) << "shared memory and UDP";
  EXPECT_EQ(transports(CheckKeys(keys.path(), "mapper", now)), 1U);
}

TEST_F(Security, ReplayedAndChangedDatagramsDoNothing) {
  const KeyFolder keys("keys", "--role explorer --role controller");
  const Eavesdropper attacker(BusOptionsForTest("").domain);
  if (!attacker.hears()) GTEST_SKIP() << "needs the capability to read raw packets";
  Controller controller(Secure("controller", keys));
  Bus explorer(Secure("explorer", keys));
  const auto path_out = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, path_out, controller.bus);
  for (const std::string name : {"first", "second", "third"}) {
    path_out.Write(PathNamed(name));
    ASSERT_TRUE(controller.Hears(name));
  }
  const auto overheard = attacker.Recorded();
  const auto encrypted = [](const auto& datagram) { return IsEncrypted(datagram.bytes); };
  ASSERT_GT(std::ranges::count_if(overheard, encrypted), 3);
  for (const auto& datagram : overheard) {
    const std::string text(datagram.bytes.begin(), datagram.bytes.end());
    EXPECT_EQ(text.find("second"), std::string::npos);
  }

  // All of it again, the handshake as well, and then with errors in what is encrypted.
  for (const auto& datagram : overheard) Send(datagram);
  std::mt19937 random(1);
  for (int round = 0; round < 5; ++round) {
    for (Eavesdropper::Datagram datagram : overheard) {
      if (!encrypted(datagram)) continue;
      const std::size_t at = 20 + random() % (datagram.bytes.size() - 20);
      datagram.bytes[at] = static_cast<std::uint8_t>(random());
      Send(datagram);
    }
  }
  path_out.Write(PathNamed("last"));
  EXPECT_TRUE(controller.Hears("last"));
  EXPECT_EQ(controller.heard, (std::vector<std::string>{"first", "second", "third", "last"}));
}

}  // namespace
}  // namespace thalweg::dds
