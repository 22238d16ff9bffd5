#include "services/inspector/core/yaml.h"

#include <gmock/gmock.h>

#include <cmath>

#include "common/base/text.h"
#include "common/dds/topic_table.h"
#include "services/inspector/core/cdr.h"
#include "tests/services/inspector/core/known_schema.h"
#include "tests/services/inspector/core/random_value.h"

namespace thalweg::inspector {
namespace {

using testing::HasSubstr;

constexpr Time kNow{std::chrono::nanoseconds(1'700'000'000'250'000'000)};

Result<Value> Parsed(const Schema& schema, const std::string& text) {
  return ParseYaml(schema, text, kNow);
}

std::string Printed(const Schema& schema, const Value& value) {
  return ToYaml(schema, schema.root(), value);
}

TEST(Yaml, EverythingThatAMessageCanHoldIsPrintedAndParsedBack) {
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    const Schema schema = SchemaOf(dds::Ros2TypeName(topic.type_name));
    for (unsigned seed = 0; seed < 10; ++seed) {
      const Value value = RandomValue(schema, seed).Make(schema.root());
      const std::string text = ToYaml(schema, schema.root(), value, PrintOptions::Everything());
      const auto parsed = Parsed(schema, text);
      ASSERT_TRUE(parsed) << topic.name << ", seed " << seed << ": " << parsed.error();
      // By bytes, since a NaN is not equal to itself.
      ASSERT_EQ(EncodeCdr(schema, *parsed), EncodeCdr(schema, value)) << topic.name << ", seed " << seed;
    }
  }
}

TEST(Yaml, NothingThatIsPrintedCommandsATerminal) {
  const Schema schema = *Schema::Parse("a/msg/A", "string text\n");
  for (unsigned seed = 0; seed < 2000; ++seed) {
    const std::string text = Printed(schema, RandomValue(schema, seed).Make(schema.root()));
    EXPECT_EQ(CleanText(text, text.size()) + '\n', text.substr(0, text.size() - 1) + " \n") << seed;
  }
}

TEST(Yaml, IsLaidOutAsRos2TopicEchoPrintsIt) {
  const Schema schema = SchemaOf("nav_msgs/msg/Path");
  const auto path = Parsed(schema,
                           "{header: {stamp: {sec: 12, nanosec: 5}, frame_id: map},"
                           " poses: [{pose: {position: {x: 1, y: -2.5}}}]}");
  ASSERT_TRUE(path) << path.error();
  EXPECT_EQ(Printed(schema, *path),
            "header:\n  stamp:\n    sec: 12\n    nanosec: 5\n  frame_id: map\n"
            "poses:\n- header:\n    stamp:\n      sec: 0\n      nanosec: 0\n    frame_id: ''\n"
            "  pose:\n    position:\n      x: 1.0\n      y: -2.5\n      z: 0.0\n"
            "    orientation:\n      x: 0.0\n      y: 0.0\n      z: 0.0\n      w: 0.0\n");
}

TEST(Yaml, NumbersAndTextsKeepTheirTypesForEveryReader) {
  EXPECT_EQ(YamlNumber(1.0), "1.0");
  EXPECT_EQ(YamlNumber(1e-7), "1.0e-07");
  EXPECT_EQ(YamlNumber(0.1F), "0.1");
  EXPECT_EQ(YamlNumber(-0.0), "-0.0");
  EXPECT_EQ(YamlNumber(std::nan("")), ".nan");
  EXPECT_EQ(YamlNumber(-std::numeric_limits<float>::infinity()), "-.inf");
  const Schema schema = *Schema::Parse("a/msg/A", "string t\n");
  const auto printed = [&](const std::string& text) { return Printed(schema, {std::vector<Value>{{text}}}); };
  EXPECT_EQ(printed("base_link"), "t: base_link\n");
  EXPECT_EQ(printed("No"), "t: 'No'\n");
  EXPECT_EQ(printed("12"), "t: '12'\n");
  EXPECT_EQ(printed("it's: so"), "t: 'it''s: so'\n");
  EXPECT_EQ(printed("\x1b[2J\n"), "t: \"\\x1b[2J\\n\"\n");
  EXPECT_EQ(printed("\xff"), "t: !!binary \"/w==\"\n");
}

TEST(Yaml, LongArraysAreCutOrOnlyNamed) {
  const Schema schema = *Schema::Parse("a/msg/A", "uint8[] data\n");
  Numbers numbers(Kind::kUint8);
  numbers.bytes() = {7, 8, 9};
  const Value value{std::vector<Value>{{numbers}}};
  EXPECT_EQ(ToYaml(schema, schema.root(), value, {.most_elements = 2}),
            "data:\n- 7\n- 8\n- '... 1 more of 3'\n");
  EXPECT_EQ(ToYaml(schema, schema.root(), value, {.arrays = false}),
            "data: '<sequence type: uint8, length: 3>'\n");
}

TEST(Yaml, PartsAreWrittenInFlowStyleAndTheRestIsZero) {
  const Schema twist = SchemaOf("geometry_msgs/msg/Twist");
  const auto value = Parsed(twist, "linear: {x: 0.5}");
  ASSERT_TRUE(value) << value.error();
  EXPECT_THAT(Printed(twist, *value), HasSubstr("linear:\n  x: 0.5\n  y: 0.0\n"));
  EXPECT_EQ(Printed(twist, *Parsed(twist, "")), Printed(twist, ZeroOf(twist, twist.root())));
}

TEST(Yaml, AStampMayBeNowAndAStateHaveItsName) {
  const Schema schema = SchemaOf("thalweg_msgs/msg/OperatorCommand");
  const auto value = Parsed(schema, "{header: {stamp: now}, kind: COMMAND_GOTO}");
  ASSERT_TRUE(value) << value.error();
  EXPECT_THAT(Printed(schema, *value), HasSubstr("sec: 1700000000\n    nanosec: 250000000\n"));
  EXPECT_THAT(Printed(schema, *value), HasSubstr("kind: 5\n"));
}

TEST(Yaml, MistakesAreNamedWithTheirField) {
  const Schema path = SchemaOf("nav_msgs/msg/Path");
  const auto mistake = [&](const std::string& text) { return Parsed(path, text).error(); };
  EXPECT_EQ(mistake("{poses: [{pose: {position: {x: one}}}]}"),
            "poses[0].pose.position.x: \"one\" is no float64");
  EXPECT_EQ(mistake("{head: 1}"), "a nav_msgs/Path has no field \"head\"; its fields are header, poses");
  EXPECT_EQ(mistake("{header: {stamp: {nanosec: -1}}}"), "header.stamp.nanosec: \"-1\" is no uint32");
  EXPECT_EQ(mistake("{poses: 3}"), "poses: must be a list");
  EXPECT_EQ(mistake("3"), "must hold the fields of a nav_msgs/Path");
  EXPECT_THAT(mistake("{poses: ["), HasSubstr("not YAML: "));
  const Schema camera = SchemaOf("sensor_msgs/msg/CameraInfo");
  EXPECT_EQ(Parsed(camera, "{k: [1, 2]}").error(), "k: has 2 elements, must have 9");
}

}  // namespace
}  // namespace thalweg::inspector
