#include "services/visual_odometry/core/visual_odometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/imgproc.hpp>

#include "services/visual_odometry/adapter/text.h"
#include "tests/services/visual_odometry/support/textured_room.h"

namespace thalweg::visual_odometry {
namespace {

using test::RoomPose;
using test::RoomStamp;
using Kind = Reason::Kind;
using testing::HasSubstr;
using namespace std::chrono_literals;

/// Moves through the room frame by frame; tests may alter the images.
class VisualOdometryTest : public testing::Test {
 protected:
  StereoImages See(int step) const { return room_.SeePair(rig_, RoomPose(step), RoomStamp(step)); }
  PoseEstimate Go(int step) { return odometry_.Track(See(step)); }
  void GoTo(int last) {
    for (; next_ <= last; ++next_) last_ = Go(next_);
  }
  /// [m] Position error of the estimate relative to frame 0.
  static double ErrorAt(const PoseEstimate& estimate, int step) {
    const RigidTransform truth = RoomPose(0).inverse() * RoomPose(step);
    return (estimate.T_OC.translation() - truth.translation()).norm();
  }

  StereoGeometry rig_ = test::SmallRig();
  test::TexturedRoom room_;
  VisualOdometry odometry_{rig_};
  int next_ = 0;
  PoseEstimate last_;
};

TEST_F(VisualOdometryTest, FollowsTheCamera) {
  int keyframes = 0;
  for (int step = 0; step <= 40; ++step) {
    const PoseEstimate estimate = Go(step);
    EXPECT_EQ(estimate.state, TrackingState::kTracking) << step << ' ' << ReasonText(estimate.reason);
    EXPECT_LT(ErrorAt(estimate, step), 0.002 + 0.005 * 0.026 * step) << step;
    EXPECT_LT(AngleBetween(estimate.T_OC, RoomPose(0).inverse() * RoomPose(step)), 0.003) << step;
    keyframes += estimate.keyframe ? 1 : 0;
    if (step > 1) {
      EXPECT_NEAR(estimate.v_OC_C.norm(), Eigen::Vector3d(0.025, 0.006, 0).norm() * 20.0, 0.1) << step;
      EXPECT_NEAR(estimate.w_OC_C.norm(), std::hypot(0.01, 0.004) * 20.0, 0.06) << step;
    }
  }
  EXPECT_GT(keyframes, 2);
  EXPECT_LT(keyframes, 30);
}

TEST_F(VisualOdometryTest, StandsStillWithTheCamera) {
  for (int step = 0; step < 15; ++step) {
    const PoseEstimate estimate = odometry_.Track(room_.SeePair(rig_, RoomPose(0), RoomStamp(step)));
    EXPECT_EQ(estimate.state, TrackingState::kTracking) << ReasonText(estimate.reason);
    EXPECT_LT(estimate.T_OC.translation().norm(), 0.001);
    EXPECT_EQ(estimate.keyframe, step == 0);
  }
}

TEST_F(VisualOdometryTest, UncertaintyGrowsWithTheDistance) {
  GoTo(10);
  const double early = last_.covariance.trace();
  GoTo(40);
  EXPECT_GT(last_.covariance.trace(), early);
  EXPECT_GT(early, 0.0);
}

TEST_F(VisualOdometryTest, SurvivesAJump) {
  GoTo(6);
  // Six steps at once, and a shake of 3 degrees.
  RigidTransform T_WC = RoomPose(12);
  T_WC.linear() = Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitX()).toRotationMatrix() * T_WC.linear();
  const PoseEstimate estimate = odometry_.Track(room_.SeePair(rig_, T_WC, RoomStamp(7)));
  EXPECT_NE(estimate.state, TrackingState::kLost) << ReasonText(estimate.reason);
  EXPECT_LT((estimate.T_OC.translation() - (RoomPose(0).inverse() * T_WC).translation()).norm(), 0.01);
}

TEST_F(VisualOdometryTest, LosesItselfInTheDarkAndFindsBackToTheSamePlace) {
  GoTo(10);
  StereoImages dark = See(11);
  dark.left *= 0.02;
  dark.right *= 0.02;
  const PoseEstimate lost = odometry_.Track(dark);
  EXPECT_EQ(lost.state, TrackingState::kLost);
  EXPECT_EQ(lost.reason.kind, Kind::kDark);
  EXPECT_TRUE(lost.T_OC.isApprox(last_.T_OC)) << "the last good pose";
  EXPECT_GT(lost.covariance.trace(), last_.covariance.trace());
  const PoseEstimate found = Go(12);
  EXPECT_NE(found.state, TrackingState::kLost) << ReasonText(found.reason);
  EXPECT_LT(ErrorAt(found, 12), 0.01);
}

TEST_F(VisualOdometryTest, BackWhereItWasItIsAsSureAsItWasThere) {
  VisualOdometry::Options forgetful;
  forgetful.places.most_places = 0;
  VisualOdometry other(rig_, forgetful);
  constexpr int kFar = 60;
  double error = 0.0, error_other = 0.0;
  PoseEstimate estimate, estimate_other;
  for (int k = 0; k <= 2 * kFar; ++k) {
    const int step = k <= kFar ? k : 2 * kFar - k;
    const StereoImages images = room_.SeePair(rig_, RoomPose(step), RoomStamp(k));
    estimate = odometry_.Track(images);
    estimate_other = other.Track(images);
    ASSERT_EQ(estimate.state, TrackingState::kTracking) << k << ' ' << ReasonText(estimate.reason);
    if (k <= 2 * kFar - 20) continue;
    error = std::max(error, ErrorAt(estimate, step));
    error_other = std::max(error_other, ErrorAt(estimate_other, step));
  }
  EXPECT_LT(error, 0.8 * error_other);
  EXPECT_LT(estimate.covariance.trace(), 0.5 * estimate_other.covariance.trace());
}

TEST_F(VisualOdometryTest, LostItFindsItselfAtAPlaceOfLongAgo) {
  GoTo(45);
  const StereoImages dark{RoomStamp(46), See(46).left * 0.02, See(46).right * 0.02};
  ASSERT_EQ(odometry_.Track(dark).state, TrackingState::kLost);
  // Carried back by 0.9 m and turned slightly.
  RigidTransform T_WC = RoomPose(8);
  T_WC.linear() = Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitX()).toRotationMatrix() * T_WC.linear();
  const double before = last_.covariance.trace();
  PoseEstimate found;
  int tries = 0;
  do {
    found = odometry_.Track(room_.SeePair(rig_, T_WC, RoomStamp(47 + tries)));
  } while (found.state == TrackingState::kLost && ++tries < 20);
  EXPECT_EQ(found.state, TrackingState::kDegraded) << "once";
  EXPECT_EQ(found.reason.kind, Kind::kRelocalized);
  EXPECT_LT((found.T_OC.translation() - (RoomPose(0).inverse() * T_WC).translation()).norm(), 0.01);
  EXPECT_LT(found.covariance.trace(), before);
  EXPECT_EQ(found.v_OC_C.norm(), 0.0) << "that it was carried is no motion of its own";
  EXPECT_EQ(odometry_.Track(room_.SeePair(rig_, T_WC, RoomStamp(48 + tries))).state,
            TrackingState::kTracking);
}

TEST_F(VisualOdometryTest, WhatIsLostStaysLostWhateverIsWrongWithTheNextFrame) {
  GoTo(20);
  const auto away = [&](int step) {
    RigidTransform T_WC = RoomPose(10);
    T_WC.linear() = RotationFromYawPitch(2.5, 0.0) * BodyFromOptical();
    return room_.SeePair(rig_, T_WC, RoomStamp(step));
  };
  ASSERT_EQ(odometry_.Track(away(21)).state, TrackingState::kLost);
  StereoImages frozen = away(21);
  frozen.stamp = RoomStamp(22);
  EXPECT_EQ(odometry_.Track(frozen).state, TrackingState::kLost);
  const PoseEstimate refused = odometry_.Track(away(20));
  EXPECT_EQ(refused.reason.kind, Kind::kTimeRunsBackwards);
  EXPECT_EQ(refused.state, TrackingState::kLost);
  EXPECT_GT(refused.covariance.trace(), 2.0 * last_.covariance.trace());
}

TEST_F(VisualOdometryTest, LosesItselfWhenTheLensIsCovered) {
  GoTo(10);
  StereoImages covered = See(11);
  covered.left.setTo(77);
  const PoseEstimate lost = odometry_.Track(covered);
  EXPECT_EQ(lost.state, TrackingState::kLost);
  EXPECT_EQ(lost.reason.kind, Kind::kBlank);
  EXPECT_EQ(lost.reason.eye, Eye::kLeft);
}

TEST_F(VisualOdometryTest, GoesOnWithOneEyeForAWhileButSaysSo) {
  GoTo(10);
  for (int step = 11; step < 14; ++step) {
    StereoImages covered = See(step);
    covered.right.setTo(77);
    const PoseEstimate estimate = odometry_.Track(covered);
    EXPECT_EQ(estimate.state, TrackingState::kDegraded);
    EXPECT_EQ(estimate.reason.kind, Kind::kBlank);
    EXPECT_EQ(estimate.reason.eye, Eye::kRight);
    EXPECT_LT(ErrorAt(estimate, step), 0.02);
    EXPECT_FALSE(estimate.keyframe);
  }
}

TEST_F(VisualOdometryTest, SaysThatTheImageIsBlurred) {
  GoTo(10);
  StereoImages blurred = See(11);
  cv::GaussianBlur(blurred.left, blurred.left, {31, 31}, 6.0);
  cv::GaussianBlur(blurred.right, blurred.right, {31, 31}, 6.0);
  const PoseEstimate estimate = odometry_.Track(blurred);
  EXPECT_NE(estimate.state, TrackingState::kTracking);
  if (estimate.state == TrackingState::kDegraded) {
    EXPECT_EQ(estimate.reason.kind, Kind::kBlurred);
  }
  EXPECT_LT(ErrorAt(Go(12), 12), 0.02) << "sharp again";
}

TEST_F(VisualOdometryTest, SaysThatTheImageIsFrozen) {
  GoTo(10);
  StereoImages frozen = See(10);
  PoseEstimate estimate;
  for (int step = 11; step < 40; ++step) {
    frozen.stamp = RoomStamp(step);
    estimate = odometry_.Track(frozen);
    EXPECT_NE(estimate.state, TrackingState::kTracking);
    EXPECT_EQ(estimate.reason.kind, Kind::kFrozen);
    EXPECT_GT(estimate.covariance.trace(), last_.covariance.trace());
  }
  EXPECT_EQ(estimate.state, TrackingState::kLost) << "after more than a second";
}

TEST_F(VisualOdometryTest, TakesEqualImagesOfACameraWithoutNoiseForAStandstill) {
  VisualOdometry::Options options;
  options.checks.detect_frozen = false;
  VisualOdometry odometry(rig_, options);
  StereoImages same = See(0);
  for (int step = 0; step < 5; ++step) {
    same.stamp = RoomStamp(step);
    EXPECT_EQ(odometry.Track(same).state, TrackingState::kTracking);
  }
}

TEST_F(VisualOdometryTest, SaysThatFramesWereDropped) {
  GoTo(10);
  const PoseEstimate estimate = Go(16);
  EXPECT_EQ(estimate.state, TrackingState::kDegraded);
  EXPECT_EQ(estimate.reason.kind, Kind::kFramesDropped);
  EXPECT_LT(ErrorAt(estimate, 16), 0.01);
  EXPECT_EQ(Go(17).state, TrackingState::kTracking);
}

TEST_F(VisualOdometryTest, RefusesFramesWhoseTimeRunsBackwards) {
  GoTo(10);
  for (const int step : {9, 10}) {
    const PoseEstimate estimate = Go(step);
    EXPECT_EQ(estimate.state, TrackingState::kDegraded);
    EXPECT_EQ(estimate.reason.kind, Kind::kTimeRunsBackwards);
    EXPECT_TRUE(estimate.T_OC.isApprox(last_.T_OC));
  }
  const PoseEstimate next = Go(11);
  EXPECT_EQ(next.state, TrackingState::kTracking);
  EXPECT_LT(ErrorAt(next, 11), 0.01);
}

TEST_F(VisualOdometryTest, GoesOnWhenTheClockWasSetBackForGood) {
  GoTo(10);
  PoseEstimate estimate;
  for (int step = 11; step < 16; ++step) {
    estimate = odometry_.Track(room_.SeePair(rig_, RoomPose(step), RoomStamp(step - 1000)));
  }
  EXPECT_EQ(estimate.state, TrackingState::kTracking) << ReasonText(estimate.reason);
  EXPECT_LT(ErrorAt(estimate, 15), 0.02);
}

TEST_F(VisualOdometryTest, LosesItselfWhereThereIsNothingToSee) {
  const test::TexturedRoom blank(0.0, 2.0);
  GoTo(10);
  const PoseEstimate lost = odometry_.Track(blank.SeePair(rig_, RoomPose(11), RoomStamp(11)));
  EXPECT_EQ(lost.state, TrackingState::kLost);
  EXPECT_TRUE(lost.reason);
}

TEST_F(VisualOdometryTest, ItBeginsWithLostWhereThereIsNothingToSee) {
  const test::TexturedRoom blank(0.0, 6.0);
  const PoseEstimate lost = odometry_.Track(blank.SeePair(rig_, RoomPose(0), RoomStamp(0)));
  EXPECT_EQ(lost.state, TrackingState::kLost);
  EXPECT_TRUE(lost.reason);
  EXPECT_EQ(Go(1).state, TrackingState::kTracking) << "the first thing to be seen";
}

TEST_F(VisualOdometryTest, BeginsAgainAtTheLastGoodPoseWhenThePlaceIsAnother) {
  VisualOdometry::Options options;
  options.patience = 1.0;
  odometry_ = VisualOdometry(rig_, options);
  GoTo(10);
  const RigidTransform turn = MakeTransform(RotationFromYawPitch(3.1, 0.0), Eigen::Vector3d::Zero());
  const auto elsewhere = [&](int step) {
    RigidTransform T_WC = RoomPose(0);
    T_WC.linear() = turn.linear() * T_WC.linear();
    T_WC.translation() += Eigen::Vector3d(1.0 + 0.02 * step, 0.5, 0.0);
    return T_WC;
  };
  PoseEstimate estimate;
  int restarted = -1;
  for (int step = 11; step < 45; ++step) {
    estimate = odometry_.Track(room_.SeePair(rig_, elsewhere(step), RoomStamp(step)));
    if (restarted < 0 && estimate.state != TrackingState::kLost) {
      restarted = step;
      EXPECT_EQ(estimate.state, TrackingState::kDegraded);
      EXPECT_EQ(estimate.reason.kind, Kind::kRestarted);
      EXPECT_TRUE(estimate.T_OC.isApprox(last_.T_OC)) << "goes on from the last good pose";
      EXPECT_GT(std::sqrt(estimate.covariance(0, 0)), 0.4) << "half a meter a second, unseen";
    }
  }
  ASSERT_GT(restarted, 20) << "not before a second of trying";
  EXPECT_EQ(estimate.state, TrackingState::kDegraded);
  EXPECT_EQ(estimate.reason.kind, Kind::kNotRelocalized);
  const RigidTransform since = last_.T_OC.inverse() * estimate.T_OC;
  const RigidTransform truth = elsewhere(restarted).inverse() * elsewhere(44);
  EXPECT_LT((since.translation() - truth.translation()).norm(), 0.02);
}

TEST_F(VisualOdometryTest, HavingBegunAgainItKnowsWhereItIsAsSoonAsItSeesAPlaceAgain) {
  VisualOdometry::Options options;
  options.patience = 0.5;
  odometry_ = VisualOdometry(rig_, options);
  GoTo(20);
  // In the dark, the camera is carried to the left and turned away; there the odometry restarts.
  const auto away = [&](int step) {
    const double yaw = 1.6 - 0.08 * (step - 21);
    RigidTransform T_WC = RoomPose(10);
    T_WC.linear() = RotationFromYawPitch(yaw, 0.0) * BodyFromOptical();
    return T_WC;
  };
  PoseEstimate estimate;
  bool restarted = false;
  for (int step = 21; step < 60 && !(restarted && estimate.recognized); ++step) {
    const RigidTransform T_WC = step < 33 ? away(21) : away(step - 12);
    const bool dark = step < 24;
    StereoImages images = room_.SeePair(rig_, T_WC, RoomStamp(step));
    if (dark) {
      images.left *= 0.02;
      images.right *= 0.02;
    }
    estimate = odometry_.Track(images);
    if (!restarted && estimate.state == TrackingState::kDegraded) {
      EXPECT_EQ(estimate.reason.kind, Kind::kRestarted);
      restarted = true;
      EXPECT_GT(AngleBetween(estimate.T_OC, RoomPose(0).inverse() * T_WC), 1.0);
    }
    if (restarted && estimate.recognized) {
      EXPECT_LT(AngleBetween(estimate.T_OC, RoomPose(0).inverse() * T_WC), 0.01);
      EXPECT_EQ(estimate.state, TrackingState::kDegraded) << "it leaps";
      EXPECT_EQ(estimate.reason.kind, Kind::kRelocalized);
      EXPECT_LT((estimate.T_OC.translation() - (RoomPose(0).inverse() * T_WC).translation()).norm(), 0.02);
    }
  }
  EXPECT_TRUE(restarted);
  EXPECT_TRUE(estimate.recognized);
  EXPECT_LT(std::sqrt(estimate.covariance.topLeftCorner<3, 3>().trace()), 0.05);
}

/// The pose after `step` times 5 cm along a wall one meter away, facing it.
RigidTransform AlongTheWall(int step) {
  return MakeTransform(RotationFromYawPitch(std::numbers::pi / 2.0, 0.0) * BodyFromOptical(),
                       Eigen::Vector3d(1.0 + 0.05 * step, 4.0, 1.4));
}

enum class Gap { kBlack, kNoFrames, kFrozen, kClockSetBack };

/// A camera that moves past a wall for 3.25 m, then sees nothing for 2.5 s while it is carried back by two
/// meters.
class CarriedBack {
 public:
  struct Seen {
    PoseEstimate estimate;
    int step;  ///< True position of the camera.
  };

  CarriedBack(const StereoGeometry& rig, double period) : rig_(rig), room_(1.0, 1.0, period) {
    for (int k = 0; k <= kFar; ++k) past_.push_back(room_.SeePair(rig, AlongTheWall(k), RoomStamp(k)));
  }
  /// The estimates from then on: two seconds at rest, one meter of motion, and at rest again.
  std::vector<Seen> Over(Gap gap) const {
    VisualOdometry::Options options;
    options.patience = 4.0;
    VisualOdometry odometry(rig_, options);
    for (const StereoImages& images : past_) odometry.Track(images);
    const cv::Mat nothing = cv::Mat::zeros(rig_.camera.height_px, rig_.camera.width_px, CV_8UC1);
    for (int k = kFar + 1; k <= kFar + kUnseen; ++k) {
      if (gap == Gap::kBlack) odometry.Track({RoomStamp(k), nothing, nothing});
      if (gap == Gap::kFrozen) odometry.Track({RoomStamp(k), past_.back().left, past_.back().right});
    }
    std::vector<Seen> seen;
    for (int k = 1; k <= kStands + kGoes + kStandsAgain; ++k) {
      const int step = kTo + std::clamp(k - kStands, 0, kGoes);
      const Time stamp = RoomStamp(kFar + kUnseen + k) - (gap == Gap::kClockSetBack ? 1000s : 0s);
      seen.push_back({odometry.Track(room_.SeePair(rig_, AlongTheWall(step), stamp)), step});
    }
    return seen;
  }

 private:
  static constexpr int kFar = 65;
  static constexpr int kUnseen = 50;
  static constexpr int kTo = 25;
  static constexpr int kStands = 40;
  static constexpr int kGoes = 20;
  static constexpr int kStandsAgain = 10;

  StereoGeometry rig_;
  test::TexturedRoom room_;
  std::vector<StereoImages> past_;
};

double ErrorAlongTheWall(const CarriedBack::Seen& seen) {
  const RigidTransform truth = AlongTheWall(0).inverse() * AlongTheWall(seen.step);
  return (seen.estimate.T_OC.translation() - truth.translation()).norm();
}

TEST_F(VisualOdometryTest, TakesAFastFlightPastAWallForNoTurn) {
  // The whole image moves by up to 45 pixels, which a rotation would explain, so a steady motion must be
  // tried, too.
  double traveled = 0.0;
  for (int k = 0; k < 15; ++k) {
    traveled += std::min(0.02 * k, 0.2);
    RigidTransform T_WC = AlongTheWall(0);
    T_WC.translation().x() += traveled;
    const PoseEstimate estimate = odometry_.Track(room_.SeePair(rig_, T_WC, RoomStamp(k)));
    EXPECT_EQ(estimate.state, TrackingState::kTracking) << k << ' ' << ReasonText(estimate.reason);
    EXPECT_NEAR(estimate.T_OC.translation().x(), traveled, 0.03) << k;
    EXPECT_LT(AngleBetween(estimate.T_OC, RigidTransform::Identity()), 0.03) << k;
  }
}

/// With a wall whose pattern repeats every meter, and with one that does not.
class CarriedBackTest : public VisualOdometryTest, public testing::WithParamInterface<Gap> {};
INSTANTIATE_TEST_SUITE_P(Gaps, CarriedBackTest,
                         testing::Values(Gap::kBlack, Gap::kNoFrames, Gap::kFrozen, Gap::kClockSetBack));

TEST_P(CarriedBackTest, WherePlacesLookAlikeItDoesNotSayThatItKnowsWhichOneItSees) {
  bool disputed = false;
  for (const CarriedBack::Seen& seen : CarriedBack(rig_, 1.0).Over(GetParam())) {
    const Reason& reason = seen.estimate.reason;
    disputed |= reason.kind == Kind::kPlacesLookAlike ||
                reason.kind == Kind::kRestarted;  // at once if the clock was set back
    EXPECT_NE(seen.estimate.state, TrackingState::kTracking)
        << ReasonText(reason) << ", off by " << ErrorAlongTheWall(seen) << " m at " << seen.step;
  }
  EXPECT_TRUE(disputed);
}

TEST_P(CarriedBackTest, WhereTheyDoNotItFindsItsPlace) {
  const CarriedBack::Seen last = CarriedBack(rig_, 0.0).Over(GetParam()).back();
  EXPECT_EQ(last.estimate.state, TrackingState::kTracking) << ReasonText(last.estimate.reason);
  EXPECT_LT(ErrorAlongTheWall(last), 0.02);
}

/// Shows points of the right image at u + b0 + b2 x^2 and v + row.
cv::Mat BentImage(const cv::Mat& right, const PinholeCamera& camera, const DisparityBias& bias, double row) {
  cv::Mat map_u(right.size(), CV_32F), map_v(right.size(), CV_32F), bent;
  for (int v = 0; v < right.rows; ++v) {
    for (int u = 0; u < right.cols; ++u) {
      map_u.at<float>(v, u) = static_cast<float>(u - bias.dot(BiasBasis(camera, u)));
      map_v.at<float>(v, u) = static_cast<float>(v - row);
    }
  }
  cv::remap(right, bent, map_u, map_v, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return bent;
}

struct Bend {
  DisparityBias disparity;
  double row = 0.0;
};
class BentCameraTest : public VisualOdometryTest, public testing::WithParamInterface<Bend> {};
INSTANTIATE_TEST_SUITE_P(Bends, BentCameraTest,
                         testing::Values(Bend{{0.8, 1.5}, 0.0}, Bend{{-1.0, 0.0}, 0.0}, Bend{{2.0, 0.0}, 0.0},
                                         Bend{{0.0, 0.0}, 1.5}));

TEST_P(BentCameraTest, ItKnowsAndTheScaleIsRightOrDoubted) {
  const auto& [disparity, row] = GetParam();
  double path = 0.0, path_true = 0.0;
  PoseEstimate last;
  constexpr int kLearned = 60;  // 1.5 m: all it sees is 2 to 4 m away, which shows little
  for (int step = 0; step <= 90; ++step) {
    StereoImages images = See(step);
    images.right = BentImage(images.right, rig_.camera, disparity, row);
    const PoseEstimate estimate = odometry_.Track(images);
    ASSERT_NE(estimate.state, TrackingState::kLost) << step << ' ' << ReasonText(estimate.reason);
    if (step > kLearned && estimate.state == TrackingState::kTracking) {
      path += (estimate.T_OC.translation() - last.T_OC.translation()).norm();
      path_true += (RoomPose(step).translation() - RoomPose(step - 1).translation()).norm();
    }
    last = estimate;
  }
  EXPECT_NEAR(path, path_true, 0.02 * path_true);
  EXPECT_GT(last.calibration.off_probability, 0.5);
  EXPECT_NEAR(last.calibration.row_px, row, 0.15);
  const double truth = std::hypot(OffsetInImage(rig_.camera, disparity * disparity.transpose()), row);
  EXPECT_NEAR(last.calibration.offset_px, truth, 0.3 * truth);
}

TEST_F(VisualOdometryTest, BelievesAGoodCalibration) {
  GoTo(40);
  EXPECT_LT(last_.calibration.off_probability, 0.2);
  EXPECT_LT(last_.calibration.offset_px, 0.15);
  EXPECT_GT(last_.scale_sigma, 0.0) << "but it may be wrong";
}

TEST_F(VisualOdometryTest, NamesImagesThatDoNotFit) {
  StereoImages images = See(0);
  images.right = images.right.colRange(0, 300).clone();
  try {
    odometry_.Track(images);
    FAIL() << "taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("right image is 300 x 240"));
  }
}

TEST_F(VisualOdometryTest, NamesAnOptionThatCannotBe) {
  VisualOdometry::Options options;
  options.places.most_places = -1;
  EXPECT_THROW(VisualOdometry(rig_, options), std::invalid_argument);
  options = {};
  options.finder.least_inliers = 5;
  EXPECT_THROW(VisualOdometry(rig_, options), std::invalid_argument);
}

TEST_F(VisualOdometryTest, NamesACameraThatCannotBe) {
  StereoGeometry rig = rig_;
  rig.baseline = 0.0;
  EXPECT_THROW(VisualOdometry{rig}, std::invalid_argument);
  rig = rig_;
  rig.camera.fx = -1.0;
  EXPECT_THROW(VisualOdometry{rig}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::visual_odometry
