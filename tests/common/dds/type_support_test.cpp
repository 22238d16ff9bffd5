#include "common/dds/type_support.h"

#include <gtest/gtest.h>

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <stdexcept>

namespace thalweg::dds {
namespace {

/// A topic of another project, whose type no topic of ours has.
struct Wind {
  using Message = geometry_msgs::msg::Vector3;
  static TypeSupport NewTypeSupport() {
    auto support = TypeSupportOf<topics::PoseCommand>();
    support->setName("my_msgs::msg::dds_::Wind_");
    return support;
  }
};

TEST(TypeSupport, OfEachTopicIsNamedAsItsMessageIsOnTheWire) {
  EXPECT_EQ(NameOf(TypeSupportOf<topics::DepthPoints>()), "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_EQ(NameOf(TypeSupportOf<topics::MapUpdates>()), "thalweg_msgs::msg::dds_::MapUpdate_");
}

TEST(TypeSupport, DecodesWhatItEncodesAndNothingElse) {
  const TypeSupport support = NewTypeSupport(typeid(geometry_msgs::msg::PoseStamped));
  geometry_msgs::msg::PoseStamped pose;
  pose.header().frame_id("map");
  pose.pose().position().x(1.5);
  const std::vector<std::uint8_t> sample = EncodeSample(support, &pose);
  geometry_msgs::msg::PoseStamped decoded;
  ASSERT_TRUE(DecodeSample(support, sample, &decoded));
  EXPECT_EQ(decoded, pose);
  EXPECT_FALSE(DecodeSample(support, std::span(sample).first(sample.size() / 2), &decoded));
  EXPECT_FALSE(DecodeSample(support, {}, &decoded));
}

TEST(TypeSupport, IsMissingForATypeThatNoTopicHasUnlessATopicBringsIt) {
  EXPECT_THROW(NewTypeSupport(typeid(geometry_msgs::msg::Vector3)), std::logic_error);
  EXPECT_EQ(NameOf(TypeSupportOf<Wind>()), "my_msgs::msg::dds_::Wind_");
}

}  // namespace
}  // namespace thalweg::dds
