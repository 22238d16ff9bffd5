#include "common/dds/schema.h"

#include <gmock/gmock.h>

#include "common/dds/topic_table.h"

namespace thalweg::dds {
namespace {

TEST(Schema, EveryTopicHasOne) {
  ASSERT_FALSE(AllTopics().empty());
  for (const TopicInfo& topic : AllTopics()) {
    EXPECT_FALSE(Ros2MsgSchema(Ros2TypeName(topic.type_name)).empty()) << topic.name;
  }
  EXPECT_TRUE(Ros2MsgSchema("sensor_msgs/msg/LaserScan").empty());
}

// The text of ROS 2's std_msgs/msg/Header, but for its comments.
TEST(Schema, ThatOfAHeaderIsThatOfRos2) {
  EXPECT_EQ(Ros2MsgSchema("std_msgs/msg/Header"),
            "builtin_interfaces/Time stamp  # time of the measurement; for an image, start of exposure\n"
            "string frame_id  # frame of the data: map, odom, base_link, camera_optical_frame\n" +
                std::string(80, '=') +
                "\nMSG: builtin_interfaces/Time\n"
                "int32 sec  # [s] since the epoch of the run's clock\n"
                "uint32 nanosec  # [ns] 0 to 999 999 999\n");
}

TEST(Schema, NamesOfTypesAreConvertedBothWays) {
  EXPECT_EQ(Ros2TypeName("sensor_msgs::msg::dds_::PointCloud2_"), "sensor_msgs/msg/PointCloud2");
  EXPECT_EQ(WireTypeName("sensor_msgs/msg/PointCloud2"), "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_EQ(Ros2TypeName("Strange"), "Strange");
  EXPECT_EQ(WireTypeName("Strange"), "Strange");
}

}  // namespace
}  // namespace thalweg::dds
