#include "common/geometry/plausible.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace thalweg {
namespace {

using testing::HasSubstr;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndless = std::numeric_limits<double>::infinity();

TEST(IsRotation, AllowsForTheRoundingOfAFileAndNoMore) {
  Eigen::Matrix3d R = RotationFromYawPitch(0.3, 0.2);
  EXPECT_TRUE(IsRotation(R));
  EXPECT_TRUE(IsRotation(R + Eigen::Matrix3d::Constant(1e-5)));
  EXPECT_FALSE(IsRotation(R + Eigen::Matrix3d::Constant(0.01)));
  EXPECT_FALSE(IsRotation(-R)) << "a reflection";
  R(1, 1) = kNoNumber;
  EXPECT_FALSE(IsRotation(R));
}

TEST(IsPose, HasAPlaceThatIsNotBeyondAllBounds) {
  const auto at = [](double x) { return MakeTransform(Eigen::Matrix3d::Identity(), {0.0, x, 0.0}); };
  EXPECT_TRUE(IsPose(at(1e6)));
  for (const double x : {1.1e6, -1e300, kEndless, kNoNumber}) EXPECT_FALSE(IsPose(at(x))) << x;
  EXPECT_FALSE(IsPose(MakeTransform(Eigen::Matrix3d::Zero(), Eigen::Vector3d::Zero())));
}

TEST(MistakeIn, NamesWhatIsWrongWithACamera) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(40, 30, 1.2);
  EXPECT_FALSE(MistakeIn(camera));
  for (const double f : {0.0, -30.0, 1e-300, 1e300, kEndless, kNoNumber}) {
    PinholeCamera bad = camera;
    bad.fx = f;
    EXPECT_THAT(MistakeIn(bad).value(), HasSubstr("focal length")) << f;
    bad = camera;
    bad.fy = f;
    EXPECT_THAT(MistakeIn(bad).value(), HasSubstr("focal length")) << f;
  }
  PinholeCamera bad = camera;
  bad.height_px = 0;
  EXPECT_EQ(MistakeIn(bad), "the image is empty");
  for (const double c : {-1e300, 2e6, kEndless, kNoNumber}) {
    bad = camera;
    bad.cy = c;
    EXPECT_THAT(MistakeIn(bad).value(), HasSubstr("principal point")) << c;
  }
}

}  // namespace
}  // namespace thalweg
