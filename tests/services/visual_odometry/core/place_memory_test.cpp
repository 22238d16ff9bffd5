#include "services/visual_odometry/core/place_memory.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace thalweg::visual_odometry {
namespace {

/// With disparities that are free of systematic errors on the way.
std::optional<KnownPose> Corrected(const KnownPose& camera, const KnownPose& place,
                                   const RigidTransform& T_CP, const Matrix6d& covariance_CP) {
  return visual_odometry::Corrected(camera, place, T_CP, covariance_CP, BiasTrace(),
                                    StereoBiasMonitor(StereoBiasMonitor::Options()));
}

const StereoGeometry kWallRig{PinholeCamera::FromFieldOfView(320, 240, 1.2), 0.12};
constexpr double kWall = 2.0;  // [m] ahead

RigidTransform Aside(double x, double z = 0.0) {
  return MakeTransform(Eigen::Matrix3d::Identity(), {x, 0.0, z});
}

/// A camera that looks straight at a wall with a point every 8 pixels.
KeyframeWindow WallAhead() {
  KeyframeWindow window(kWallRig, {});
  std::vector<StereoPixel> points;
  const double disparity = kWallRig.camera.fx * kWallRig.baseline / kWall;
  for (int v = 4; v < kWallRig.camera.height_px; v += 8) {
    for (int u = 4; u < kWallRig.camera.width_px; u += 8) points.emplace_back(u, v, u - disparity);
  }
  window.Append({}, RigidTransform::Identity(), {}, points);
  return window;
}

/// Waves across an image of 80 x 60, in the given direction.
cv::Mat Stripes(double angle) {
  cv::Mat image(60, 80, CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const double along = std::cos(angle) * u + std::sin(angle) * v;
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(128.0 + 90.0 * std::sin(along / 6.0));
    }
  }
  return image;
}

class PlaceMemoryTest : public testing::Test {
 protected:
  void Remember(PlaceMemory& places, const RigidTransform& T_OC, double sigma = 0.01,
                const cv::Mat& small = Stripes(0.0)) {
    places.Remember({T_OC, sigma * sigma * Matrix6d::Identity()}, wall_, small, keyframe_++);
  }
  static const Place* Find(const PlaceMemory& places, const RigidTransform& T_OC) {
    return places.InView(T_OC, 1000);
  }

  KeyframeWindow wall_ = WallAhead();
  std::int64_t keyframe_ = 0;
  PlaceMemory places_{kWallRig, {}};
};

TEST_F(PlaceMemoryTest, OverlapIsTheShareOfPointsThatStayInTheImage) {
  Remember(places_, RigidTransform::Identity());
  const Place& place = *Find(places_, RigidTransform::Identity());
  EXPECT_DOUBLE_EQ(places_.Overlap(place, RigidTransform::Identity()), 1.0);
  // In the image the wall moves by f x / depth pixels.
  for (const double share : {0.1, 0.3}) {
    const double x = share * kWallRig.camera.width_px * kWall / kWallRig.camera.fx;
    EXPECT_NEAR(places_.Overlap(place, Aside(x)), 1.0 - share, 0.03) << share;
    EXPECT_NEAR(places_.Overlap(place, Aside(-x)), 1.0 - share, 0.03) << share;
  }
  EXPECT_EQ(places_.Overlap(place, Aside(0.0, 0.45 * kWall)), 0.0) << "too near to look the same";
  const RigidTransform turned = MakeTransform(RotationFromVector({0.0, 1.4, 0.0}), Eigen::Vector3d::Zero());
  EXPECT_EQ(places_.Overlap(place, turned), 0.0);
}

TEST_F(PlaceMemoryTest, SeenFromAnotherSideAPointDoesNotCount) {
  PlaceMemory places(kWallRig, {.most_slant = 0.2});
  Remember(places, RigidTransform::Identity());
  const Place& place = *Find(places, RigidTransform::Identity());
  EXPECT_EQ(places.Overlap(place, Aside(0.6)), 0.0) << "atan(0.6 / 2) = 0.29; at the rim it is less";
}

TEST_F(PlaceMemoryTest, KeepsWhatIsNewAndNotTheSameTwice) {
  Remember(places_, RigidTransform::Identity());
  Remember(places_, Aside(0.1));
  EXPECT_EQ(places_.size(), 1U);
  Remember(places_, Aside(1.0));
  EXPECT_EQ(places_.size(), 2U);
}

TEST_F(PlaceMemoryTest, SeesAPlaceAgainThatWasHardlyKnown) {
  Remember(places_, RigidTransform::Identity(), 1.0);
  Remember(places_, Aside(0.05), 0.5);
  EXPECT_EQ(Find(places_, Aside(0.0))->serial, 0) << "hardly better";
  Remember(places_, Aside(0.05), 0.01);
  EXPECT_EQ(places_.size(), 1U);
  EXPECT_EQ(Find(places_, Aside(0.0))->serial, 2);
}

TEST_F(PlaceMemoryTest, KeepsNoPlaceThatCannotBeKnownAgain) {
  PlaceMemory places(kWallRig, {.least_points = 2000});
  Remember(places, RigidTransform::Identity());
  EXPECT_EQ(places.size(), 0U);
}

TEST_F(PlaceMemoryTest, ForgetsTheFarthestWhenThereAreTooMany) {
  PlaceMemory places(kWallRig, {.most_places = 3});
  for (const double x : {0.0, 5.0, 10.0, 14.0}) Remember(places, Aside(x));
  EXPECT_EQ(places.size(), 3U);
  EXPECT_EQ(Find(places, Aside(0.0)), nullptr);
  EXPECT_NE(Find(places, Aside(5.0)), nullptr);
}

TEST_F(PlaceMemoryTest, KeepsNoneWhenNoneIsWanted) {
  PlaceMemory places(kWallRig, {.most_places = 0});
  Remember(places, RigidTransform::Identity());
  EXPECT_EQ(places.size(), 0U);
}

TEST_F(PlaceMemoryTest, ShowsThePlaceWhosePoseIsKnownBest) {
  Remember(places_, RigidTransform::Identity(), 0.02);
  Remember(places_, Aside(0.9), 0.01);
  const Place* best = Find(places_, Aside(0.4));
  ASSERT_NE(best, nullptr);
  EXPECT_EQ(best->serial, 1);
  EXPECT_EQ(places_.InView(Aside(0.4), 1)->serial, 0) << "not yet one that is still being followed";
}

TEST_F(PlaceMemoryTest, NamesThoseNearACameraThatIsLost) {
  for (const double x : {0.0, 5.0, 2.0}) Remember(places_, Aside(x));
  Remember(places_, Aside(-1.0), 0.1);
  const auto serials = [&](const PlaceMemory::Reach& reach, const RigidTransform& T_OC) {
    std::vector<std::int64_t> found;
    for (const Place* place : places_.MostAlike(Stripes(0.0), T_OC, reach, 10))
      found.push_back(place->serial);
    return found;
  };
  EXPECT_EQ(serials({3.0, 1.0}, Aside(1.6)), (std::vector<std::int64_t>{0, 2, 3}));
  EXPECT_EQ(serials({2.0, 1.0}, Aside(1.6)), (std::vector<std::int64_t>{0, 2}));
  const RigidTransform back = MakeTransform(RotationFromVector({0.0, 3.0, 0.0}), Eigen::Vector3d::Zero());
  EXPECT_TRUE(serials({10.0, 1.0}, back).empty());
}

TEST_F(PlaceMemoryTest, OfThoseTheMostAlikeComeFirst) {
  for (const double angle : {0.0, 1.5, 0.8}) Remember(places_, Aside(3.0 * angle), 0.01, Stripes(angle));
  const auto found = places_.MostAlike(Stripes(0.9), Aside(0.0), {10.0, 1.0}, 2);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]->serial, 2);
  EXPECT_EQ(found[1]->serial, 1);
}

TEST(Likeness, DoesNotMindBrightnessContrastAndASmallTurn) {
  const cv::Mat image = Stripes(0.6);
  EXPECT_NEAR(Likeness(Thumbnail(image), Thumbnail(image)), 1.0, 1e-5);
  EXPECT_GT(Likeness(Thumbnail(image), Thumbnail(0.5 * image + 20.0)), 0.99);
  const cv::Mat turned = image.colRange(8, 72), seen = image.colRange(0, 64);
  EXPECT_GT(Likeness(Thumbnail(turned), Thumbnail(seen)), 0.95);
  EXPECT_LT(Likeness(Thumbnail(image), Thumbnail(Stripes(2.2))), 0.5);
  const cv::Mat blank(60, 80, CV_8UC1, cv::Scalar(120));
  EXPECT_EQ(Likeness(Thumbnail(blank), Thumbnail(image)), 0.0);
}

Matrix6d Isotropic(double sigma) {
  return sigma * sigma * Matrix6d::Identity();
}

TEST(Corrected, IsTheMeanWeightedByTheDriftSinceThePlaceAndTheMeasurement) {
  // Seen from the place itself, 3 cm from where the camera's estimate is.
  const KnownPose place{Aside(1.0), Isotropic(0.01)};
  const KnownPose camera{Aside(1.03), Isotropic(0.01) + Isotropic(0.02)};
  const auto corrected = Corrected(camera, place, RigidTransform::Identity(), Isotropic(0.01));
  ASSERT_TRUE(corrected);
  const double gain = 0.02 * 0.02 / (0.02 * 0.02 + 0.01 * 0.01);
  EXPECT_NEAR(corrected->T_OC.translation().x(), 1.03 - gain * 0.03, 1e-12);
  const double variance = 0.01 * 0.01 + (1.0 - gain) * 0.02 * 0.02;
  EXPECT_TRUE(corrected->covariance.isApprox(variance * Matrix6d::Identity(), 1e-9));
}

TEST(Corrected, LeavesACameraAloneThatIsKnownBetterThanThePlace) {
  const KnownPose place{RigidTransform::Identity(), Isotropic(0.1)};
  const KnownPose camera{Aside(0.03), Isotropic(0.01)};
  const auto corrected = Corrected(camera, place, RigidTransform::Identity(), Isotropic(0.01));
  ASSERT_TRUE(corrected);
  EXPECT_TRUE(corrected->T_OC.isApprox(camera.T_OC));
  EXPECT_TRUE(corrected->covariance.isApprox(camera.covariance));
}

TEST(Corrected, TakesIntoAccountWhereThePlaceIsSeen) {
  // A place known and seen exactly: the camera's pose follows from it, whatever its estimate was.
  const KnownPose place{MakeTransform(RotationFromVector({0.1, 0.5, -0.2}), {1, 2, 3}), Isotropic(1e-6)};
  const RigidTransform T_CP = MakeTransform(RotationFromVector({-0.2, 0.1, 0.0}), {0.3, 0.1, -0.2});
  const RigidTransform truth = place.T_OC * T_CP.inverse();
  Vector6d off;
  off << 0.02, -0.01, 0.015, 0.005, -0.004, 0.003;
  const KnownPose camera{truth * Moved(off, RigidTransform::Identity()), Isotropic(0.03)};
  const auto corrected = Corrected(camera, place, T_CP, Isotropic(1e-5));
  ASSERT_TRUE(corrected);
  EXPECT_LT((corrected->T_OC.translation() - truth.translation()).norm(), 3e-4);
  EXPECT_LT(AngleBetween(corrected->T_OC, truth), 3e-4);
  EXPECT_LT(corrected->covariance.trace(), 1e-6);
}

/// A random symmetric positive matrix, with standard deviations from a tenth of sigma to sigma.
Matrix6d RandomCovariance(std::mt19937& random, double sigma) {
  std::normal_distribution<double> normal;
  Matrix6d root;
  for (double& value : root.reshaped()) value = 0.3 * sigma * normal(random);
  return root * root.transpose() + 0.01 * sigma * sigma * Matrix6d::Identity();
}

RigidTransform RandomPose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  return MakeTransform(RotationFromVector(0.4 * vector()), vector());
}

TEST(Corrected, MovesByTheShareOfTheDriftWhateverThePlacesOwnErrorIs) {
  std::mt19937 random(5);
  for (int k = 0; k < 50; ++k) {
    const KnownPose place{RandomPose(random), RandomCovariance(random, 0.02)};
    const RigidTransform T_CP = RandomPose(random);
    // The place's error, carried over to the camera: T_OP (1 + y) T_PC = T_OC (1 + A y A^-1).
    Matrix6d carried;
    for (int axis = 0; axis < 6; ++axis) {
      constexpr double kSmall = 1e-6;
      const RigidTransform moved = Moved(kSmall * Vector6d::Unit(axis), RigidTransform::Identity());
      const RigidTransform at_camera = T_CP * moved * T_CP.inverse();
      const Eigen::AngleAxisd turn(at_camera.linear());
      carried.col(axis) << at_camera.translation() / kSmall, turn.angle() * turn.axis() / kSmall;
    }
    const Matrix6d drift = Isotropic(0.02);
    Vector6d off;
    off << 0.01, -0.02, 0.005, 0.004, -0.01, 0.003;
    const RigidTransform measured = place.T_OC * T_CP.inverse();
    const KnownPose camera{measured * Moved(-off, RigidTransform::Identity()),
                           carried * place.covariance * carried.transpose() + drift};
    const auto corrected = Corrected(camera, place, T_CP, Isotropic(0.01));
    ASSERT_TRUE(corrected);
    const RigidTransform step = camera.T_OC.inverse() * corrected->T_OC;
    const RigidTransform whole = camera.T_OC.inverse() * measured;
    const double gain = 0.02 * 0.02 / (0.02 * 0.02 + 0.01 * 0.01);
    EXPECT_LT((step.translation() - gain * whole.translation()).norm(), 1e-4) << k;
    EXPECT_NEAR(AngleBetween(step, RigidTransform::Identity()),
                gain * AngleBetween(whole, RigidTransform::Identity()), 1e-4)
        << k;
  }
}

TEST(Corrected, LeavesACovariance) {
  std::mt19937 random(6);
  for (int k = 0; k < 200; ++k) {
    const KnownPose place{RigidTransform::Identity(), RandomCovariance(random, 0.02)};
    const KnownPose camera{Aside(0.001), RandomCovariance(random, 0.02)};
    const auto corrected = Corrected(camera, place, RandomPose(random), 1e-6 * Matrix6d::Identity());
    if (!corrected) continue;
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(corrected->covariance);
    EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0) << k;
    EXPECT_LE(corrected->covariance.trace(), camera.covariance.trace() * (1.0 + 1e-9)) << k;
  }
}

TEST(Corrected, ManyLooksAtOnePlaceLeaveHalfOfWhatOneErrsBy) {
  // The place's points are the same each time, and so are their errors.
  const KnownPose place{RigidTransform::Identity(), Isotropic(0.01)};
  KnownPose camera{Aside(0.001), Isotropic(0.01) + Isotropic(0.05)};
  for (int look = 0; look < 50; ++look) {
    const auto corrected = Corrected(camera, place, RigidTransform::Identity(), Isotropic(0.02));
    ASSERT_TRUE(corrected);
    camera = *corrected;
  }
  const double variance = 0.01 * 0.01 + 0.5 * 0.02 * 0.02;
  EXPECT_TRUE(camera.covariance.isApprox(variance * Matrix6d::Identity(), 1e-6));
}

TEST(Corrected, RefusesWhatCannotBe) {
  const KnownPose place{RigidTransform::Identity(), Isotropic(0.001)};
  const KnownPose camera{Aside(1.0), Isotropic(0.01)};
  EXPECT_FALSE(Corrected(camera, place, RigidTransform::Identity(), Isotropic(0.01)));
}

}  // namespace
}  // namespace thalweg::visual_odometry
