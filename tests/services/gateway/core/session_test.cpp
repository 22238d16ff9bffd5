#include "services/gateway/core/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace thalweg::gateway {
namespace {

using nlohmann::json;

Bytes MessageOf(std::size_t size, std::uint8_t value) {
  return std::make_shared<const std::vector<std::uint8_t>>(size, value);
}

constexpr std::size_t kLarge = Session::kLargeMessage;

ServerContent Content() {
  ServerContent content;
  content.name = "thalweg";
  content.session_id = "1";
  content.with_time = true;
  for (const std::uint32_t id : {1U, 2U, 3U})
    content.channels.push_back({id, "/topic", "cdr", "A", "", "ros2msg"});
  content.parameters = {{"a", "1"}, {"b", "2"}};
  return content;
}

/// A client that has read its greeting.
class SessionTest : public testing::Test {
 protected:
  SessionTest() {
    EXPECT_EQ(NextJson()["op"], "serverInfo");
    EXPECT_EQ(NextJson()["op"], "advertise");
  }
  json NextJson() {
    const std::optional<Frame> frame = session.Next();
    EXPECT_TRUE(frame && !frame->binary);
    return frame ? json::parse(frame->head) : json();
  }
  void Subscribe(std::uint32_t id, std::uint32_t channel) {
    session.OnText(
        json{{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}}.dump());
  }
  /// The subscriptions of all frames that wait, in the order in which they are written.
  std::vector<int> Order() {
    std::vector<int> order;
    while (const std::optional<Frame> frame = session.Next()) order.push_back(frame->head[1]);
    return order;
  }

  ServerContent content = Content();
  Session session{content};
};

TEST_F(SessionTest, OnlySubscribedChannelsAreSentUnderTheClientsOwnId) {
  Subscribe(7, 2);
  EXPECT_FALSE(session.Offer(1, Time(), MessageOf(1, 0)));
  EXPECT_TRUE(session.Offer(2, Time(), MessageOf(1, 0)));
  EXPECT_EQ(Order(), std::vector<int>{7});
  session.OnText(R"({"op":"unsubscribe","subscriptionIds":[7]})");
  EXPECT_FALSE(session.Offer(2, Time(), MessageOf(1, 0)));
  EXPECT_FALSE(session.Next());
}

TEST_F(SessionTest, ASlowClientGetsTheNewestMessageOfEachChannelAndTheRestIsCounted) {
  Subscribe(1, 1);
  for (std::uint8_t n = 0; n < 100; ++n) session.Offer(1, Time(), MessageOf(1, n));
  const std::optional<Frame> frame = session.Next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->body->front(), 99);
  EXPECT_FALSE(session.Next());
  EXPECT_EQ(session.dropped(), 99U);
}

TEST_F(SessionTest, PosesGoBeforeCloudsThatCameFirst) {
  for (const std::uint32_t n : {1U, 2U, 3U}) Subscribe(n, n);
  session.Offer(1, Time(), MessageOf(kLarge, 0));
  session.Offer(2, Time(), MessageOf(kLarge - 1, 0));
  session.Offer(3, Time(), MessageOf(1, 0));
  EXPECT_EQ(Order(), (std::vector<int>{2, 3, 1}));
}

TEST_F(SessionTest, AFastChannelCannotPushAnotherBack) {
  for (const std::uint32_t n : {1U, 2U}) Subscribe(n, n);
  std::vector<int> order;
  for (int n = 0; n < 6; ++n) {
    session.Offer(1, Time(), MessageOf(1, 0));
    if (n % 2 == 0) session.Offer(2, Time(), MessageOf(1, 0));
    order.push_back(session.Next()->head[1]);
  }
  EXPECT_EQ(std::count(order.begin(), order.end(), 2), 3);
}

TEST_F(SessionTest, OnlyTheNewestTimeWaits) {
  session.OfferTime(Time(Duration(1)));
  session.OfferTime(Time(Duration(2)));
  EXPECT_EQ(session.Next()->head, TimeFrame(Time(Duration(2))).head);
  EXPECT_FALSE(session.Next());
}

TEST_F(SessionTest, AMistakenSubscriptionIsAnsweredAndChangesNothing) {
  Subscribe(1, 1);
  Subscribe(1, 2);  // id in use
  EXPECT_EQ(NextJson()["level"], 2);
  Subscribe(2, 1);  // channel taken
  EXPECT_EQ(NextJson()["level"], 2);
  Subscribe(3, 99);  // no such channel
  EXPECT_EQ(NextJson()["message"], "subscription 3 to channel 99: there is no such channel");
  session.OnText(R"({"op":"unsubscribe","subscriptionIds":[42]})");
  EXPECT_EQ(NextJson()["level"], 1);
  EXPECT_TRUE(session.Wants(1));
  EXPECT_FALSE(session.Wants(2));
  EXPECT_EQ(session.invalid_frames(), 0);
}

TEST_F(SessionTest, AnInvalidFrameIsAnsweredAndManyOfThemEndTheConnection) {
  session.OnText("nonsense");
  EXPECT_EQ(NextJson()["message"], "invalid frame: the frame is not a JSON object");
  EXPECT_FALSE(session.closing());
  for (int n = 1; n < Session::kMaxInvalidFrames; ++n) session.OnBinary({});
  ASSERT_TRUE(session.closing());
  EXPECT_EQ(*session.closing(), "too many invalid frames; the last: the binary frame is empty");
  EXPECT_EQ(session.invalid_frames(), Session::kMaxInvalidFrames);
}

TEST_F(SessionTest, AClientThatAsksAndNeverReadsIsEnded) {
  for (std::size_t n = 0; n <= Session::kMaxReplies; ++n) {
    session.OnText(R"({"op":"getParameters","parameterNames":[]})");
  }
  EXPECT_EQ(session.closing(), "requests arrive faster than their replies are read");
}

TEST_F(SessionTest, ParametersAreReadAndCannotBeChanged) {
  session.OnText(R"({"op":"getParameters","parameterNames":["b"],"id":"x"})");
  const json got = NextJson();
  EXPECT_EQ(got["parameters"], json({{{"name", "b"}, {"value", 2}}}));
  EXPECT_EQ(got["id"], "x");
  session.OnText(R"({"op":"setParameters","parameters":[{"name":"b","value":9}],"id":"y"})");
  EXPECT_EQ(NextJson()["op"], "status");
  EXPECT_EQ(NextJson()["parameters"][1]["value"], 2);
  EXPECT_TRUE(session.TakeCommands().empty());
}

TEST_F(SessionTest, OfAChangedParameterOnlyTheNewestValueIsToldToWhomItConcerns) {
  session.OnText(R"({"op":"subscribeParameterUpdates","parameterNames":["b","unknown"]})");
  for (const char* name : {"a", "b", "b", "unknown"}) session.OnParameterChange(name);
  EXPECT_EQ(NextJson(), json({{"op", "parameterValues"}, {"parameters", {{{"name", "b"}, {"value", 2}}}}}));
  EXPECT_FALSE(session.Next());
  session.OnText(R"({"op":"unsubscribeParameterUpdates","parameterNames":["b"]})");
  session.OnParameterChange("b");
  EXPECT_FALSE(session.Next());
}

TEST_F(SessionTest, ARequestThatIsNotOfferedIsAnsweredAndNotCountedAsInvalid) {
  session.OnText(R"({"op":"fetchAsset"})");
  EXPECT_EQ(NextJson()["level"], 1);
  const std::vector<std::uint8_t> publish = {1, 0, 0, 0, 0};
  session.OnBinary(publish);
  EXPECT_EQ(NextJson()["message"], "command refused: nobody may steer here");
  EXPECT_EQ(session.invalid_frames(), 0);
}

TEST_F(SessionTest, OfAChannelThatSeveralWritersShareTheNewestFewWaitInTheirOrder) {
  content.channels[1].depth = 3;
  Subscribe(7, 2);
  Subscribe(8, 1);
  for (std::uint8_t n = 1; n <= 5; ++n) session.Offer(2, Time(), MessageOf(1, n));
  session.Offer(1, Time(), MessageOf(1, 9));
  EXPECT_EQ(session.dropped(), 2U);
  EXPECT_EQ(session.waiting_bytes(), 4U);
  std::vector<int> values;
  while (const std::optional<Frame> frame = session.Next()) values.push_back(frame->body->front());
  EXPECT_EQ(values, (std::vector<int>{3, 9, 4, 5})) << "the other channel is not held up";
  EXPECT_EQ(session.waiting_bytes(), 0U);
}

/// A feed with `size` messages of one byte.
class CountingFeed final : public Feed {
 public:
  explicit CountingFeed(std::uint64_t size) : size_(size) {}
  std::optional<Message> Next(std::uint64_t& cursor) const override {
    if (cursor >= size_) return std::nullopt;
    ++cursor;
    return Message{Time(), MessageOf(1, 0)};
  }

 private:
  std::uint64_t size_;
};

TEST(SessionWithFeeds, AFeedAndLargeMessagesAlternateAndSmallOnesGoFirst) {
  const CountingFeed feed(3);
  ServerContent content = Content();
  content.feeds[3] = &feed;
  Session session(content);
  while (session.Next()) continue;
  session.OnText(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":2},)"
                 R"({"id":3,"channelId":3}]})");
  std::vector<int> order;
  session.Offer(2, Time(), MessageOf(1, 0));
  for (int n = 0; n < 6; ++n) {
    session.Offer(1, Time(), MessageOf(kLarge, 0));
    if (const std::optional<Frame> frame = session.Next()) order.push_back(frame->head[1]);
  }
  ASSERT_EQ(order.size(), 6U);
  EXPECT_EQ(order.front(), 2);
  for (std::size_t n = 2; n < order.size(); ++n) EXPECT_NE(order[n], order[n - 1]);
  EXPECT_EQ(std::count(order.begin(), order.end(), 1) + std::count(order.begin(), order.end(), 3), 5);
}

}  // namespace
}  // namespace thalweg::gateway
