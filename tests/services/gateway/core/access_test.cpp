#include "services/gateway/core/access.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace thalweg::gateway {
namespace {

constexpr auto kBoth = "foxglove.sdk.v1, foxglove.websocket.v1";

RequestHead Head(std::string_view host, std::string_view origin, std::string_view target = "/",
                 std::string_view authorization = "") {
  return {target, host, origin, authorization, kBoth};
}

int Refused(const Access& access, const RequestHead& head) {
  const std::optional<Refusal> refusal = access.RefuseSocket(head);
  if (!refusal) return 0;
  EXPECT_FALSE(refusal->reason.empty());
  return refusal->http_status;
}

TEST(Access, OnlyAnAddressOfThisMachineNeedsNoToken) {
  EXPECT_NO_THROW(Access("127.0.0.1", ""));
  EXPECT_NO_THROW(Access("127.8.0.9", ""));
  EXPECT_NO_THROW(Access("::1", ""));
  EXPECT_THROW(Access("0.0.0.0", ""), std::invalid_argument);
  EXPECT_THROW(Access("192.168.1.2", ""), std::invalid_argument);
  EXPECT_THROW(Access("::", ""), std::invalid_argument);
  EXPECT_NO_THROW(Access("0.0.0.0", "secret"));
}

TEST(Access, ATokenThatAUrlWouldEscapeIsRefusedAtStart) {
  EXPECT_THROW(Access("127.0.0.1", "a b"), std::invalid_argument);
  EXPECT_THROW(Access("127.0.0.1", "a&b"), std::invalid_argument);
  EXPECT_NO_THROW(Access("127.0.0.1", "aZ09-_.~"));
}

TEST(Access, ABrowserMayComeOnlyFromTheGatewaysOwnPage) {
  const Access access("127.0.0.1", "");
  EXPECT_EQ(Refused(access, Head("127.0.0.1:8765", "http://127.0.0.1:8765")), 0);
  EXPECT_EQ(Refused(access, Head("localhost:8765", "http://LOCALHOST:8765")), 0);
  EXPECT_EQ(Refused(access, Head("localhost:8765", "https://localhost:8765")), 0);
  EXPECT_EQ(Refused(access, Head("localhost:8765", "http://localhost:80")), 403);
  EXPECT_EQ(Refused(access, Head("localhost:8765", "http://evil.example")), 403);
  EXPECT_EQ(Refused(access, Head("localhost:8765", "null")), 403);
}

TEST(Access, AClientThatIsNoBrowserHasNoOrigin) {
  EXPECT_EQ(Refused(Access("127.0.0.1", ""), Head("localhost:8765", "")), 0);
}

TEST(Access, AHostNameThatResolvesToThisMachineIsNotEnough) {
  const Access access("127.0.0.1", "");
  EXPECT_EQ(Refused(access, Head("evil.example:8765", "http://evil.example:8765")), 403);
  EXPECT_EQ(Refused(access, Head("127.evil.example", "http://127.evil.example")), 403);
  EXPECT_EQ(Refused(access, Head("127.0.0.1.evil.example", "")), 403);
  EXPECT_EQ(Refused(access, Head("", "")), 400);
}

TEST(Access, WithATokenAnyHostMayAskButOnlyWithTheTokenItself) {
  const Access access("0.0.0.0", "secret");
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "", "/?token=secret")), 0);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "", "/?a=1&token=secret&b")), 0);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "", "/", "Bearer secret")), 0);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "")), 401);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "", "/?token=")), 401);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "", "/?token=secre")), 401);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "", "/?token=secrets")), 401);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "", "/?nottoken=secret")), 401);
  EXPECT_EQ(Refused(access, Head("robot.lan:8765", "http://evil.example", "/?token=secret")), 403);
}

TEST(Access, BothSubprotocolsAreSpokenAndTheClientsFirstIsChosen) {
  EXPECT_EQ(ChooseProtocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(ChooseProtocol("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(ChooseProtocol(kBoth), "foxglove.sdk.v1");
  EXPECT_EQ(ChooseProtocol("chat,\tfoxglove.websocket.v1 "), "foxglove.websocket.v1");
  EXPECT_EQ(ChooseProtocol(""), "");
  EXPECT_EQ(ChooseProtocol("foxglove.websocket.v2,,"), "");
  RequestHead head = Head("localhost", "");
  head.protocols = "chat";
  EXPECT_EQ(Refused(Access("127.0.0.1", ""), head), 400);
}

TEST(Access, ThePageItselfNeedsNoTokenSinceItHoldsNothing) {
  EXPECT_FALSE(Access("0.0.0.0", "secret").RefusePage(Head("robot.lan", "")));
  EXPECT_EQ(PathOf("/page.js?token=x"), "/page.js");
}

TEST(Access, SteeringIsForThisMachineOrTheTokenAndForNobodyWhereItIsReadOnly) {
  EXPECT_FALSE(Access("127.0.0.1", "").RefuseSteering("127.0.0.1"));
  EXPECT_FALSE(Access("::1", "").RefuseSteering("::1"));
  EXPECT_TRUE(Access("127.0.0.1", "").RefuseSteering("192.168.0.7"));
  EXPECT_TRUE(Access("127.0.0.1", "").RefuseSteering(""));
  EXPECT_FALSE(Access("0.0.0.0", "secret").RefuseSteering("192.168.0.7"));
  EXPECT_EQ(Access("127.0.0.1", "", "read-only").RefuseSteering("127.0.0.1"), "read-only");
  EXPECT_EQ(Access("0.0.0.0", "secret", "read-only").RefuseSteering("192.168.0.7"), "read-only");
}

TEST(Access, OtherPagesMayConnectOnlyByTheirExactOrigin) {
  const Access access("127.0.0.1", "", {}, "https://App.foxglove.dev, http://localhost:81");
  const auto refused = [&](std::string_view origin) {
    return access.RefuseSocket({"/", "localhost:8765", origin, "", "foxglove.sdk.v1"}).has_value();
  };
  EXPECT_FALSE(refused("https://app.foxglove.dev"));
  EXPECT_FALSE(refused("http://localhost:81"));
  EXPECT_FALSE(refused("http://localhost:8765"));
  for (const char* origin : {"http://localhost", "http://localhost:811",
                             "https://app.foxglove.dev.evil.example", "http://app.foxglove.dev", ","})
    EXPECT_TRUE(refused(origin)) << origin;
}

TEST(Access, AClientsNameIsCutToWhatALogCanHold) {
  EXPECT_EQ(NameOfClient("/?token=x&name=page"), "page");
  EXPECT_EQ(NameOfClient("/"), "client");
  EXPECT_EQ(NameOfClient("/?name=%1b[31m<b>"), "1b31mb");
  EXPECT_EQ(NameOfClient("/?name=" + std::string(100, 'a')), std::string(24, 'a'));
}

}  // namespace
}  // namespace thalweg::gateway
