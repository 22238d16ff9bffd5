#include "services/inspector/core/cdr.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <tuple>

#include "common/dds/topic_table.h"
#include "tests/services/inspector/core/known_schema.h"
#include "tests/services/inspector/core/random_value.h"

namespace thalweg::inspector {
namespace {

using testing::HasSubstr;

/// Calls check(topic's type) for each topic of the system.
template <class... Topics, class Check>
void ForEachTopic(const std::tuple<Topics...>*, Check&& check) {
  (check(Topics{}), ...);
}

// The oracle is the code that fastddsgen makes from the same IDL.
TEST(Cdr, EncodesAndDecodesEveryTypeOfTheTableAsFastCdrDoes) {
  int compared = 0;
  ForEachTopic(static_cast<const dds::topics::All*>(nullptr), [&]<class Topic>(Topic) {
    const Schema schema = SchemaOf(dds::Ros2TypeName(dds::InfoOf<Topic>().type_name));
    for (unsigned seed = 0; seed < 40; ++seed) {
      RandomValue random(schema, seed);
      random.zero_bytes = false;
      Value value = random.Make(schema.root());
      const auto bytes = EncodeCdr(schema, value);
      const auto message = dds::Decode<Topic>(bytes);
      // An enum of the IDL holds its own values only, and fastddsgen's code refuses no other.
      ASSERT_TRUE(message) << Topic::kName << ", seed " << seed;
      EXPECT_EQ(dds::Encode<Topic>(*message), bytes) << Topic::kName << ", seed " << seed;
      ++compared;
    }
  });
  EXPECT_GT(compared, 1000);
}

TEST(Cdr, WhatWasEncodedIsDecodedToTheSameBytes) {
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    const Schema schema = SchemaOf(dds::Ros2TypeName(topic.type_name));
    for (unsigned seed = 0; seed < 20; ++seed) {
      const auto bytes = EncodeCdr(schema, RandomValue(schema, seed).Make(schema.root()));
      const auto value = DecodeCdr(schema, bytes);
      ASSERT_TRUE(value) << topic.name << ": " << value.error();
      EXPECT_EQ(EncodeCdr(schema, *value), bytes) << topic.name << ", seed " << seed;
    }
  }
}

TEST(Cdr, BigEndianIsReadAsWell) {
  const Schema schema = *Schema::Parse("a/msg/A", "uint16 x\nfloat64[] y\nstring z\n");
  const std::vector<std::uint8_t> big = {0,    0,    0, 0,              // header
                                         1,    2,    0, 0, 0, 0, 0, 1,  // x, padding, one y
                                         0x3F, 0xF8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 'h', 'i', 0};
  const auto value = DecodeCdr(schema, big);
  ASSERT_TRUE(value) << value.error();
  EXPECT_EQ(value->values()[0].number(), Number(std::uint64_t{0x0102}));
  EXPECT_EQ(value->values()[1].numbers().At(0), Number(1.5));
  EXPECT_EQ(value->values()[2].text(), "hi");
}

TEST(Cdr, EveryMessageThatIsCutOffIsRefusedWithItsField) {
  const Schema schema = SchemaOf("thalweg_msgs/msg/FrontierList");
  RandomValue random(schema, 3);
  Value value = random.Make(schema.root());
  while (value.values()[2].size() < 3) value = random.Make(schema.root());
  const auto bytes = EncodeCdr(schema, value);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto cut = DecodeCdr(schema, std::span(bytes).first(size));
    ASSERT_FALSE(cut) << size;
    EXPECT_FALSE(cut.error().empty());
  }
  EXPECT_THAT(DecodeCdr(schema, std::span(bytes).first(bytes.size() - 1)).error(), HasSubstr(".doubtful: "));
}

TEST(Cdr, ALengthBeyondTheBytesThatAreLeftIsRefusedBeforeItCostsMemory) {
  const Schema schema = *Schema::Parse(
      "a/msg/A", "string name\nfloat64[] numbers\na/B[] parts\n================\nMSG: a/B\nbool b\n");
  const std::vector<std::uint8_t> long_text = {0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF};
  EXPECT_EQ(DecodeCdr(schema, long_text).error(),
            "name: its length of 4294967295 bytes is more than the 0 that are left");
  const std::vector<std::uint8_t> long_list = {0, 1, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 1, 2, 3, 4};
  EXPECT_EQ(DecodeCdr(schema, long_list).error(),
            "numbers: its 4294967295 elements do not fit into the 4 bytes that are left");
  const std::vector<std::uint8_t> bad_bool = {0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 1, 7};
  EXPECT_EQ(DecodeCdr(schema, bad_bool).error(), "parts[1].b: a bool is neither 0 nor 1");
}

TEST(Cdr, BytesBehindTheEndOrOfAnotherRepresentationAreRefused) {
  const Schema schema = *Schema::Parse("a/msg/A", "uint32 x\n");
  EXPECT_TRUE(DecodeCdr(schema, std::vector<std::uint8_t>{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0}));  // padding
  EXPECT_EQ(DecodeCdr(schema, std::vector<std::uint8_t>{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}).error(),
            "4 bytes follow the end of a a/A: the writer's type has other fields");
  EXPECT_EQ(DecodeCdr(schema, std::vector<std::uint8_t>{0, 7, 0, 0, 1, 0, 0, 0}).error(),
            "its representation is 7, neither 0 nor 1 (plain CDR)");
  EXPECT_EQ(DecodeCdr(schema, std::vector<std::uint8_t>{0, 1}).error(), "it has no encapsulation header");
}

TEST(Cdr, OneByteBoolsThatStandForMillionsOfValuesAreRefused) {
  const Schema schema = *Schema::Parse("a/msg/A", "a/B[] parts\n==\nMSG: a/B\nbool b\n");
  std::vector<std::uint8_t> bytes(4 + 4 + (8U << 20));
  bytes[1] = 1;
  bytes[6] = 0x80;  // 8 Mi elements
  EXPECT_THAT(DecodeCdr(schema, bytes).error(), HasSubstr("too many values"));
}

}  // namespace
}  // namespace thalweg::inspector
