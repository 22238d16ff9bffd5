#include "services/inspector/core/definitions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/inspector/core/schema.h"

namespace thalweg::inspector {
namespace {

using testing::HasSubstr;

std::optional<std::string> Nowhere(const std::string& /*package*/, const std::string& /*name*/) {
  return std::nullopt;
}

TEST(Definitions, JoinsATypeWithAllThatItContains) {
  const Definitions definitions(
      "MSG: a/Outer\nInner[] inner\nb/Other other\nMSG: a/Inner\nint32 n\nMSG: b/Other\nbool is\n");
  const auto text = definitions.Assemble("a/msg/Outer", Nowhere);
  ASSERT_TRUE(text) << text.error();
  const auto schema = Schema::Parse("a/msg/Outer", *text);
  ASSERT_TRUE(schema) << schema.error();
  ASSERT_EQ(schema->size(), 3U);
  EXPECT_EQ(schema->NameOf(schema->message(0).fields[0].type), "a/Inner[]");
  EXPECT_EQ(schema->NameOf(schema->message(0).fields[1].type), "b/Other");
}

TEST(Definitions, LeavesOutWhatTheWireDoesNotShow) {
  const std::string msg =
      "# A comment\n"
      "int32 KIND_A=1\n"
      "string  NAME = \"a b\"  # a constant\n"
      "\n"
      "  uint8 kind 2     # a default\n"
      "string<=10 label \"none\"\n"
      "float64[<=3] bounded\n"
      "string<=5[<=2] words\n"
      "byte[2] raw\n"
      "Header header\n"
      "geometry_msgs/msg/Point at\n";
  const Definitions definitions("MSG: std_msgs/Header\nuint32 n\nMSG: geometry_msgs/Point\nfloat64 x\n");
  const auto text =
      definitions.Assemble("my/msg/State", [&](const std::string& package, const std::string& name) {
        return package == "my" && name == "State" ? std::optional(msg) : std::nullopt;
      });
  ASSERT_TRUE(text) << text.error();
  EXPECT_EQ(
      text->substr(0, text->find('=')),
      "uint8 kind\nstring label\nfloat64[] bounded\nstring[] words\nuint8[2] raw\nstd_msgs/Header header\n"
      "geometry_msgs/Point at\n");
  EXPECT_TRUE(Schema::Parse("my/msg/State", *text));
}

TEST(Definitions, AMessageWithoutFieldsHasTheOctetThatIsSentForIt) {
  const auto text = Definitions("MSG: a/Nothing\nint8 ONE=1\n").Assemble("a/Nothing", Nowhere);
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, "uint8 structure_needs_at_least_one_member\n");
}

TEST(Definitions, NamesWhatIsMissingAndWhereItIsNeeded) {
  const Definitions definitions("MSG: a/Outer\nb/Gone gone\n");
  EXPECT_EQ(definitions.Assemble("b/msg/Gone", Nowhere).error(), "b/Gone is not defined");
  EXPECT_THAT(definitions.Assemble("a/Outer", Nowhere).error(),
              HasSubstr("b/Gone, which a/Outer contains, is not"));
  EXPECT_EQ(definitions.Assemble("no slash", Nowhere).error(), "no slash is not defined");
}

TEST(Definitions, EndsWithATypeThatContainsItself) {
  const auto text = Definitions("MSG: a/A\nA a\n").Assemble("a/A", Nowhere);
  ASSERT_TRUE(text);
  EXPECT_FALSE(Schema::Parse("a/A", *text));
}

TEST(Definitions, EndsWithAFolderThatNeverEnds) {
  int asked = 0;
  const auto endless = [&](const std::string& /*package*/, const std::string& /*name*/) {
    std::string text = "T";
    text += std::to_string(++asked);
    return std::optional(text + " next\n");
  };
  EXPECT_THAT(Definitions("").Assemble("a/T0", endless).error(), HasSubstr("more than 1000 types"));
}

}  // namespace
}  // namespace thalweg::inspector
