#include "services/gateway/core/protocol.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

namespace thalweg::gateway {
namespace {

template <class Request>
Request Parsed(std::string_view text) {
  const Result<ClientRequest> request = ParseText(text);
  EXPECT_TRUE(request) << text;
  EXPECT_TRUE(request && std::holds_alternative<Request>(*request)) << text;
  return request && std::holds_alternative<Request>(*request) ? std::get<Request>(*request) : Request{};
}

TEST(Protocol, RequestsAreReadAsTheSpecificationWritesThem) {
  const auto subscribe = Parsed<SubscribeRequest>(
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5}]})");
  ASSERT_EQ(subscribe.items.size(), 2U);
  EXPECT_EQ(subscribe.items[0].channel, 3U);
  EXPECT_EQ(subscribe.items[1].subscription, 4294967295U);
  EXPECT_EQ(Parsed<UnsubscribeRequest>(R"({"op":"unsubscribe","subscriptionIds":[1,2]})").subscriptions,
            (std::vector<std::uint32_t>{1, 2}));
  const auto get = Parsed<GetParametersRequest>(R"({"op":"getParameters","parameterNames":["a"],"id":"7"})");
  EXPECT_EQ(get.names, std::vector<std::string>{"a"});
  EXPECT_EQ(get.id, "7");
  EXPECT_EQ(Parsed<UnofferedRequest>(R"({"op":"fetchAsset"})").operation, "fetchAsset");
}

TEST(Protocol, AnInvalidFrameIsRefusedWithItsReason) {
  for (const char* text : {"",
                           "{",
                           "[]",
                           "7",
                           "null",
                           R"({"op":7})",
                           R"({})",
                           R"({"op":"subscribe"})",
                           "\xff\xfe",
                           R"({"op":"subscribe","subscriptions":{}})",
                           R"({"op":"subscribe","subscriptions":[7]})",
                           R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
                           R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})",
                           R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
                           R"({"op":"unsubscribe","subscriptionIds":["1"]})",
                           R"({"op":"getParameters","parameterNames":[1]})",
                           R"({"op":"subscribeParameterUpdates"})",
                           R"({"op":"unsubscribeParameterUpdates","parameterNames":[{}]})",
                           R"({"op":"setParameters"})",
                           R"({"op":"setParameters","parameters":[7]})",
                           R"({"op":"setParameters","parameters":[{"name":1,"value":1}]})"}) {
    const Result<ClientRequest> request = ParseText(text);
    ASSERT_FALSE(request) << text;
    EXPECT_FALSE(request.error().empty());
  }
  EXPECT_FALSE(ParseText(std::string(kMaxClientFrame + 1, ' ')));
  EXPECT_FALSE(ParseBinary({}));
  const std::vector<std::uint8_t> unknown = {99};
  EXPECT_FALSE(ParseBinary(unknown));
}

TEST(Protocol, DeepNestingIsHarmless) {
  const std::size_t depth = kMaxClientFrame / 2 - 20;
  EXPECT_FALSE(ParseText(std::string(depth, '[') + std::string(depth, ']')));
  EXPECT_TRUE(ParseText(R"({"op":"x","y":)" + std::string(depth, '[') + std::string(depth, ']') + "}"));
}

TEST(Protocol, RandomlyDamagedFramesAreReadOrRefused) {
  const std::string good =
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":3}],"id":"\u00e4","parameterNames":[]})";
  std::mt19937 random(7);
  int refused = 0;
  for (int n = 0; n < 20000; ++n) {
    std::string text = good;
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = static_cast<char>(random());
    refused += ParseText(text) ? 0 : 1;
  }
  EXPECT_GT(refused, 1000);
  EXPECT_LT(refused, 20000);
}

TEST(Protocol, AMessageHasTheClientsSubscriptionAndLittleEndianTime) {
  const auto body = std::make_shared<const std::vector<std::uint8_t>>(std::vector<std::uint8_t>{9});
  const Frame frame = MessageData(0x01020304, Time(Duration(0x1122334455667788)), body);
  EXPECT_TRUE(frame.binary);
  EXPECT_EQ(frame.head, "\x01\x04\x03\x02\x01\x88\x77\x66\x55\x44\x33\x22\x11");
  EXPECT_EQ(frame.body, body);
  EXPECT_EQ(frame.size(), 14U);
  EXPECT_EQ(TimeFrame(Time(Duration(1))).head, std::string("\x02\x01\0\0\0\0\0\0\0", 9));
}

TEST(Protocol, AnAdvertisementHoldsAllThatADecoderNeeds) {
  const auto frame =
      nlohmann::json::parse(Advertise({{4, "/a", "cdr", "p/msg/A", "int32 x\n", "ros2msg"}}).head);
  const nlohmann::json expected = {{"id", 4},
                                   {"topic", "/a"},
                                   {"encoding", "cdr"},
                                   {"schemaName", "p/msg/A"},
                                   {"schema", "int32 x\n"},
                                   {"schemaEncoding", "ros2msg"}};
  EXPECT_EQ(frame["op"], "advertise");
  EXPECT_EQ(frame["channels"], nlohmann::json::array({expected}));
}

TEST(Protocol, TimeIsAnnouncedOnlyByARunWithAClockOfItsOwn) {
  const auto with = nlohmann::json::parse(ServerInfo("a", "b", {.time = true}).head);
  const auto without = nlohmann::json::parse(ServerInfo("a", "b", {}).head);
  EXPECT_EQ(with["capabilities"],
            nlohmann::json({"parameters", "parametersSubscribe", "connectionGraph", "time"}));
  EXPECT_EQ(without["capabilities"],
            nlohmann::json::array({"parameters", "parametersSubscribe", "connectionGraph"}));
  EXPECT_EQ(with["sessionId"], "b");
}

TEST(Protocol, TextThatIsNotUtf8CanStillBeQuoted) {
  EXPECT_TRUE(nlohmann::json::accept(Status(StatusLevel::kError, "bad \xff name").head));
}

TEST(Protocol, ParametersKeepTheirTypes) {
  const auto frame = nlohmann::json::parse(ParameterValues({{"a", "0.5"}, {"b", "\"x\""}}, "q").head);
  EXPECT_EQ(frame["parameters"][0]["value"], 0.5);
  EXPECT_EQ(frame["parameters"][1]["value"], "x");
  EXPECT_EQ(frame["id"], "q");
  EXPECT_FALSE(nlohmann::json::parse(ParameterValues({}, "").head).contains("id"));
}

TEST(Protocol, AGraphsUpdateHoldsOnlyWhatHasChanged) {
  using nlohmann::json;
  const auto update = [](const ConnectionGraph& before, const ConnectionGraph& now) {
    return json::parse(ConnectionGraphUpdate(before, now).head);
  };
  const ConnectionGraph first = {{{"/odometry", {"simulator"}}, {"/clock", {"simulator"}}},
                                 {{"/odometry", {"explorer", "mapper"}}},
                                 {{"/operator/pause", {"gateway"}}}};
  const json whole = update({}, first);
  EXPECT_EQ(whole["op"], "connectionGraphUpdate");
  EXPECT_EQ(whole["publishedTopics"], json::parse(R"([{"name":"/clock","publisherIds":["simulator"]},
                                                      {"name":"/odometry","publisherIds":["simulator"]}])"));
  EXPECT_EQ(whole["subscribedTopics"],
            json::parse(R"([{"name":"/odometry","subscriberIds":["explorer","mapper"]}])"));
  EXPECT_EQ(whole["advertisedServices"],
            json::parse(R"([{"name":"/operator/pause","providerIds":["gateway"]}])"));
  EXPECT_TRUE(whole["removedTopics"].empty());

  // The simulator ends, so that only readers of its odometry remain.
  const ConnectionGraph second = {{}, first.subscribers, {}};
  const json ended = update(first, second);
  EXPECT_EQ(ended["publishedTopics"], json::parse(R"([{"name":"/odometry","publisherIds":[]}])"));
  EXPECT_TRUE(ended["subscribedTopics"].empty());
  EXPECT_EQ(ended["removedTopics"], json::array({"/clock"}));
  EXPECT_EQ(ended["removedServices"], json::array({"/operator/pause"}));
  EXPECT_EQ(update(second, {})["removedTopics"], json::array({"/odometry"}));
}

}  // namespace
}  // namespace thalweg::gateway
