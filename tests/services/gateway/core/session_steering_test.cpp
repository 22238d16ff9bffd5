#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "services/gateway/core/session.h"

// The commands of a client, from its frames to the replies. What else a session does is in session_test.cpp.

namespace thalweg::gateway {
namespace {

using nlohmann::json;
using std::chrono_literals::operator""s;

std::string Id32(std::uint32_t value) {
  std::string bytes;
  for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<char>(value >> (8 * k) & 0xff));
  return bytes;
}

class SteeringTest : public testing::Test {
 protected:
  static ClientInfo Operator() {
    return {.name = "test", .address = "127.0.0.1:1", .no_steering = std::nullopt};
  }
  SteeringTest() {
    const json info = NextJson();
    EXPECT_EQ(info["capabilities"],
              json({"parameters", "parametersSubscribe", "connectionGraph", "clientPublish", "services"}));
    EXPECT_EQ(info["supportedEncodings"], json({"json", "cdr"}));
    EXPECT_EQ(NextJson()["op"], "advertise");
    services = NextJson();
  }
  json NextJson() {
    const std::optional<Frame> frame = session.Next();
    EXPECT_TRUE(frame && !frame->binary);
    return frame && !frame->binary ? json::parse(frame->head) : json();
  }
  void Send(const std::string& bytes, Duration now = {}) {
    session.OnBinary({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, now);
  }
  void Call(std::uint32_t service, std::uint32_t call, const std::string& request, Duration now = {}) {
    Send(std::string("\x02") + Id32(service) + Id32(call) + Id32(4) + "json" + request, now);
  }
  void Publish(std::uint32_t channel, const std::string& message) {
    Send(std::string("\x01").append(Id32(channel)).append(message));
  }
  void AdvertiseOn(std::uint32_t id, const std::string& topic, const std::string& encoding) {
    session.OnText(
        json{{"op", "advertise"}, {"channels", {{{"id", id}, {"topic", topic}, {"encoding", encoding}}}}}
            .dump());
  }
  std::uint32_t ServiceId(const std::string& name) {
    for (const json& service : services["services"]) {
      if (service["name"] == name) return service["id"];
    }
    ADD_FAILURE() << name;
    return 0;
  }

  static ServerContent Content() {
    ServerContent content;
    content.command_topics = {{"operator/command", CommandGroup::kOperator},
                              {"replay/command", CommandGroup::kReplay}};
    return content;
  }

  ServerContent content = Content();
  Session session{content, Operator()};
  json services;
};

TEST_F(SteeringTest, ACallBecomesACommandAndItsAnswerGoesBackUnderTheCallsId) {
  Call(ServiceId("/operator/goto"), 77, R"({"point":{"x":1,"y":2,"z":3}})");
  const auto commands = session.TakeCommands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(std::get<Command>(commands[0].content).kind, CommandKind::kGoTo);
  session.Answer(commands[0].ticket, {false, "explorer", "the goal is unknown"});
  const std::optional<Frame> frame = session.Next();
  ASSERT_TRUE(frame && frame->binary);
  EXPECT_EQ(frame->head.substr(0, 17),
            std::string("\x03") + Id32(ServiceId("/operator/goto")) + Id32(77) + Id32(4) + "json");
  const json reply = json::parse(frame->head.substr(17));
  EXPECT_EQ(reply, json({{"accepted", false}, {"service", "explorer"}, {"reason", "the goal is unknown"}}));
}

TEST_F(SteeringTest, CommandsToAReplayAreToldFromThoseToTheRobot) {
  Call(ServiceId("/replay/seek"), 5, R"({"time_s":3})");
  AdvertiseOn(9, "/replay/command", "json");
  Publish(9, R"({"kind":"pause"})");
  AdvertiseOn(10, "replay/command", "cdr");
  Publish(10, std::string("\0\1\0\0abc", 7));
  Call(ServiceId("/operator/pause"), 6, "");
  const auto commands = session.TakeCommands();
  ASSERT_EQ(commands.size(), 4U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(commands[k].group, CommandGroup::kReplay) << k;
  EXPECT_EQ(std::get<Command>(commands[0].content).kind, CommandKind::kReplaySeek);
  EXPECT_EQ(std::get<Command>(commands[1].content).kind, CommandKind::kReplayPause);
  EXPECT_EQ(commands[3].group, CommandGroup::kOperator);
  session.Answer(commands[0].ticket, {false, "gateway", "nothing is replayed here"});
  const std::optional<Frame> frame = session.Next();
  ASSERT_TRUE(frame && frame->binary);
  EXPECT_NE(frame->head.find("nothing is replayed here"), std::string::npos);
}

TEST_F(SteeringTest, APublishedCommandIsAnsweredByAStatus) {
  AdvertiseOn(9, "/operator/command", "json");
  Publish(9, R"({"kind":"pause"})");
  const auto commands = session.TakeCommands();
  ASSERT_EQ(commands.size(), 1U);
  session.Answer(commands[0].ticket, {true, "explorer", "paused"});
  const json status = NextJson();
  EXPECT_EQ(status["op"], "status");
  EXPECT_EQ(status["level"], 0);
  EXPECT_EQ(status["message"], "explorer: paused");
}

TEST_F(SteeringTest, CdrIsPassedOnUndecodedAndRefusedWhereItCannotBeDecoded) {
  AdvertiseOn(9, "operator/command", "cdr");
  Publish(9, std::string("\0\1\0\0abc", 7));
  const auto commands = session.TakeCommands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(std::get<std::vector<std::uint8_t>>(commands[0].content).size(), 7U);
  session.AnswerInvalid(commands[0].ticket, "no command");
  EXPECT_NE(NextJson()["message"].get<std::string>().find("no command"), std::string::npos);
  EXPECT_EQ(session.invalid_frames(), 1);
}

TEST_F(SteeringTest, OnlyCommandsMayBePublished) {
  // Studio announces such a topic whenever it connects, which is no problem that it should show.
  AdvertiseOn(1, "/move_base_simple/goal", "cdr");
  EXPECT_FALSE(session.Next());
  Publish(1, std::string("\0\1\0\0abc", 7));
  EXPECT_NE(NextJson()["message"].get<std::string>().find("/operator/command and /replay/command only"),
            std::string::npos);
  EXPECT_TRUE(session.TakeCommands().empty());
  EXPECT_EQ(session.invalid_frames(), 0);
  AdvertiseOn(2, "/operator/command", "protobuf");
  EXPECT_NE(NextJson()["message"].get<std::string>().find("json or cdr"), std::string::npos);
  AdvertiseOn(3, "/operator/command", "json");
  session.OnText(R"({"op":"unadvertise","channelIds":[3]})");
  Publish(3, R"({"kind":"pause"})");
  EXPECT_TRUE(session.TakeCommands().empty());
}

TEST_F(SteeringTest, AMalformedCommandIsRefusedWithItsReasonAndTooManyEndTheConnection) {
  Call(ServiceId("/operator/goto"), 1, "{}");
  const json failure = NextJson();
  EXPECT_EQ(failure["op"], "serviceCallFailure");
  EXPECT_EQ(failure["callId"], 1);
  EXPECT_NE(failure["message"].get<std::string>().find("\"point\""), std::string::npos);
  for (const std::string& frame : {std::string("\x01\x02"), std::string("\x02\x01"),
                                   std::string("\x02") + Id32(1) + Id32(1) + Id32(0xffffffff) + "json",
                                   std::string("\x02") + Id32(99) + Id32(1) + Id32(4) + "json"})
    Send(frame);
  EXPECT_EQ(session.invalid_frames(), 5);
  while (session.invalid_frames() < Session::kMaxInvalidFrames) Call(1, 1, "nonsense");
  EXPECT_TRUE(session.closing());
  EXPECT_TRUE(session.TakeCommands().empty());
}

TEST_F(SteeringTest, CommandsBeyondTheRateAreRefusedUntilTimeHasPassed) {
  const auto taken = [&](Duration now) {
    int count = 0;
    for (int n = 0; n < 40; ++n) {
      Call(ServiceId("/operator/pause"), 1, "", now);
      for (const ClientCommand& command : session.TakeCommands()) {
        session.Answer(command.ticket, {true, "explorer", ""});
        ++count;
      }
      while (session.Next()) {
      }
    }
    return count;
  };
  EXPECT_EQ(taken(100s), 10);
  EXPECT_EQ(taken(100s), 0);
  EXPECT_EQ(taken(101s), 5);
  EXPECT_EQ(taken(1000s), 10);
  EXPECT_EQ(session.commands(), 25U);
  EXPECT_EQ(session.refused_commands(), 135U);
}

TEST_F(SteeringTest, CommandsThatWaitForTheirAnswersAreLimited) {
  for (int n = 0; n < 10; ++n) Call(ServiceId("/operator/pause"), 1, "", 1000s);
  const auto commands = session.TakeCommands();
  EXPECT_EQ(commands.size(), Session::kMaxPending);
  session.Answer(commands[0].ticket, {true, "explorer", ""});
  Call(ServiceId("/operator/pause"), 1, "", 1001s);
  EXPECT_EQ(session.TakeCommands().size(), 1U);
}

TEST_F(SteeringTest, SettingTheStrategyIsACommandWhoseAnswerStatesTheParameter) {
  content.parameters = {{"a", "1"}, {"explorer.strategy", R"("flow")"}};
  const auto set = [&](const json& value) {
    session.OnText(json{{"op", "setParameters"},
                        {"id", "s"},
                        {"parameters", {{{"name", "explorer.strategy"}, {"value", value}}}}}
                       .dump());
    return session.TakeCommands();
  };
  const auto commands = set("closest");
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(std::get<Command>(commands[0].content).kind, CommandKind::kStrategy);
  EXPECT_EQ(std::get<Command>(commands[0].content).strategy, "closest");
  EXPECT_FALSE(session.Next());  // until the explorer has answered
  session.Answer(commands[0].ticket, {true, "explorer", ""});
  const json accepted = NextJson();
  EXPECT_EQ(accepted["parameters"], json({{{"name", "explorer.strategy"}, {"value", "closest"}}}));
  EXPECT_EQ(accepted["id"], "s");
  session.Answer(set("none")[0].ticket, {false, "explorer", "there is no strategy none"});
  EXPECT_EQ(NextJson()["message"], "explorer: refused: there is no strategy none");
  EXPECT_EQ(NextJson()["parameters"][0]["value"], "flow");
  EXPECT_TRUE(set(7).empty());
  EXPECT_EQ(NextJson()["op"], "status");
  EXPECT_EQ(NextJson()["parameters"][0]["value"], "flow");
}

TEST(Steering, WhoMayNotIsOfferedNothingAndToldWhy) {
  const ServerContent content;
  Session session(content, {.name = "test", .address = "", .no_steering = "the gateway is read-only"});
  EXPECT_EQ(json::parse(session.Next()->head)["capabilities"],
            json::array({"parameters", "parametersSubscribe", "connectionGraph"}));
  EXPECT_EQ(json::parse(session.Next()->head)["op"], "advertise");
  EXPECT_FALSE(session.Next());
  session.OnText(R"({"op":"advertise","channels":[{"id":1,"topic":"/operator/command","encoding":"json"}]})");
  EXPECT_NE(json::parse(session.Next()->head)["message"].get<std::string>().find("read-only"),
            std::string::npos);
  const std::string call = std::string("\x02") + Id32(1) + Id32(5) + Id32(4) + "json";
  session.OnBinary({reinterpret_cast<const std::uint8_t*>(call.data()), call.size()});
  const json failure = json::parse(session.Next()->head);
  EXPECT_EQ(failure["op"], "serviceCallFailure");
  EXPECT_EQ(failure["message"], "the gateway is read-only");
  session.OnText(R"({"op":"setParameters","parameters":[{"name":"explorer.strategy","value":"closest"}]})");
  EXPECT_TRUE(session.TakeCommands().empty());
}

}  // namespace
}  // namespace thalweg::gateway
