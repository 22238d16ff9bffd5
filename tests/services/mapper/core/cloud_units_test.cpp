#include "services/mapper/core/cloud_units.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/analytic_room.h"

namespace thalweg::mapper {
namespace {

PointCloud Room(float scale) {
  PointCloud cloud = test::AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(40, 30, 1.3),
                                                            RigidTransform::Identity());
  for (Eigen::Vector3f& p_C : cloud.points_C) p_C *= scale;
  return cloud;
}

TEST(CloudUnits, ARoomInMetersIsInMetersAndOneInMillimetersIsNot) {
  EXPECT_FALSE(IsOfOtherUnits(Room(1.0F), 5.0));
  EXPECT_TRUE(IsOfOtherUnits(Room(1000.0F), 5.0));
  EXPECT_FALSE(IsOfOtherUnits(Room(10.0F), 5.0)) << "a sensor that reaches farther than is mapped";
}

TEST(CloudUnits, WhatWasNotMeasuredAndAFewWrongPointsSayNothing) {
  PointCloud cloud = Room(1.0F);
  for (std::size_t k = 0; k < cloud.points_C.size(); k += 2) {
    cloud.points_C[k] = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  }
  for (std::size_t k = 1; k < cloud.points_C.size(); k += 4) cloud.points_C[k] = {0, 0, 1e6F};
  EXPECT_FALSE(IsOfOtherUnits(cloud, 5.0));
  for (Eigen::Vector3f& p_C : cloud.points_C) p_C = NoReturn();
  EXPECT_FALSE(IsOfOtherUnits(cloud, 5.0));
  cloud.points_C = {{0, 0, 1e6F}, {0, 0, 2e6F}};
  EXPECT_FALSE(IsOfOtherUnits(cloud, 5.0)) << "two points";
}

}  // namespace
}  // namespace thalweg::mapper
