#include "services/gateway/adapter/web_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <fstream>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/gateway/adapter/page_files.h"
#include "tests/support/sanitized.h"

namespace thalweg::gateway {
namespace {

/// A TCP connection to the server that sends and expects raw bytes.
class RawClient {
 public:
  explicit RawClient(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    timeval longest = {20, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof(longest));
  }
  ~RawClient() { close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void Send(const std::string& bytes) {
    EXPECT_EQ(send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  /// Returns whether all was taken before the server closed the connection.
  bool TrySend(const std::string& bytes) {
    return send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }
  /// Reads until the text has appeared, or the server closes the connection.
  std::string ReadUntil(const std::string& text) {
    std::string received;
    char byte = 0;
    while (received.find(text) == std::string::npos && recv(socket_, &byte, 1, 0) == 1) received += byte;
    return received;
  }
  /// Reads this many bytes.
  void Read(std::size_t count) {
    std::vector<char> bytes(count);
    EXPECT_EQ(recv(socket_, bytes.data(), count, MSG_WAITALL), static_cast<ssize_t>(count));
  }
  std::string ReadToEnd() { return ReadUntil(std::string(1, '\0') + "never sent"); }

 private:
  int socket_;
};

/// A text frame of a client [RFC 6455, Sec. 5.2], masked with zeros.
std::string TextFrame(const std::string& text) {
  std::string frame = {'\x81', static_cast<char>(0x80 | text.size())};
  return frame + std::string(4, '\0') + text;
}

std::string BinaryFrame(const std::string& bytes) {
  std::string frame = TextFrame(bytes);
  frame[0] = '\x82';
  return frame;
}

class WebServerTest : public testing::Test {
 protected:
  static Hub::Options Content() {
    Hub::Options content;
    content.name = "test";
    content.session_id = "1";
    content.command_topics = {{"operator/command", CommandGroup::kOperator},
                              {"replay/command", CommandGroup::kReplay}};
    content.topics = {{"state", "a/msg/State", "int32 x", true}};
    return content;
  }
  static ListenOptions AnyPort() {
    ListenOptions options;
    options.port = 0;
    return options;
  }
  std::string Get(const std::string& target, const std::string& host = "localhost") {
    RawClient client(server.port());
    client.Send("GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n");
    return client.ReadToEnd();
  }
  Hub::Counts Counts() { return CountsOf(server); }
  static Hub::Counts CountsOf(WebServer& server) {
    std::promise<Hub::Counts> promise;
    server.Post([&](Hub& hub) { promise.set_value(hub.counts()); });
    return promise.get_future().get();
  }
  static std::string Upgrade(const std::string& more) {
    return "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
           "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
           more + "\r\n";
  }

  WebServer server{AnyPort(),
                   Content(),
                   {{"/", {"text/html", "<p>index"}}, {"/page.js", {"text/javascript", "1;"}}},
                   {[](const Hub::WantedChanges&) {},
                    [this](Hub::ClientId client, const ClientInfo& info, const ClientCommand& command) {
                      EXPECT_TRUE(info.address.starts_with("127.0.0.1:")) << info.address;
                      const auto& its = std::get<Command>(command.content);
                      const bool accepted = its.kind == CommandKind::kPause;
                      server.Post([=, name = info.name](Hub& hub) {
                        hub.Answer(client, command.ticket, {accepted, "explorer", "heard from " + name});
                      });
                    }}};
};

TEST_F(WebServerTest, ServesThePagesFilesAndNothingElse) {
  EXPECT_TRUE(Get("/").ends_with("<p>index"));
  EXPECT_TRUE(Get("/?token=x").ends_with("<p>index"));
  EXPECT_TRUE(Get("/page.js").starts_with("HTTP/1.1 200"));
  for (const char* target :
       {"/../etc/passwd", "/%2e%2e/etc/passwd", "/page.js/../../etc/passwd", "//etc/passwd", "/page.css"}) {
    EXPECT_TRUE(Get(target).starts_with("HTTP/1.1 404")) << target;
  }
  EXPECT_TRUE(Get("/", "evil.example").starts_with("HTTP/1.1 403"));
}

TEST_F(WebServerTest, WhatIsTooLongOrNoRequestIsAnsweredBeforeTheConnectionEnds) {
  RawClient too_long(server.port());
  too_long.Send("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(100'000, 'x'));
  EXPECT_EQ(too_long.ReadUntil("\r\n"), "HTTP/1.1 431 Request Header Fields Too Large\r\n");
  EXPECT_NE(too_long.ReadToEnd().find("too long"), std::string::npos);
  RawClient no_request(server.port());
  no_request.Send("what is this?\r\n\r\n");
  EXPECT_EQ(no_request.ReadUntil("\r\n"), "HTTP/1.1 400 Bad Request\r\n");
}

TEST_F(WebServerTest, APageThatWasNotBuiltCostsOnlyThePage) {
  const PageFiles page = LoadPage("/nonexistent");
  WebServer without_page(AnyPort(), Content(), page,
                         {[](const auto&) {}, [](auto, const auto&, const auto&) {}});
  RawClient browser(without_page.port());
  browser.Send("GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_NE(browser.ReadToEnd().find("The page was not built"), std::string::npos);
  RawClient client(without_page.port());
  client.Send(Upgrade("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
  client.ReadUntil("advertiseServices");
  client.Send(TextFrame(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})"));
  client.Send(TextFrame(R"({"op":"getParameters","parameterNames":[]})"));
  client.ReadUntil("parameterValues");
  without_page.Post([](Hub& hub) {
    const std::string text = "the message";
    hub.Publish(0, Time(), std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end()));
  });
  EXPECT_NE(client.ReadUntil("the message").find("the message"), std::string::npos);
}

TEST_F(WebServerTest, ASocketNeedsAKnownSubprotocolAndTheGatewaysOwnOrigin) {
  const auto answer = [&](const std::string& more) {
    RawClient client(server.port());
    client.Send(Upgrade(more));
    return client.ReadUntil("\r\n\r\n");
  };
  EXPECT_TRUE(answer("").starts_with("HTTP/1.1 400"));
  EXPECT_TRUE(answer("Sec-WebSocket-Protocol: chat\r\n").starts_with("HTTP/1.1 400"));
  EXPECT_TRUE(answer("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\nOrigin: http://evil.example\r\n")
                  .starts_with("HTTP/1.1 403"));
  for (const std::string protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    const std::string accepted =
        answer("Sec-WebSocket-Protocol: chat, " + protocol + "\r\nOrigin: http://localhost\r\n");
    EXPECT_TRUE(accepted.starts_with("HTTP/1.1 101"));
    EXPECT_NE(accepted.find("Sec-WebSocket-Protocol: " + protocol + "\r\n"), std::string::npos);
  }
}

TEST_F(WebServerTest, WhoeverIsRefusedLearnsWhyAndIsCounted) {
  const auto answer = [&](const std::string& more) {
    RawClient client(server.port());
    client.Send(Upgrade(more));
    return client.ReadToEnd();
  };
  EXPECT_EQ(Counts().refused_requests, 0U);
  EXPECT_TRUE(answer("Connection: close\r\n").ends_with("foxglove.websocket.v1 and foxglove.sdk.v1\n"));
  EXPECT_EQ(Counts().refused_requests, 1U);
  const std::string reason = "origin \"http://evil.example\" is not the gateway's own page at localhost";
  EXPECT_TRUE(answer("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\nOrigin: http://evil.example\r\n")
                  .ends_with(reason + "\n"));
  EXPECT_EQ(Counts().refused_requests, 2U);
  EXPECT_EQ(Counts().last_refused_request, reason);
  Get("/", "evil.example");
  EXPECT_EQ(Counts().refused_requests, 3U);
  Get("/nothing");
  Get("/");
  EXPECT_EQ(Counts().refused_requests, 3U) << "a file that is missing is nobody's attempt";
}

TEST_F(WebServerTest, WithATokenASocketNeedsItAndAWrongOneIsRefusedAndCounted) {
  ListenOptions options = AnyPort();
  options.token = "right-token";
  WebServer guarded(options, Content(), {{"/", {"text/html", "<p>index"}}}, {});
  const auto answer = [&](const std::string& target, const std::string& more) {
    RawClient client(guarded.port());
    std::string request = Upgrade("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n" + more);
    client.Send(request.replace(request.find('/'), 1, target));
    return client.ReadUntil("\r\n\r\n");
  };
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"/", ""},
      {"/?token=", ""},
      {"/?token=wrong", ""},
      {"/?token=right-toke", ""},
      {"/?token=right-token2", ""},
      {"/?tokens=right-token", ""},
      {"/", "Authorization: Bearer wrong\r\n"},
      {"/?token=right-token", "Authorization: Bearer wrong\r\n"},
  };
  for (std::size_t n = 0; n < wrong.size(); ++n) {
    const auto& [target, header] = wrong[n];
    EXPECT_TRUE(answer(target, header).starts_with("HTTP/1.1 401")) << target << ' ' << header;
    EXPECT_EQ(CountsOf(guarded).refused_requests, n + 1) << target << ' ' << header;
  }
  EXPECT_EQ(CountsOf(guarded).last_refused_request, "the token is wrong");
  // A page cannot read a socket's refusal, but ask for it, which is counted with the socket's.
  const auto asked = [&](const std::string& target) {
    RawClient page(guarded.port());
    page.Send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    return page.ReadToEnd();
  };
  const std::string refusal = asked("/may-connect?token=wrong");
  EXPECT_TRUE(refusal.starts_with("HTTP/1.1 401") && refusal.ends_with("the token is wrong")) << refusal;
  EXPECT_TRUE(asked("/may-connect").ends_with("a token is needed: add ?token=... to the address"));
  EXPECT_TRUE(asked("/may-connect?token=right-token").starts_with("HTTP/1.1 200"));
  EXPECT_EQ(CountsOf(guarded).refused_requests, wrong.size());
  EXPECT_EQ(CountsOf(guarded).clients, 0U);
  // The right one is no way around the other conditions.
  EXPECT_TRUE(answer("/?token=right-token", "Origin: http://evil.example\r\n").starts_with("HTTP/1.1 403"));
  const std::uint64_t refused = CountsOf(guarded).refused_requests;
  EXPECT_TRUE(answer("/?token=right-token", "").starts_with("HTTP/1.1 101"));
  EXPECT_TRUE(answer("/", "Authorization: Bearer right-token\r\n").starts_with("HTTP/1.1 101"));
  EXPECT_EQ(CountsOf(guarded).refused_requests, refused);
}

TEST_F(WebServerTest, AClientGetsWhatItSubscribedTo) {
  RawClient client(server.port());
  client.Send(Upgrade("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
  EXPECT_NE(client.ReadUntil("\"op\":\"advertise\"").find("serverInfo"), std::string::npos);
  client.Send(TextFrame(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})"));
  client.Send(TextFrame(R"({"op":"getParameters","parameterNames":[]})"));
  client.ReadUntil("parameterValues");  // so that the subscription has been handled
  server.Post([](Hub& hub) {
    const std::string text = "the message";
    hub.Publish(0, Time(), std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end()));
  });
  const std::string received = client.ReadUntil("the message");
  EXPECT_NE(received.find(std::string("\x01\x05\0\0\0", 5)), std::string::npos);
}

TEST_F(WebServerTest, ACommandReachesTheRobotAndItsAnswerTheClientThatSentIt) {
  RawClient other(server.port());
  other.Send(Upgrade("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
  other.ReadUntil("advertiseServices");
  RawClient client(server.port());
  client.Send(Upgrade("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
  client.ReadUntil("advertiseServices");
  client.Send(
      TextFrame(R"({"op":"advertise","channels":[{"id":1,"topic":"/operator/command","encoding":"json"}]})"));
  client.Send(BinaryFrame(std::string("\x01\x01\0\0\0", 5) + R"({"kind":"pause"})"));
  EXPECT_NE(client.ReadUntil("heard from client").find("\"level\":0"), std::string::npos);
  client.Send(BinaryFrame(std::string("\x01\x01\0\0\0", 5) + R"({"kind":"home"})"));
  EXPECT_NE(client.ReadUntil("heard from client").find("refused: "), std::string::npos);
  other.Send(TextFrame(R"({"op":"getParameters","parameterNames":[]})"));
  EXPECT_EQ(other.ReadUntil("parameterValues").find("heard"), std::string::npos);
}

TEST_F(WebServerTest, AClientOfInvalidFramesIsClosedWithTheReason) {
  RawClient client(server.port());
  client.Send(Upgrade("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
  client.ReadUntil("\"op\":\"advertise\"");
  for (int n = 0; n < Session::kMaxInvalidFrames; ++n) client.Send(TextFrame("nonsense"));
  EXPECT_NE(client.ReadUntil("too many invalid frames").find("too many invalid frames"), std::string::npos);
}

TEST_F(WebServerTest, AClientThatAsksButNeverReadsIsClosed) {
  RawClient client(server.port());
  client.Send(Upgrade("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
  client.ReadUntil("advertiseServices");
  // Each request is answered by many times its length, so that soon nothing more fits into the connection.
  const std::string request = TextFrame(R"({"op":"getParameters","parameterNames":[]})");
  std::string many;
  for (int n = 0; n < 1000; ++n) many += request;
  while (client.TrySend(many)) {
  }
  EXPECT_EQ(Counts().clients, 0U);
}

TEST_F(WebServerTest, ConnectionsInSilenceDoNotShutOutThePage) {
  std::vector<std::unique_ptr<RawClient>> silent;
  for (int n = 0; n < 200; ++n) silent.push_back(std::make_unique<RawClient>(server.port()));
  const std::string answer = Get("/page.js");
  EXPECT_NE(answer.find("200 OK"), std::string::npos) << answer;
  EXPECT_EQ(silent.front()->ReadToEnd(), "") << "the longest silent one is closed";
}

TEST_F(WebServerTest, ATooLongFrameIsClosedWithoutBeingRead) {
  RawClient client(server.port());
  client.Send(Upgrade("Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n"));
  client.ReadUntil("\"op\":\"advertise\"");
  client.Send(std::string("\x81\xff\0\0\0\x40\0\0\0\0\0\0\0\0", 14));  // announces 256 GiB
  EXPECT_NE(client.ReadToEnd().find("\x03\xf1"), std::string::npos);   // 1009, message too big
}

/// [byte] Memory of this process that is in use.
long Resident() {
  std::ifstream statm("/proc/self/statm");
  long pages = 0;
  statm >> pages >> pages;
  return pages * sysconf(_SC_PAGESIZE);
}

TEST_F(WebServerTest, TenClientsOfWhichOneReadsAKilobyteARoundCostNoMoreMemoryTheLongerTheyStay) {
  constexpr int kRounds = 400;
  constexpr std::size_t kBytes = 200'000;
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int n = 0; n < 10; ++n) {
    clients.push_back(std::make_unique<RawClient>(server.port()));
    clients.back()->Send(Upgrade("Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"));
    clients.back()->ReadUntil("advertiseServices");
    clients.back()->Send(TextFrame(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})"));
    clients.back()->Send(TextFrame(R"({"op":"getParameters","parameterNames":[]})"));
    clients.back()->ReadUntil("parameterValues");
  }
  long settled = 0;
  for (int round = 0; round < kRounds; ++round) {
    server.Post([&](Hub& hub) {
      hub.Publish(0, Time(), std::make_shared<const std::vector<std::uint8_t>>(kBytes, std::uint8_t{7}));
    });
    for (std::size_t n = 1; n < clients.size(); ++n) clients[n]->Read(kBytes);
    clients[0]->Read(1000);
    if (round == kRounds / 4) settled = Resident();
  }
  const Hub::Counts end = Counts();
  EXPECT_EQ(end.clients, 10U) << "nobody was closed";
  EXPECT_GT(end.replaced, static_cast<std::uint64_t>(kRounds) / 2) << "the slow client skipped messages";
  EXPECT_LE(end.waiting_bytes, 2 * kBytes);
  if (test::kSanitized) return;
  EXPECT_LT(Resident() - settled, 4'000'000) << "300 rounds of 200 kB for a client that takes 1 kB of each";
}

TEST_F(WebServerTest, APortInUseIsNamed) {
  ListenOptions options;
  options.port = server.port();
  try {
    WebServer(options, Content(), {}, {});
    FAIL() << "two servers listen on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("port " + std::to_string(server.port())), std::string::npos);
  }
}

TEST_F(WebServerTest, APortInUseIsPassedOverWhereMoreMayBeTried) {
  ListenOptions options;
  options.port = server.port();
  options.more_ports = 100;
  const WebServer other(options, Content(), {}, {});
  EXPECT_GT(other.port(), server.port());
}

TEST(ListenOptions, MorePortsAreTriedOnlyWhereNoneIsNamed) {
  unsetenv("THALWEG_GATEWAY_PORT");
  EXPECT_EQ(ListenOptionsFromEnvironment().more_ports, 9);
  setenv("THALWEG_GATEWAY_PORT", "8765", 1);
  EXPECT_EQ(ListenOptionsFromEnvironment().more_ports, 0);
  unsetenv("THALWEG_GATEWAY_PORT");
}

TEST(WebServer, AnAddressThatOthersReachNeedsAToken) {
  ListenOptions options;
  options.address = "0.0.0.0";
  options.port = 0;
  EXPECT_THROW(WebServer(options, {}, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::gateway
