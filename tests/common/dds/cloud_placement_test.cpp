#include "common/dds/cloud_placement.h"

#include <gtest/gtest.h>

#include "tests/support/at_second.h"

namespace thalweg::dds {
namespace {

using test::AtSecond;
using Verdict = CloudPlacement::Verdict;

class CloudPlacementTest : public testing::Test {
 protected:
  Verdict Pose(double seconds) {
    const Verdict verdict = placement_.JudgePose(AtSecond(seconds));
    if (verdict != Verdict::kNotLater) placement_.poses().Add(AtSecond(seconds), RigidTransform::Identity());
    return verdict;
  }
  Verdict Cloud(double seconds) {
    return placement_.JudgeCloud(AtSecond(seconds), topics::DepthPoints::kName);
  }
  bool HasPoseAt(double seconds) { return static_cast<bool>(placement_.poses().At(AtSecond(seconds))); }

  Health health_{"test"};
  CloudPlacement placement_{health_};
};

TEST_F(CloudPlacementTest, DropsWhatIsNotLaterInEitherStream) {
  EXPECT_EQ(Pose(5.0), Verdict::kLater);
  EXPECT_EQ(Cloud(4.9), Verdict::kLater);
  EXPECT_EQ(health_.dropped(), 0U);
  EXPECT_EQ(Pose(5.0), Verdict::kNotLater);
  EXPECT_EQ(Cloud(4.8), Verdict::kNotLater);
  EXPECT_EQ(health_.dropped(), 2U);
  EXPECT_EQ(placement_.newest_pose(), AtSecond(5.0));
  EXPECT_EQ(placement_.newest_cloud(), AtSecond(4.9));
  EXPECT_TRUE(HasPoseAt(5.0));
}

TEST_F(CloudPlacementTest, AfterARestartNoEarlierPosePlacesACloudWhicheverComesFirst) {
  Pose(100.0);
  Cloud(100.0);
  EXPECT_EQ(Cloud(1.0), Verdict::kRestarted);
  EXPECT_FALSE(HasPoseAt(100.0)) << "the poses are from before the jump";
  EXPECT_EQ(Pose(2.0), Verdict::kRestarted);
  EXPECT_TRUE(HasPoseAt(2.0));
}

TEST_F(CloudPlacementTest, PosesThatFollowARestartAlreadyAreKept) {
  Pose(100.0);
  Cloud(100.0);
  EXPECT_EQ(Pose(1.0), Verdict::kRestarted);
  EXPECT_FALSE(HasPoseAt(100.0));
  EXPECT_EQ(Cloud(1.0), Verdict::kRestarted);
  EXPECT_TRUE(HasPoseAt(1.0));
}

}  // namespace
}  // namespace thalweg::dds
