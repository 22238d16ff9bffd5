// Sends mutated RTPS messages to the participants of a domain on this machine.
//
// Captures what they send over the loopback interface and returns it, changed: bits flipped, bytes and
// lengths replaced, cut, extended, submessages exchanged between messages; some unchanged, as replays. Prints
// how many datagrams it sent. Needs the capability to capture (root).
//
// usage: packet_storm DOMAIN COUNT [SEED]

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kHeaderBytes = 20;  // of an RTPS message

struct Datagram {
  std::uint16_t from_port;
  std::uint16_t to_port;
  Bytes payload;
};

/// The IPv4 UDP datagrams that pass the loopback interface to ports of a domain.
class Capture {
 public:
  explicit Capture(int domain)
      : first_port_(7400 + 250 * domain), socket_(socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP))) {
    if (socket_ < 0) throw std::runtime_error(std::string("cannot capture: ") + std::strerror(errno));
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(ETH_P_IP);
    address.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error(std::string("cannot capture on lo: ") + std::strerror(errno));
    }
  }
  ~Capture() { close(socket_); }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  /// Takes what arrived, waiting for at most `milliseconds`; false if there was none that fits.
  bool Take(Datagram& datagram, int milliseconds) {
    pollfd readable{socket_, POLLIN, 0};
    if (poll(&readable, 1, milliseconds) <= 0) return false;
    const ssize_t size = recv(socket_, buffer_.data(), buffer_.size(), 0);
    if (size < 28) return false;
    const std::size_t ip_bytes = 4U * (buffer_[0] & 0x0fU);
    const bool is_fragment = (buffer_[6] & 0x3fU) != 0 || buffer_[7] != 0;
    const auto bytes = static_cast<std::size_t>(size);
    if (buffer_[9] != IPPROTO_UDP || is_fragment || bytes < ip_bytes + 8 + kHeaderBytes) return false;
    datagram.from_port = static_cast<std::uint16_t>(buffer_[ip_bytes] << 8U | buffer_[ip_bytes + 1]);
    datagram.to_port = static_cast<std::uint16_t>(buffer_[ip_bytes + 2] << 8U | buffer_[ip_bytes + 3]);
    if (datagram.to_port < first_port_ || datagram.to_port >= first_port_ + 250) return false;
    datagram.payload.assign(buffer_.begin() + static_cast<std::ptrdiff_t>(ip_bytes) + 8,
                            buffer_.begin() + size);
    return true;
  }

 private:
  int first_port_;
  int socket_;
  std::array<std::uint8_t, 1 << 16> buffer_{};
};

/// Where the submessages of a message begin; the end of the message is the last.
std::vector<std::size_t> SubmessagesOf(const Bytes& message) {
  std::vector<std::size_t> starts;
  std::size_t at = kHeaderBytes;
  while (at + 4 <= message.size()) {
    starts.push_back(at);
    const bool little = (message[at + 1] & 1U) != 0;
    const std::size_t length =
        little ? message[at + 2] | message[at + 3] << 8U : message[at + 2] << 8U | message[at + 3];
    if (length == 0) break;
    at += 4 + length;
  }
  starts.push_back(message.size());
  return starts;
}

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}
  std::size_t Below(std::size_t bound) { return random_() % bound; }

  Bytes Mutate(Bytes message, const Bytes& other) {
    for (std::size_t changes = Below(4); changes > 0 && message.size() > kHeaderBytes; --changes) {
      Change(message, other);
    }
    return message;
  }

 private:
  std::uint8_t Byte() {
    constexpr std::array<std::uint8_t, 6> kEdges = {0x00, 0x01, 0x7f, 0x80, 0xfe, 0xff};
    return Below(2) == 0 ? kEdges[Below(kEdges.size())] : static_cast<std::uint8_t>(random_());
  }

  void Change(Bytes& message, const Bytes& other) {
    const std::size_t at = kHeaderBytes + Below(message.size() - kHeaderBytes);
    switch (Below(7)) {
      case 0:
        message[at] = static_cast<std::uint8_t>(message[at] ^ 1U << Below(8));
        break;
      case 1:
        message[at] = Byte();
        break;
      case 2:  // a number of 4 bytes
        for (std::size_t k = at; k < std::min(at + 4, message.size()); ++k) message[k] = Byte();
        break;
      case 3:
        message.resize(at);
        break;
      case 4:
        for (std::size_t more = Below(100); more > 0; --more) message.push_back(Byte());
        break;
      case 5: {  // the kind or the length of a submessage
        const std::vector<std::size_t> starts = SubmessagesOf(message);
        const std::size_t start = starts[Below(starts.size())];
        if (start + 4 <= message.size()) message[start + (Below(2) == 0 ? 0 : 2 + Below(2))] = Byte();
        break;
      }
      default: {  // a submessage of another message
        const std::vector<std::size_t> starts = SubmessagesOf(other);
        if (starts.size() < 2) break;
        const std::size_t k = Below(starts.size() - 1);
        const std::span<const std::uint8_t> piece(other.data() + starts[k],
                                                  starts[k + 1] - std::min(starts[k], starts[k + 1]));
        if (message.size() + piece.size() < 65'000) message.insert(message.end(), piece.begin(), piece.end());
        break;
      }
    }
  }

  std::mt19937 random_;
};

unsigned long NumberFrom(std::string_view text, const std::string& name) {
  unsigned long number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || rest != text.data() + text.size())
    throw std::runtime_error(name + " must be a number");
  return number;
}

int Run(std::span<char*> arguments) {
  if (arguments.size() < 3) throw std::runtime_error("usage: packet_storm DOMAIN COUNT [SEED]");
  const auto domain = static_cast<int>(NumberFrom(arguments[1], "DOMAIN"));
  const unsigned long count = NumberFrom(arguments[2], "COUNT");
  Mutator mutator(arguments.size() > 3 ? static_cast<unsigned>(NumberFrom(arguments[3], "SEED")) : 1U);
  Capture capture(domain);
  const int out = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in own{};  // binding to port 0 assigns one, by which its own datagrams are recognized
  own.sin_family = AF_INET;
  socklen_t own_size = sizeof own;
  bind(out, reinterpret_cast<const sockaddr*>(&own), sizeof own);
  getsockname(out, reinterpret_cast<sockaddr*>(&own), &own_size);

  constexpr std::size_t kKept = 2000;
  constexpr int kPatienceMs = 30'000;
  std::vector<Datagram> kept;
  Datagram arrived;
  for (int waited = 0; waited < kPatienceMs && kept.size() < 100; waited += 10) {
    if (capture.Take(arrived, 10)) kept.push_back(arrived);
  }
  if (kept.empty()) throw std::runtime_error("nothing is sent in domain " + std::to_string(domain));
  for (unsigned long sent = 0; sent < count;) {
    while (capture.Take(arrived, 0)) {
      if (arrived.from_port == ntohs(own.sin_port)) continue;
      if (kept.size() < kKept) {
        kept.push_back(arrived);
      } else {
        kept[mutator.Below(kKept)] = arrived;
      }
      if (mutator.Below(20) == 0) break;
    }
    for (int burst = 0; burst < 20 && sent < count; ++burst, ++sent) {
      const Datagram& base = kept[mutator.Below(kept.size())];
      const Bytes message = mutator.Mutate(base.payload, kept[mutator.Below(kept.size())].payload);
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(kept[mutator.Below(kept.size())].to_port);
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      sendto(out, message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
  }
  close(out);
  std::cout << "sent " << count << " datagrams, from " << kept.size() << " captured\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  return Run({argv, static_cast<std::size_t>(argc)});
} catch (const std::exception& error) {
  std::cerr << "packet_storm: " << error.what() << '\n';
  return 1;
}
