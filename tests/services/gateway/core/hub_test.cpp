#include "services/gateway/core/hub.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace thalweg::gateway {
namespace {

using nlohmann::json;
using std::chrono_literals::operator""s;

Bytes OneByte(std::uint8_t value) {
  return std::make_shared<const std::vector<std::uint8_t>>(1, value);
}

class HubTest : public testing::Test {
 protected:
  Hub::ClientId Connect() {
    const Hub::ClientId client = hub.Connect();
    hub.session(client).Next();
    hub.session(client).Next();
    return client;
  }
  Hub::WantedChanges Subscribe(Hub::ClientId client, std::uint32_t channel) {
    hub.OnText(
        client,
        json{{"op", "subscribe"}, {"subscriptions", {{{"id", channel}, {"channelId", channel}}}}}.dump());
    return hub.TakeWantedChanges();
  }

  Hub hub{{.name = "thalweg",
           .session_id = "1",
           .with_time = false,
           .topics = {{"image", "a/msg/Image", "", false}, {"state", "a/msg/State", "", true}},
           .parameters = {},
           .surface_topic = "image"}};
};

TEST_F(HubTest, OffersEveryTopicAndItsOwnFourChannels) {
  Session& session = hub.session(hub.Connect());
  session.Next();
  const json channels = json::parse(session.Next()->head)["channels"];
  ASSERT_EQ(channels.size(), 6U);
  EXPECT_EQ(channels[0]["topic"], "/image");
  EXPECT_EQ(channels[1]["schemaName"], "a/msg/State");
  EXPECT_EQ(channels[2]["topic"], "/thalweg/blocks");
  EXPECT_EQ(channels[3]["topic"], "/thalweg/history");
  EXPECT_EQ(channels[4]["topic"], "/thalweg/map_points");
  EXPECT_EQ(channels[5]["topic"], "/thalweg/surface");
}

TEST_F(HubTest, TheSurfacesTopicIsWantedForItsOwnChannel) {
  constexpr std::uint32_t kSurfaceChannel = 6;
  const auto client = Connect();
  EXPECT_EQ(Subscribe(client, kSurfaceChannel).begun, std::vector<std::size_t>{0});
  EXPECT_FALSE(hub.surface_topic_wanted()) << "only the channel is";
  EXPECT_TRUE(Subscribe(client, 1).begun.empty()) << "it is wanted already";
  EXPECT_TRUE(hub.surface_topic_wanted());
  hub.Disconnect(client);
  hub.TakeWantedChanges(0s);
  EXPECT_EQ(hub.TakeWantedChanges(Hub::kLinger).ended, std::vector<std::size_t>{0});
}

TEST_F(HubTest, ClientsThatWantTheGraphGetItWholeAndThenItsChanges) {
  const auto client = Connect();
  const auto other = Connect();
  EXPECT_FALSE(hub.graph_wanted());
  hub.OnText(client, R"({"op":"subscribeConnectionGraph"})");
  EXPECT_TRUE(hub.graph_wanted());
  EXPECT_FALSE(hub.session(client).Next()) << "none is known yet";
  ConnectionGraph graph{{{"/odometry", {"simulator"}}}, {}, {}};
  const auto published = [](const std::optional<Frame>& frame) {
    return frame ? json::parse(frame->head)["publishedTopics"] : json("nothing");
  };
  hub.SetGraph(graph);
  EXPECT_EQ(published(hub.session(client).Next()).at(0)["name"], "/odometry");
  hub.SetGraph(graph);
  EXPECT_FALSE(hub.session(client).Next()) << "nothing has changed";
  graph.publishers["/clock"] = {"simulator"};
  hub.SetGraph(graph);
  graph.publishers["/path"] = {"explorer"};
  hub.SetGraph(graph);
  EXPECT_EQ(published(hub.session(client).Next()).size(), 2U) << "a slow client gets both at once";
  EXPECT_FALSE(hub.session(other).Next());

  hub.OnText(client, R"({"op":"unsubscribeConnectionGraph"})");
  EXPECT_FALSE(hub.graph_wanted());
  hub.OnText(client, R"({"op":"subscribeConnectionGraph"})");
  EXPECT_EQ(published(hub.session(client).Next()).size(), 3U) << "the whole again";
}

TEST_F(HubTest, ATopicIsWantedFromItsFirstClientToItsLast) {
  const auto first = Connect();
  const auto second = Connect();
  EXPECT_EQ(Subscribe(first, 2).begun, std::vector<std::size_t>{1});
  EXPECT_TRUE(Subscribe(second, 2).begun.empty());
  EXPECT_TRUE(Subscribe(second, 3).begun.empty());  // blocks are no topic
  hub.Disconnect(first);
  EXPECT_TRUE(hub.TakeWantedChanges(100s).ended.empty());
  hub.OnText(second, R"({"op":"unsubscribe","subscriptionIds":[2]})");
  EXPECT_TRUE(hub.TakeWantedChanges(200s).ended.empty());
  EXPECT_EQ(hub.TakeWantedChanges(200s + Hub::kLinger).ended, std::vector<std::size_t>{1});
  EXPECT_TRUE(hub.TakeWantedChanges(400s).ended.empty());
}

TEST_F(HubTest, AClientThatSubscribesAndUnsubscribesInTurnsOpensATopicOnce) {
  const auto client = Connect();
  std::size_t begun = 0;
  std::size_t ended = 0;
  for (Duration now = {}; now < 1000s; now += 1s) {
    hub.OnText(client, now / 1s % 2 == 0 ? R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})"
                                         : R"({"op":"unsubscribe","subscriptionIds":[1]})");
    const Hub::WantedChanges changes = hub.TakeWantedChanges(now);
    begun += changes.begun.size();
    ended += changes.ended.size();
  }
  EXPECT_EQ(begun, 1U);
  EXPECT_EQ(ended, 0U);
}

TEST_F(HubTest, ALateClientGetsTheLastStateButNoOldImage) {
  const auto early = Connect();
  Subscribe(early, 1);
  Subscribe(early, 2);
  hub.Publish(0, Time(), OneByte(1));
  hub.Publish(1, Time(), OneByte(2));
  const auto late = Connect();
  Subscribe(late, 1);
  Subscribe(late, 2);
  const std::optional<Frame> frame = hub.session(late).Next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->body->front(), 2);
  EXPECT_FALSE(hub.session(late).Next());
}

TEST(Hub, ALateClientGetsTheLastOfEachPartWhereSeveralPublishAState) {
  Hub hub({.name = "thalweg",
           .session_id = "1",
           .with_time = false,
           .topics = {{"tf_static", "a/msg/Transforms", "", true, 3}},
           .parameters = {}});
  const auto received = [&] {
    const Hub::ClientId client = hub.Connect();
    hub.OnText(client, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})");
    hub.TakeWantedChanges();
    std::vector<int> values;
    while (const std::optional<Frame> frame = hub.session(client).Next()) {
      if (frame->body) values.push_back(frame->body->front());
    }
    return values;
  };
  EXPECT_TRUE(received().empty());
  const auto publish = [&](std::uint8_t part, std::uint8_t value) {
    hub.Publish(0, Time(), OneByte(value), part);
  };
  publish(1, 10);
  publish(2, 20);
  publish(1, 11);
  EXPECT_EQ(received(), (std::vector<int>{20, 11}));
  for (std::uint8_t part = 3; part < 100; ++part) publish(part, part);
  EXPECT_EQ(received(), (std::vector<int>{97, 98, 99})) << "no more than may wait";
}

TEST_F(HubTest, AStateThatNobodyFollowedIsNotShownAsTheLast) {
  const auto early = Connect();
  Subscribe(early, 2);
  hub.Publish(1, Time(), OneByte(2));
  hub.Disconnect(early);
  hub.TakeWantedChanges();
  hub.TakeWantedChanges(Hub::kLinger);
  const auto late = Connect();
  Subscribe(late, 2);
  EXPECT_FALSE(hub.session(late).Next());
}

TEST_F(HubTest, OneSlowClientDoesNotAffectAnother) {
  const auto slow = Connect();
  const auto fast = Connect();
  Subscribe(slow, 1);
  Subscribe(fast, 1);
  for (std::uint8_t n = 0; n < 10; ++n) {
    hub.Publish(0, Time(), OneByte(n));
    EXPECT_EQ(hub.session(fast).Next()->body->front(), n);
  }
  EXPECT_EQ(hub.session(slow).Next()->body->front(), 9);
  EXPECT_EQ(hub.counts().replaced, 9U);
  hub.Disconnect(slow);
  EXPECT_EQ(hub.counts().replaced, 9U);
  EXPECT_EQ(hub.counts().clients, 1U);
}

TEST_F(HubTest, InvalidFramesOfClientsThatLeftRemainCounted) {
  const auto client = Connect();
  hub.OnText(client, "?");
  hub.OnBinary(client, {});
  hub.Disconnect(client);
  EXPECT_EQ(hub.counts().invalid_frames, 2U);
  EXPECT_EQ(hub.counts().last_invalid, "the binary frame is empty");
}

TEST_F(HubTest, TheStrategyIsAParameterThatFollowsTheExplorer) {
  const Hub::ClientId client = Connect();
  hub.OnText(client, R"({"op":"subscribeParameterUpdates","parameterNames":[]})");
  const auto reported = [&] {
    const std::optional<Frame> frame = hub.session(client).Next();
    return frame ? json::parse(frame->head)["parameters"] : json();
  };
  hub.SetStrategy("flow");
  EXPECT_EQ(reported(), json({{{"name", "explorer.strategy"}, {"value", "flow"}}}));
  hub.SetStrategy("flow");
  EXPECT_EQ(reported(), json());
  hub.SetStrategy("closest");
  EXPECT_EQ(reported(), json({{{"name", "explorer.strategy"}, {"value", "closest"}}}));
}

}  // namespace
}  // namespace thalweg::gateway
