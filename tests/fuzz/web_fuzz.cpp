// libFuzzer target: whatever bytes reach the gateway's port, as HTTP or, after a client's upgrade, as frames
// of a WebSocket, the server closes the connection once the client has nothing more to say, and then serves
// the next.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "services/gateway/adapter/web_server.h"

namespace {

using namespace thalweg::gateway;

void Require(bool good) {
  if (!good) __builtin_trap();
}

class Connection {
 public:
  explicit Connection(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    Require(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    const timeval longest = {10, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
  }
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// The server may close the connection before all is sent.
  void Send(std::string_view bytes) { send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  void SayNoMore() { shutdown(socket_, SHUT_WR); }
  /// @return What came before the server closed the connection, at most the first 64 kB.
  std::string ReadToEnd() {
    std::string received;
    std::array<char, 4096> part;
    while (true) {
      const ssize_t count = recv(socket_, part.data(), part.size(), 0);
      Require(count >= 0 || errno != EAGAIN);  // the server keeps the connection open
      if (count <= 0) return received;
      if (received.size() < 65536) received.append(part.data(), static_cast<std::size_t>(count));
    }
  }

 private:
  int socket_;
};

WebServer& Server() {
  static WebServer server = [] {
    spdlog::set_level(spdlog::level::off);
    ListenOptions any_port;
    any_port.port = 0;
    Hub::Options content;
    content.name = "fuzz";
    content.session_id = "1";
    content.topics = {{"state", "a/msg/State", "int32 x", true}};
    return WebServer(
        any_port, content, {{"/", {"text/html", "<p>index"}}},
        {[](const Hub::WantedChanges&) {}, [](Hub::ClientId, const ClientInfo&, const ClientCommand&) {}});
  }();
  return server;
}

constexpr std::string_view kUpgrade =
    "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: "
    "websocket\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n";

}  // namespace

/// The first byte says whether the rest is sent as it is or after an upgrade.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  {
    Connection stranger(Server().port());
    if (data[0] % 4 != 0) stranger.Send(kUpgrade);
    stranger.Send(bytes);
    stranger.SayNoMore();
    stranger.ReadToEnd();
  }
  static int inputs = 0;
  if (++inputs % 64 != 0) return 0;
  Connection next(Server().port());
  next.Send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  next.SayNoMore();
  Require(next.ReadToEnd().ends_with("<p>index"));
  return 0;
}
