#include "common/dds/schema_generator/idl_model.h"

#include <gmock/gmock.h>

#include <stdexcept>

namespace thalweg::idl {
namespace {

std::string Inside(const std::string& declarations) {
  return "module a { module msg {\n" + declarations + "\n}; };\n";
}

/// The message definition of struct S.
std::string DefinitionOf(const std::string& declarations) {
  IdlModel model;
  model.Add("a.idl", Inside(declarations));
  return model.Ros2Msg("a/msg/S");
}

TEST(IdlModel, NumbersHaveTheNamesOfRos2) {
  EXPECT_EQ(
      DefinitionOf("struct S { boolean a; octet b; int8 c; short d; unsigned short e; long f; "
                   "unsigned long g; long long h; unsigned long long i; float j; double k; string l; };"),
      "bool a\nuint8 b\nint8 c\nint16 d\nuint16 e\nint32 f\nuint32 g\nint64 h\nuint64 i\nfloat32 j\n"
      "float64 k\nstring l\n");
}

TEST(IdlModel, SequencesAndArraysPutTheirBracketsBehindTheType) {
  EXPECT_EQ(DefinitionOf("struct S { sequence<unsigned long> a; double b[36]; };"),
            "uint32[] a\nfloat64[36] b\n");
}

TEST(IdlModel, AnEnumBecomesConstantsOnceAndNumbersOfFourBytes) {
  EXPECT_EQ(DefinitionOf("enum E { RED, GREEN };\nstruct S { E a; E b; sequence<E> c; };"),
            "uint32 RED=0\nuint32 GREEN=1\nuint32 a\nuint32 b\nuint32[] c\n");
}

TEST(IdlModel, CommentsStayWithWhatTheyDescribe) {
  EXPECT_EQ(DefinitionOf(R"(// far away

// What S is,
// in two lines.
struct S {  // and a third
  // above x
  long x;  // behind x
           // and on
  long y;
  // above z
  E z;  // behind z
};
enum E {
  RED,   // the first
  GREEN  // the last
};)"),
            "# What S is,\n# in two lines.\n# and a third\n# above x\nint32 x  # behind x and on\nint32 y\n"
            "# above z\nuint32 RED=0  # the first\nuint32 GREEN=1  # the last\nuint32 z  # behind z\n");
}

TEST(IdlModel, ContainedTypesFollowEachOnce) {
  IdlModel model;
  model.Add("b.idl",
            "#include \"a.idl\"\nmodule b { module msg {\n"
            "struct T { a::msg::U u; a::msg::U v; sequence<W> w; };\nstruct W { a::msg::U u; };\n}; };");
  model.Add("a.idl", Inside("struct U { long n; };"));
  const std::string line(80, '=');
  EXPECT_EQ(model.Ros2Msg("b/msg/T"),
            "a/U u\na/U v\nb/W[] w\n" + line + "\nMSG: a/U\nint32 n\n" + line + "\nMSG: b/W\na/U u\n");
  EXPECT_EQ(model.Structs(), (std::vector<std::string>{"a/msg/U", "b/msg/T", "b/msg/W"}));
}

// What rosidl hashes for std_msgs/msg/String.
TEST(IdlModel, DescribesAStructAsRos2Does) {
  IdlModel model;
  model.Add("std_msgs.idl", "module std_msgs { module msg { struct String { string data; }; }; };");
  EXPECT_EQ(model.Description("std_msgs/msg/String"),
            R"({"type_description": {"type_name": "std_msgs/msg/String", "fields": [{"name": "data", )"
            R"("type": {"type_id": 17, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}}]}, )"
            R"("referenced_type_descriptions": []})");
}

TEST(IdlModel, DescribesArraysSequencesAndContainedStructsInAlphabeticalOrder) {
  IdlModel model;
  model.Add("a.idl", Inside("struct Z { octet n; };\nstruct B { Z z; };\n"
                            "struct S { double x[9]; sequence<long> y; B b; sequence<Z> c; };"));
  const std::string description = model.Description("a/msg/S");
  for (const char* part :
       {R"("x", "type": {"type_id": 59, "capacity": 9,)", R"("y", "type": {"type_id": 150,)",
        R"("b", "type": {"type_id": 1, "capacity": 0, "string_capacity": 0, )"
        R"("nested_type_name": "a/msg/B"})",
        R"("c", "type": {"type_id": 145,)"}) {
    EXPECT_NE(description.find(part), std::string::npos) << part;
  }
  EXPECT_LT(description.find(R"({"type_name": "a/msg/B")"), description.find(R"({"type_name": "a/msg/Z")"));
}

TEST(IdlModel, DescribesNoStructThatHasAnEnumAnywhere) {
  IdlModel model;
  model.Add("a.idl", Inside("enum E { RED };\nstruct T { E e; };\nstruct S { sequence<T> t; };"));
  EXPECT_EQ(model.Description("a/msg/S"), "");
  EXPECT_EQ(model.Description("a/msg/T"), "");
}

TEST(IdlModel, WhatItDoesNotUnderstandIsNamedWithItsPlace) {
  const auto failure = [](const std::string& declarations) -> std::string {
    try {
      DefinitionOf(declarations);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(failure("union S { };"), "a.idl:2: expected struct or enum, found \"union\"");
  EXPECT_EQ(failure("struct S {\n  long x\n};"), "a.idl:4: expected \";\", found \"}\"");
  EXPECT_EQ(failure("struct S { };"), "a.idl:2: expected a field, found \"}\"");
  EXPECT_EQ(failure("struct S {\n  Missing m;\n};"), "a.idl:3: the type a/msg/Missing is not defined");
  EXPECT_EQ(failure("struct S { long x; };\nstruct S { long x; };"), "a.idl:3: a/msg/S is defined twice");
  EXPECT_EQ(failure("struct S { sequence<long> x[3]; };"),
            "a.idl:2: expected \";\": an array of sequences has no ROS 2 form, found \"[\"");
}

}  // namespace
}  // namespace thalweg::idl
