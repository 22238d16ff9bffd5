#include "services/controller/adapter/trajectory_message.h"

#include <gtest/gtest.h>

#include "common/dds/convert.h"

namespace thalweg::controller {
namespace {

TEST(TrajectoryMessage, SaysEachPointInTheFrameOfTheMap) {
  const RigidTransform T_WB = MakeTransform(RotationFromYawPitch(1.2, 0.0), {1.0, 2.0, 3.0});
  const Time begin = Time{} + FromSeconds(50.25);
  const auto message = TrajectoryToIdl(
      begin, {{.time = 0.0, .T_WB = T_WB},
              {.time = 1.75, .T_WB = T_WB, .v_W = {0.1, 0.2, 0.3}, .w_W = {0, 0, 0.4}, .a_W = {5, 6, 7}}});
  EXPECT_EQ(message.header().frame_id(), "map");
  EXPECT_EQ(*dds::FromIdl(message.header().stamp()), begin);
  EXPECT_EQ(message.joint_names(), std::vector<std::string>{"base_link"});
  ASSERT_EQ(message.points().size(), 2U);
  EXPECT_EQ(message.points()[0].time_from_start().sec(), 0);
  const auto& point = message.points()[1];
  EXPECT_EQ(point.time_from_start().sec(), 1);
  EXPECT_EQ(point.time_from_start().nanosec(), 750'000'000U);
  ASSERT_EQ(point.transforms().size(), 1U);
  EXPECT_EQ(point.transforms()[0].translation().y(), 2.0);
  EXPECT_NEAR(point.transforms()[0].rotation().z(), std::sin(0.6), 1e-12);
  EXPECT_EQ(point.velocities()[0].linear().z(), 0.3);
  EXPECT_EQ(point.velocities()[0].angular().z(), 0.4);
  EXPECT_EQ(point.accelerations()[0].linear().x(), 5.0);
}

}  // namespace
}  // namespace thalweg::controller
