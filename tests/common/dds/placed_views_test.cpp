#include "common/dds/placed_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/geometry/depth_image.h"
#include "tests/support/at_second.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using test::AtSecond;
using testing::SizeIs;

const PinholeCamera kViewCamera = PinholeCamera::FromFieldOfView(40, 30, 1.2);

/// What a camera sees of a wall 2 m away.
PointCloud WallBefore(const PinholeCamera& camera) {
  const auto pixels = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  return CloudFrom({camera.width_px, camera.height_px, std::vector<float>(pixels, 2.0F)}, camera);
}

class PlacedViewsTest : public testing::Test {
 protected:
  /// Odometry at 20 Hz until then, of a body that moves at 1 m/s.
  void PosesUntil(double seconds) {
    for (; pose_ * 0.05 <= seconds + 1e-9; ++pose_) {
      const Time stamp = AtSecond(0.05 * pose_);
      views_.AddPose({stamp, MakeTransform(Eigen::Matrix3d::Identity(), {0.05 * pose_, 0.0, 0.0})});
    }
  }
  void Cloud(double seconds, const PointCloud& cloud) { views_.Add(ToIdl(AtSecond(seconds), cloud)); }

  int pose_ = 20;  ///< Number of the next.
  Bus bus_{test::BusOptionsForTest("test")};
  PlacedViews views_{bus_, Infinity::kNoMeasurement, {.max_speed = 2.0, .max_turn_rate = 1.0}};
};

TEST_F(PlacedViewsTest, WaitForTheOdometryAtTheirStamp) {
  PosesUntil(1.0);
  Cloud(1.5, WallBefore(kViewCamera));
  EXPECT_THAT(views_.Take(), SizeIs(0));
  PosesUntil(2.0);
  const std::vector<PlacedViews::View> placed = views_.Take();
  ASSERT_THAT(placed, SizeIs(1));
  EXPECT_EQ(placed[0].stamped.stamp, AtSecond(1.5));
  EXPECT_TRUE(IsSameCamera(placed[0].camera, kViewCamera));
  EXPECT_NEAR(placed[0].T_WB.translation().x(), 1.5, 1e-9);
  EXPECT_THAT(views_.Take(), SizeIs(0)) << "each once";
}

TEST_F(PlacedViewsTest, APoseThatJumpsPlacesNothingAndIsCounted) {
  PosesUntil(2.0);
  views_.AddPose({AtSecond(2.02), MakeTransform(Eigen::Matrix3d::Identity(), {9.0, 0.0, 0.0})});
  PosesUntil(2.05);
  Cloud(2.03, WallBefore(kViewCamera));
  const std::vector<PlacedViews::View> placed = views_.Take();
  ASSERT_THAT(placed, SizeIs(1));
  EXPECT_NEAR(placed[0].T_WB.translation().x(), 2.03, 1e-9);
  EXPECT_EQ(bus_.health().rejected(), 1U);
}

TEST_F(PlacedViewsTest, CloudsOfNoCameraOrOfAnotherAreRefusedAndCounted) {
  PosesUntil(5.0);
  PointCloud line = WallBefore(kViewCamera);
  line.width_px *= line.height_px;
  line.height_px = 1;
  Cloud(2.0, line);
  EXPECT_EQ(bus_.health().rejected(), 1U);
  Cloud(3.0, WallBefore(kViewCamera));
  Cloud(4.0, WallBefore(PinholeCamera::FromFieldOfView(40, 30, 0.8)));
  EXPECT_EQ(bus_.health().rejected(), 2U);
  EXPECT_THAT(views_.Take(), SizeIs(1));
}

TEST_F(PlacedViewsTest, OfThoseThatWaitTooLongTheOldestIsDropped) {
  PosesUntil(1.0);
  for (std::size_t n = 0; n <= PlacedViews::kMaxWaiting; ++n)
    Cloud(2.0 + 0.1 * static_cast<double>(n), WallBefore(kViewCamera));
  EXPECT_EQ(bus_.health().dropped(), 1U);
  PosesUntil(3.0);
  EXPECT_THAT(views_.Take(), SizeIs(PlacedViews::kMaxWaiting));
}

}  // namespace
}  // namespace thalweg::dds
