#include "services/inspector/core/schema.h"

#include <gtest/gtest.h>

#include "common/dds/schema.h"
#include "common/dds/topic_table.h"

namespace thalweg::inspector {
namespace {

TEST(InspectorSchema, ThoseOfAllTopicsAreUnderstood) {
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    const std::string type = dds::Ros2TypeName(topic.type_name);
    const auto schema = Schema::Parse(type, dds::Ros2MsgSchema(type));
    ASSERT_TRUE(schema) << schema.error();
    EXPECT_FALSE(schema->message(0).fields.empty());
  }
}

TEST(InspectorSchema, AFieldKeepsItsTypeLengthAndConstants) {
  const auto schema = Schema::Parse("a/msg/A",
                                    "# comment\nuint32 OFF=0  # none\nuint32 ON=1\nuint32 state  # which\n"
                                    "b/B[3] parts\nfloat32[] numbers\n========\nMSG: b/B\nstring name\n");
  ASSERT_TRUE(schema) << schema.error();
  const MessageType& a = schema->message(0);
  EXPECT_EQ(a.name, "a/A");
  ASSERT_EQ(a.fields.size(), 3U);
  ASSERT_EQ(a.fields[0].constants.size(), 2U);
  EXPECT_EQ(a.fields[0].constants[1].name, "ON");
  EXPECT_EQ(a.fields[0].constants[1].value, 1U);
  EXPECT_EQ(schema->NameOf(a.fields[1].type), "b/B[3]");
  EXPECT_TRUE(a.fields[1].constants.empty());
  EXPECT_EQ(schema->NameOf(a.fields[2].type), "float32[]");
  EXPECT_EQ(schema->message(a.fields[1].type).fields[0].name, "name");
}

TEST(InspectorSchema, WhatIsNotADefinitionIsRefusedWithItsLine) {
  const auto mistake = [](const std::string& text) { return Schema::Parse("a/msg/A", text).error(); };
  EXPECT_EQ(mistake(""), "the definition of a/msg/A: a/A has no fields");
  EXPECT_EQ(mistake("int32 x\nnonsense\n"), "the definition of a/msg/A: line 2: expected a type and a name");
  EXPECT_EQ(mistake("b/B x\n"), "the definition of a/msg/A: a/A.x: the type b/B is not defined");
  EXPECT_EQ(mistake("b/B x\n=\nMSG: b/B\na/A y\n"), "the definition of a/msg/A: a/A contains itself");
  EXPECT_EQ(mistake("int32[0] x\n"),
            "the definition of a/msg/A: line 1: \"0\" is not the length of an array");
  EXPECT_EQ(mistake("int32[<=4] x\n"),
            "the definition of a/msg/A: line 1: \"<=4\" is not the length of an array");
}

/// A type with this many levels of types below it, each of which holds the next one twice.
std::string Nested(int levels) {
  std::string text;
  for (int level = 0; level < levels; ++level) {
    const std::string next = "a/L" + std::to_string(level + 1);
    text += next + " x\n" + next + " y\n=====\nMSG: " + next + "\n";
  }
  return text + "int32 x\n";
}

TEST(InspectorSchema, TypesAreNotNestedDeeperThanIsReadByRecursion) {
  EXPECT_TRUE(Schema::Parse("a/msg/A", Nested(64)));
  EXPECT_EQ(Schema::Parse("a/msg/A", Nested(65)).error(),
            "the definition of a/msg/A: types are nested deeper than 64");
  EXPECT_FALSE(Schema::Parse("a/msg/A", Nested(20'000)));
  // The same types, once near enough and once a level too deep.
  const std::string from_l2 = Nested(64).substr(Nested(64).find("a/L2"));
  const std::string l1 = "====\nMSG: a/L1\n" + from_l2;
  EXPECT_TRUE(Schema::Parse("a/msg/A", "a/L1 x\n" + l1));
  EXPECT_FALSE(Schema::Parse("a/msg/A", "a/L1 x\na/B y\n====\nMSG: a/B\na/L1 x\n" + l1));
}

}  // namespace
}  // namespace thalweg::inspector
