#include "common/dds/operator_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <thread>
#include <vector>

#include "common/dds/command_ledger.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using std::chrono_literals::operator""ms;
using test::BusOptionsForTest;
using test::kPatience;

/// A service that replies to every command after the first `deaf` copies.
class Service {
 public:
  explicit Service(int deaf, const std::string& name = "explorer", const std::string& reason = "why")
      : bus_(BusOptionsForTest("service")) {
    const auto replies = bus_.Advertise<topics::CommandReplies>();
    bus_.Subscribe<topics::OperatorCommands>([this, replies, deaf, name, reason](const auto& command) {
      ids_.insert(command.id());
      if (++copies_ <= deaf) return;
      const bool accepted = command.kind() == thalweg_msgs::msg::COMMAND_PAUSE;
      replies.Write(MakeReply(bus_.Now(), "explorer", {"somebody else", command.id()}, true, "not for you"));
      replies.Write(MakeReply(bus_.Now(), name, IdOf(command), accepted, reason));
    });
    thread_ = std::jthread([this](std::stop_token stop) { bus_.Spin(stop); });
  }
  /// Ends the service.
  std::set<std::uint64_t> Ids() {
    thread_ = {};
    return ids_;
  }

 private:
  Bus bus_;
  int copies_ = 0;
  std::set<std::uint64_t> ids_;
  std::jthread thread_;
};

thalweg_msgs::msg::OperatorCommand OperatorCommandOf(thalweg_msgs::msg::CommandKind kind) {
  thalweg_msgs::msg::OperatorCommand command;
  command.kind(kind);
  command.sender("test");
  return command;
}

TEST(OperatorClient, ACommandIsRepeatedUnderOneIdUntilItsReplyComes) {
  Service service(2);
  Bus bus(BusOptionsForTest("client"));
  OperatorClient client(bus);
  const auto reply = client.SendAndWait(OperatorCommandOf(thalweg_msgs::msg::COMMAND_PAUSE), kPatience);
  ASSERT_TRUE(reply) << reply.error();
  EXPECT_TRUE(reply->accepted());
  EXPECT_EQ(reply->reason(), "why");
  EXPECT_EQ(service.Ids().size(), 1U);
}

TEST(OperatorClient, WhoeverElseReadsCommandsHasOneWhenItsAnswerIsThere) {
  Service service(0);
  Bus recorder(BusOptionsForTest("recorder"));
  std::set<std::uint64_t> recorded;
  recorder.Subscribe<topics::OperatorCommands>([&](const auto& command) { recorded.insert(command.id()); });
  constexpr std::size_t kSenders = 5;
  for (std::size_t sender = 0; sender < kSenders; ++sender) {  // each of which ends with its answer
    Bus bus(BusOptionsForTest("client"));
    OperatorClient client(bus);
    ASSERT_TRUE(bus.SpinUntil([&] { return client.readers() == 2; }, kPatience));
    ASSERT_TRUE(client.SendAndWait(OperatorCommandOf(thalweg_msgs::msg::COMMAND_PAUSE), kPatience));
  }
  EXPECT_TRUE(recorder.SpinUntil([&] { return recorded.size() == kSenders; }, kPatience));
}

TEST(OperatorClient, ARefusalIsAReplyAndEachCommandHasItsOwnId) {
  Service service(0);
  Bus bus(BusOptionsForTest("client"));
  OperatorClient client(bus);
  ASSERT_TRUE(client.SendAndWait(OperatorCommandOf(thalweg_msgs::msg::COMMAND_PAUSE), kPatience));
  const auto reply = client.SendAndWait(OperatorCommandOf(thalweg_msgs::msg::COMMAND_RESUME), kPatience);
  ASSERT_TRUE(reply) << reply.error();
  EXPECT_FALSE(reply->accepted());
  EXPECT_EQ(service.Ids().size(), 2U);
}

TEST(OperatorClient, SeveralCommandsAreUnderWayAtOnceAndEachIsAnsweredOnce) {
  Service service(3);
  Bus bus(BusOptionsForTest("client"));
  OperatorClient client(bus);
  std::vector<bool> accepted;
  for (const auto kind : {thalweg_msgs::msg::COMMAND_PAUSE, thalweg_msgs::msg::COMMAND_HOME}) {
    client.Send(OperatorCommandOf(kind), kPatience, [&](const OperatorClient::Answer& answer) {
      ASSERT_TRUE(answer) << answer.error();
      accepted.push_back(answer->accepted());
    });
  }
  EXPECT_TRUE(bus.SpinUntil([&] { return accepted.size() == 2; }, kPatience));
  EXPECT_EQ(std::ranges::count(accepted, true), 1);
  EXPECT_EQ(service.Ids().size(), 2U);
}

TEST(OperatorClient, ASenderOfAnyNameGetsItsReply) {
  Service service(0);
  Bus bus(BusOptionsForTest("client"));
  OperatorClient client(bus);
  auto command = OperatorCommandOf(thalweg_msgs::msg::COMMAND_PAUSE);
  for (const std::string& name : {std::string("thalweg send of j\xc3\xb6rg"), std::string(300, 'x'),
                                  "\x1b[31m" + std::string(100, 'x')}) {
    command.sender(name);
    EXPECT_TRUE(client.SendAndWait(command, kPatience)) << name;
  }
}

TEST(OperatorClient, WhatAServiceSaysIsCleanedForTheTerminal) {
  const std::string red = "\x1b[31m";
  Service service(0, red + "explorer", red + "line\nbreak" + std::string(1000, 'x'));
  Bus bus(BusOptionsForTest("client"));
  OperatorClient client(bus);
  const auto reply = client.SendAndWait(OperatorCommandOf(thalweg_msgs::msg::COMMAND_PAUSE), kPatience);
  ASSERT_TRUE(reply) << reply.error();
  EXPECT_EQ(reply->service(), "\xEF\xBF\xBD[31mexplorer");
  EXPECT_THAT(reply->reason(), testing::StartsWith("\xEF\xBF\xBD[31mline breakxxx"));
  EXPECT_LT(reply->reason().size(), 220U);
}

TEST(OperatorClient, WithoutAnybodyItSaysSo) {
  Bus bus(BusOptionsForTest("client"));
  OperatorClient client(bus);
  const auto reply = client.SendAndWait(OperatorCommandOf(thalweg_msgs::msg::COMMAND_PAUSE), 100ms);
  ASSERT_FALSE(reply);
  EXPECT_THAT(reply.error(), testing::HasSubstr("nobody listens to operator/command"));
}

TEST(OperatorClient, AServiceThatNeverRepliesIsNamed) {
  Service service(1000);
  Bus bus(BusOptionsForTest("client"));
  OperatorClient client(bus);
  const auto reply = client.SendAndWait(OperatorCommandOf(thalweg_msgs::msg::COMMAND_SAVE_MAP), 3000ms);
  ASSERT_FALSE(reply);
  EXPECT_THAT(reply.error(), testing::AnyOf(testing::HasSubstr("no reply from the mapper"),
                                            testing::HasSubstr("nobody listens")));
}

}  // namespace
}  // namespace thalweg::dds
