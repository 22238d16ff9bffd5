#include "services/inspector/core/field_path.h"

#include <gtest/gtest.h>

#include "common/dds/schema.h"
#include "services/inspector/core/yaml.h"

namespace thalweg::inspector {
namespace {

class FieldPathTest : public testing::Test {
 protected:
  std::string Shown(const std::string& path) const {
    const auto field = FieldPath::Parse(schema_, path);
    if (!field) return field.error();
    const auto part = field->In(message_);
    return part ? ToYaml(schema_, field->type(), *part) : part.error();
  }

  Schema schema_ = *Schema::Parse("nav_msgs/msg/Odometry", dds::Ros2MsgSchema("nav_msgs/msg/Odometry"));
  Value message_ =
      *ParseYaml(schema_, "{header: {frame_id: odom}, pose: {pose: {position: {x: 1.5, z: 2}}}}", {});
};

TEST_F(FieldPathTest, LeadsToAFieldAnElementOrAWholePart) {
  EXPECT_EQ(Shown("header.frame_id"), "odom\n");
  EXPECT_EQ(Shown("pose.pose.position"), "x: 1.5\ny: 0.0\nz: 2.0\n");
  EXPECT_EQ(Shown("pose.covariance[35]"), "0.0\n");
  EXPECT_EQ(Shown("").substr(0, 8), "header:\n");
}

TEST_F(FieldPathTest, AFieldThatIsNotThereIsNamedWithThoseThatAre) {
  EXPECT_EQ(Shown("pose.position"),
            "a geometry_msgs/PoseWithCovariance has no field \"position\"; its fields are pose, covariance");
  EXPECT_EQ(Shown("pose.covariance[36]"), "field \"pose.covariance\" has 36 elements, no [36]");
  EXPECT_EQ(Shown("pose[0]"), "field \"pose\" is one value, not a list");
  EXPECT_EQ(Shown("pose.covariance.x"),
            "field \"pose.covariance\" is a list; name an element of it, as in pose.covariance[0]");
  EXPECT_EQ(Shown("pose.covariance[x]"), "field \"pose.covariance\": expected [NUMBER], found \"[x]\"");
  EXPECT_EQ(Shown("header.frame_id.x"), "field \"header.frame_id\" has no fields of its own");
}

TEST(FieldPath, AnElementBehindTheEndOfASequenceIsNamed) {
  const Schema schema = *Schema::Parse("nav_msgs/msg/Path", dds::Ros2MsgSchema("nav_msgs/msg/Path"));
  const auto field = FieldPath::Parse(schema, "poses[2].pose");
  ASSERT_TRUE(field);
  EXPECT_EQ(field->In(ZeroOf(schema, schema.root())).error(),
            "poses[2]: the message has only 0 elements there");
}

}  // namespace
}  // namespace thalweg::inspector
