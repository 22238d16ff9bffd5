#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <vector>

namespace thalweg::test {

/// Sends datagrams to all ports on which participants of a domain may listen [RTPS 2.3, section 9.6.1.1].
class DatagramSender {
 public:
  explicit DatagramSender(int domain)
      : first_port_(7400 + 250 * domain), socket_(socket(AF_INET, SOCK_DGRAM, 0)) {}
  ~DatagramSender() { close(socket_); }
  DatagramSender(const DatagramSender&) = delete;
  DatagramSender& operator=(const DatagramSender&) = delete;

  void Send(const std::vector<std::uint8_t>& bytes) const {
    for (int offset = 10; offset < 40; ++offset) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(static_cast<std::uint16_t>(first_port_ + offset));
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
  }

 private:
  int first_port_;
  int socket_;
};

}  // namespace thalweg::test
