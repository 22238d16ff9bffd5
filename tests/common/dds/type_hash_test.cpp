#include "common/dds/type_hash.h"

#include <gtest/gtest.h>

#include "common/dds/topic_table.h"

namespace thalweg::dds {
namespace {

// As the ROS 2 distributions from Iron on publish them.
TEST(TypeHash, IsThatOfRos2) {
  EXPECT_EQ(TypeHash("sensor_msgs::msg::dds_::Image_"),
            "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47");
  EXPECT_EQ(TypeHash("sensor_msgs::msg::dds_::PointCloud2_"),
            "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5");
  EXPECT_EQ(TypeHash("tf2_msgs::msg::dds_::TFMessage_"),
            "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
  EXPECT_EQ(TypeHash("nav_msgs::msg::dds_::Odometry_"),
            "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0");
}

TEST(TypeHash, EachStandardTypeOfTheTableHasOne) {
  for (const TopicInfo& topic : AllTopics()) {
    if (topic.type_name.starts_with("thalweg_msgs")) continue;
    EXPECT_EQ(TypeHash(topic.type_name).size(), 7U + 64U) << topic.type_name;
  }
}

TEST(TypeHash, IsEmptyForWhatRos2CannotDescribe) {
  EXPECT_EQ(TypeHash("thalweg_msgs::msg::dds_::ExplorationStatus_"), "") << "it has an enum";
  EXPECT_EQ(TypeHash("a::msg::dds_::Unknown_"), "");
}

}  // namespace
}  // namespace thalweg::dds
