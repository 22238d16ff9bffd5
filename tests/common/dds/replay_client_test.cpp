#include "common/dds/replay_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "common/dds/convert.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using namespace thalweg_msgs::msg;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using test::BusOptionsForTest;
using test::kPatience;

constexpr Time kBegin{1000s};

/// A replay of 90 s that refuses rates above 10 and obeys everything else, but is deaf to senders called
/// "deaf".
class FakeReplay {
 public:
  FakeReplay() : bus_(BusOptionsForTest("replay")), status_out_(bus_.Advertise<topics::ReplayStatus>()) {
    status_.begin(ToIdl(kBegin));
    status_.end(ToIdl(kBegin + 90s));
    status_.now(ToIdl(kBegin));
    status_.rate(1.0);
    bus_.Subscribe<topics::ReplayCommands>([this](const auto& command) { Obey(command); });
    bus_.EveryWall(50ms, [this] { status_out_.Write(status_); });
    thread_ = std::jthread([this](const std::stop_token& stop) { bus_.Spin(stop); });
  }

 private:
  void Obey(const ReplayCommand& command) {
    if (command.sender() == "deaf") return;
    status_.last_refusal("");
    if (command.kind() == REPLAY_RATE && command.rate() > 10.0) {
      status_.last_refusal("too fast");
    } else if (command.kind() == REPLAY_RATE) {
      status_.rate(command.rate());
    } else if (command.kind() == REPLAY_SEEK) {
      status_.now(command.time());
    } else {
      status_.paused(command.kind() == REPLAY_PAUSE);
    }
    status_out_.Write(status_);
  }

  Bus bus_;
  Bus::Publisher<topics::ReplayStatus> status_out_;
  ReplayStatus status_;
  std::jthread thread_;
};

std::function<ReplayCommand()> ReplayCommandOf(ReplayCommandKind kind, double rate = 1.0, Time time = {},
                                               const std::string& sender = "test") {
  return [=] {
    ReplayCommand command;
    command.sender(sender);
    command.kind(kind);
    command.rate(rate);
    command.time(ToIdl(time));
    return command;
  };
}

TEST(ReplayClient, WhatIsObeyedAndWhatIsRefusedShowsInTheStatus) {
  const FakeReplay replay;
  Bus bus(BusOptionsForTest("client"));
  ReplayClient client(bus);
  const auto answer = [&](const std::function<ReplayCommand()>& make) {
    const auto its = client.SendAndWait(make, kPatience);
    return its ? *its : "refused: " + its.error();
  };
  EXPECT_EQ(answer(ReplayCommandOf(REPLAY_PAUSE)), "paused at 0:00 of 1:30");
  EXPECT_EQ(client.TimeAt(65s), kBegin + 65s);
  EXPECT_EQ(answer(ReplayCommandOf(REPLAY_SEEK, 1.0, kBegin + 65s)), "paused at 1:05 of 1:30");
  EXPECT_EQ(answer(ReplayCommandOf(REPLAY_RATE, 2.5)), "paused at 1:05 of 1:30, rate 2.5");
  for (int k = 0; k < 2; ++k) EXPECT_EQ(answer(ReplayCommandOf(REPLAY_RATE, 11.0)), "refused: too fast") << k;
  EXPECT_EQ(answer(ReplayCommandOf(REPLAY_RESUME)), "playing at 1:05 of 1:30, rate 2.5");
  const auto unheard = client.SendAndWait(ReplayCommandOf(REPLAY_PAUSE, 1.0, {}, "deaf"), 1s);
  ASSERT_FALSE(unheard);
  EXPECT_EQ(unheard.error(), "no answer from the replay");
}

TEST(ReplayClient, WhereNothingIsReplayedACommandIsRefusedAtOnce) {
  Bus bus(BusOptionsForTest("client"));
  ReplayClient client(bus);
  std::string reason;
  client.Send(ReplayCommandOf(REPLAY_PAUSE)(), kPatience,
              [&](const auto& answer) { reason = answer.error(); });
  EXPECT_EQ(reason, ReplayClient::kNothing);
  EXPECT_EQ(client.status(), nullptr);
}

}  // namespace
}  // namespace thalweg::dds
