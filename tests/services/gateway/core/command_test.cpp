#include "services/gateway/core/command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace thalweg::gateway {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr CommandGroup kOperator = CommandGroup::kOperator;
constexpr CommandGroup kReplay = CommandGroup::kReplay;

const CommandService& Service(std::string_view name, CommandGroup group = kOperator) {
  for (const CommandService& service : CommandServices()) {
    if (service.name == name && service.group() == group) return service;
  }
  throw std::invalid_argument("no such service");
}

TEST(Command, ARequestHoldsWhatItsServiceNeeds) {
  const auto go = ParseRequest(Service("goto"), R"({"point":{"x":1,"y":-2,"z":1.25},"yaw_rad":0.5})");
  ASSERT_TRUE(go) << go.error();
  EXPECT_EQ(go->kind, CommandKind::kGoTo);
  EXPECT_EQ(go->point, (std::array<double, 3>{1.0, -2.0, 1.25}));
  EXPECT_EQ(go->yaw_rad, 0.5);
  const auto box =
      ParseRequest(Service("no_go"), R"({"point":{"x":0,"y":0,"z":0},"corner":{"x":1,"y":2,"z":3}})");
  ASSERT_TRUE(box) << box.error();
  EXPECT_EQ(box->corner, (std::array<double, 3>{1.0, 2.0, 3.0}));
  EXPECT_TRUE(ParseRequest(Service("pause"), ""));
  const auto any_heading = ParseRequest(Service("goto"), R"({"point":{"x":1,"y":2,"z":1},"yaw_rad":null})");
  ASSERT_TRUE(any_heading);
  EXPECT_TRUE(std::isnan(any_heading->yaw_rad));
}

TEST(Command, AMessageNamesItsKindByNameOrNumber) {
  const auto by_name = ParseCommand(kOperator, R"({"kind":"strategy","strategy":"flow"})");
  const auto by_number = ParseCommand(kOperator, R"({"kind":10,"strategy":"flow"})");
  ASSERT_TRUE(by_name) << by_name.error();
  ASSERT_TRUE(by_number) << by_number.error();
  EXPECT_EQ(by_name->kind, CommandKind::kStrategy);
  EXPECT_EQ(by_number->kind, CommandKind::kStrategy);
  EXPECT_EQ(by_name->strategy, "flow");
}

TEST(Command, WhatIsWrongIsNamed) {
  const auto reason = [](std::string_view text) {
    const auto command = ParseCommand(kOperator, text);
    return command ? std::string("accepted") : command.error();
  };
  EXPECT_NE(reason("pause").find("not a JSON object"), std::string::npos);
  for (const char* text : {"{}", R"({"kind":"fly"})", R"({"kind":12})", R"({"kind":-1})", R"({"kind":null})"})
    EXPECT_NE(reason(text).find("\"kind\" must be"), std::string::npos) << text;
  for (const char* text :
       {R"({"kind":"goto"})", R"({"kind":"goto","point":[1,2,3]})",
        R"({"kind":"goto","point":{"x":1,"y":2}})", R"({"kind":"goto","point":{"x":1,"y":2,"z":"3"}})"})
    EXPECT_NE(reason(text).find("\"point\" must be"), std::string::npos) << text;
  EXPECT_NE(reason(R"({"kind":"no_go","point":{"x":1,"y":2,"z":3}})").find("\"corner\" must be"),
            std::string::npos);
  EXPECT_NE(reason(R"({"kind":"strategy","strategy":7})").find("\"strategy\" must be"), std::string::npos);
  EXPECT_NE(reason(R"({"kind":"strategy","strategy":")" + std::string(65, 'x') + "\"}").find("64"),
            std::string::npos);
}

TEST(Command, AReplayIsSoughtByTheTimeSinceItsBeginningOrByTheLogTime) {
  const CommandService& seek = Service("seek", kReplay);
  EXPECT_EQ(NameOf(seek), "/replay/seek");
  const auto since = ParseRequest(seek, R"({"time_s":12.5})");
  ASSERT_TRUE(since) << since.error();
  EXPECT_EQ(std::get<Duration>(since->time), 12500ms);
  const auto at = ParseCommand(kReplay, R"({"kind":"seek","time":{"sec":1700000000,"nanosec":250000000}})");
  ASSERT_TRUE(at) << at.error();
  EXPECT_EQ(at->kind, CommandKind::kReplaySeek);
  EXPECT_EQ(std::get<Time>(at->time), Time(1700000000s + 250ms));
  for (const char* text : {"{}", R"({"time_s":"1"})", R"({"time_s":1e300})", R"({"time":5})",
                           R"({"time":{"sec":-1,"nanosec":0}})", R"({"time":{"sec":1,"nanosec":1e9}})",
                           R"({"time_s":null,"time":{"sec":1,"nanosec":0}})"}) {
    const auto wrong = ParseRequest(seek, text);
    ASSERT_FALSE(wrong) << text;
    EXPECT_NE(wrong.error().find("\"time_s\""), std::string::npos) << text;
  }
}

TEST(Command, TheSameNameAndNumberMeanAnotherThingToAReplay) {
  EXPECT_EQ(ParseCommand(kReplay, R"({"kind":"pause"})")->kind, CommandKind::kReplayPause);
  EXPECT_EQ(ParseCommand(kOperator, R"({"kind":"pause"})")->kind, CommandKind::kPause);
  const auto rate = ParseCommand(kReplay, R"({"kind":3,"rate":0.25})");
  ASSERT_TRUE(rate) << rate.error();
  EXPECT_EQ(rate->kind, CommandKind::kReplayRate);
  EXPECT_EQ(rate->rate, 0.25);
  EXPECT_FALSE(ParseCommand(kReplay, R"({"kind":"rate"})"));
  EXPECT_FALSE(ParseCommand(kReplay, R"({"kind":4})"));
  EXPECT_FALSE(ParseCommand(kReplay, R"({"kind":"home"})"));
  EXPECT_FALSE(ParseCommand(kOperator, R"({"kind":"seek","time_s":1})"));
}

TEST(Command, SchemasDescribeExactlyWhatIsRead) {
  for (const CommandService& service : CommandServices()) {
    const auto schema = nlohmann::json::parse(RequestSchema(service));
    nlohmann::json request = nlohmann::json::object();
    for (const auto& [name, type] : schema["properties"].items()) {
      if (name == "time") continue;  // instead of time_s
      if (type["type"] == "object") request[name] = {{"x", 1.0}, {"y", 2.0}, {"z", 3.0}};
      if (type["type"] == "number") request[name] = 0.5;
      if (type["type"] == "string") request[name] = "text";
    }
    EXPECT_TRUE(ParseRequest(service, request.dump())) << service.name;
    for (const auto& required : schema["required"]) {
      nlohmann::json without = request;
      without.erase(required.get<std::string>());
      EXPECT_FALSE(ParseRequest(service, without.dump())) << service.name << " without " << required;
    }
  }
}

}  // namespace
}  // namespace thalweg::gateway
