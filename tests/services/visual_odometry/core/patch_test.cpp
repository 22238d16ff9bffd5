#include "services/visual_odometry/core/patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "services/visual_odometry/core/corners.h"
#include "services/visual_odometry/core/inverse_depth.h"
#include "services/visual_odometry/core/rotation_prediction.h"

namespace thalweg::visual_odometry {
namespace {

/// A smooth, unbounded texture.
double Pattern(double u, double v) {
  return 128.0 + 40.0 * std::sin(0.31 * u + 0.07 * v) + 35.0 * std::sin(0.23 * v - 0.11 * u + 1.0) +
         20.0 * std::sin(0.17 * u + 0.29 * v + 2.0);
}

template <class Warp>
cv::Mat Picture(int width, int height, Warp&& warp) {
  cv::Mat image(height, width, CV_8UC1);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Eigen::Vector2d p = warp(Eigen::Vector2d(u, v));
      image.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>(std::lround(std::clamp(Pattern(p.x(), p.y()), 0.0, 255.0)));
    }
  }
  return image;
}

TEST(Patch, IsFoundToAFiftiethOfAPixel) {
  const cv::Mat before = Picture(120, 90, [](const Eigen::Vector2d& p) { return p; });
  for (const Eigen::Vector2d& shift : {Eigen::Vector2d(1.3, -0.8), Eigen::Vector2d(-0.45, 1.62)}) {
    const cv::Mat after =
        Picture(120, 90, [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(p - shift); });
    const Eigen::Vector2f center(61.3F, 40.8F);
    const auto patch = Patch::Cut(before, center, Eigen::Matrix2f::Identity());
    ASSERT_TRUE(patch);
    const auto found = patch->Find(after, center, 4.0F);
    ASSERT_TRUE(found);
    EXPECT_LT((found->position - center - shift.cast<float>()).norm(), 0.02F);
    EXPECT_GT(found->correlation, 0.99F);
  }
}

TEST(Patch, DoesNotMindBrightnessAndContrast) {
  const cv::Mat before = Picture(120, 90, [](const Eigen::Vector2d& p) { return p; });
  cv::Mat after =
      Picture(120, 90, [](const Eigen::Vector2d& p) { return Eigen::Vector2d(p.x() - 1.1, p.y() - 0.4); });
  after.convertTo(after, CV_8U, 0.6, 25.0);
  const Eigen::Vector2f center(50.0F, 50.0F);
  const auto found = Patch::Cut(before, center, Eigen::Matrix2f::Identity())->Find(after, center, 4.0F);
  ASSERT_TRUE(found);
  EXPECT_LT((found->position - Eigen::Vector2f(51.1F, 50.4F)).norm(), 0.03F);
}

TEST(Patch, IsFoundAgainInAnImageTwiceAsLarge) {
  const cv::Mat before = Picture(120, 90, [](const Eigen::Vector2d& p) { return p; });
  const cv::Mat after = Picture(120, 90, [](const Eigen::Vector2d& p) { return Eigen::Vector2d(0.5 * p); });
  const auto patch = Patch::Cut(before, {30.0F, 22.0F}, 0.5F * Eigen::Matrix2f::Identity());
  ASSERT_TRUE(patch);
  const auto found = patch->Find(after, {61.0F, 43.2F}, 4.0F);
  ASSERT_TRUE(found);
  EXPECT_LT((found->position - Eigen::Vector2f(60.0F, 44.0F)).norm(), 0.05F);
}

TEST(Patch, ThereIsNoneWithoutTextureOrOverTheEdge) {
  const cv::Mat blank(60, 60, CV_8UC1, cv::Scalar(100));
  EXPECT_FALSE(Patch::Cut(blank, {30.0F, 30.0F}, Eigen::Matrix2f::Identity()));
  const cv::Mat stripes = [] {
    cv::Mat image(60, 60, CV_8UC1);
    for (int u = 0; u < 60; ++u) image.col(u).setTo(u % 8 < 4 ? 50 : 200);
    return image;
  }();
  // Could be shifted along the stripes
  EXPECT_FALSE(Patch::Cut(stripes, {30.0F, 30.0F}, Eigen::Matrix2f::Identity()));
  const cv::Mat picture = Picture(60, 60, [](const Eigen::Vector2d& p) { return p; });
  EXPECT_FALSE(Patch::Cut(picture, {2.0F, 30.0F}, Eigen::Matrix2f::Identity()));
}

TEST(SearchPatch, FindsWhatBruteForceFinds) {
  std::mt19937 random(1);
  cv::Mat before(80, 100, CV_8UC1);
  cv::Mat after(80, 100, CV_8UC1);
  for (int v = 0; v < 80; ++v) {
    for (int u = 0; u < 100; ++u) {
      before.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(random() % 256);
      after.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(random() % 256);
    }
  }
  const cv::Rect area(20, 15, 31, 27);
  const auto patch = SearchPatch::Cut(before, {50.0F, 40.0F}, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(patch);
  const auto found = patch->Search(after, area);
  ASSERT_TRUE(found);
  int best = 1 << 30;
  for (int v = area.y; v < area.y + area.height; ++v) {
    for (int u = area.x; u < area.x + area.width; ++u) {
      best = std::min(best, static_cast<int>(cv::norm(before(cv::Rect(46, 36, 8, 8)),
                                                      after(cv::Rect(u - 4, v - 4, 8, 8)), cv::NORM_L1)));
    }
  }
  EXPECT_EQ(found->difference, best);
  EXPECT_GE(found->rival, best);
}

TEST(SearchPatch, WithoutLightDoesNotMindBrightness) {
  const cv::Mat image = Picture(60, 60, [](const Eigen::Vector2d& p) { return p; });
  cv::Mat brighter;
  image.convertTo(brighter, CV_8U, 0.8, 0.0);
  cv::Mat shifted = brighter + 30;
  EXPECT_LE(cv::norm(WithoutLight(brighter), WithoutLight(shifted), cv::NORM_INF), 2.0);
}

TEST(FindCorners, SpreadsThemOverTheWholeImage) {
  // Strong texture in one quarter, weak texture elsewhere.
  std::mt19937 random(2);
  cv::Mat image(240, 320, CV_8UC1);
  for (int v = 0; v < 240; v += 4) {
    for (int u = 0; u < 320; u += 4) {
      const bool strong = u < 160 && v < 120;
      const int value = 128 + static_cast<int>(random() % (strong ? 200U : 40U)) - (strong ? 100 : 20);
      image(cv::Rect(u, v, 4, 4)).setTo(value);
    }
  }
  const auto corners = FindCorners(image, {}, 120);
  EXPECT_GT(corners.size(), 80U);
  EXPECT_LE(corners.size(), 120U);
  std::array<int, 4> quarters{};
  for (const auto& p : corners) ++quarters[(p.x() >= 160.0F ? 1U : 0U) + (p.y() >= 120.0F ? 2U : 0U)];
  for (const int count : quarters) EXPECT_GT(count, 15);
}

TEST(FindCorners, LeavesOutWhereOneIsTakenAndCountsIt) {
  const cv::Mat image = Picture(320, 240, [](const Eigen::Vector2d& p) { return p; });
  const auto all = FindCorners(image, {}, 60);
  ASSERT_GT(all.size(), 20U);
  const std::vector<Eigen::Vector2f> taken(all.begin(), all.begin() + 15);
  const auto more = FindCorners(image, taken, 60);
  EXPECT_LE(more.size() + taken.size(), 60U);
  for (const auto& fresh : more) {
    for (const auto& old : taken) EXPECT_GT((fresh - old).norm(), 5.0F);
  }
}

TEST(FindCorners, FindsNoneInABlankImage) {
  EXPECT_TRUE(FindCorners(cv::Mat(100, 100, CV_8UC1, cv::Scalar(90)), {}, 50).empty());
}

TEST(PredictRotation, FindsAKnownTurnOfAFarScene) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(80, 60, 1.2);
  const auto view = [&](const Eigen::Matrix3d& R_WC) {
    return Picture(80, 60, [&](const Eigen::Vector2d& p) {
      const Eigen::Vector3d d = R_WC * camera.RayAtUnitDepth(p.x(), p.y());
      return Eigen::Vector2d(60.0 * d.x() / d.z(), 60.0 * d.y() / d.z());
    });
  };
  const Eigen::Matrix3d R_AB = RotationFromVector({0.03, -0.05, 0.02});
  const cv::Mat before = view(Eigen::Matrix3d::Identity());
  const cv::Mat after = view(R_AB.transpose());
  const auto found = PredictRotation(before, after, camera, Eigen::Matrix3d::Identity());
  ASSERT_TRUE(found);
  EXPECT_LT(Eigen::AngleAxisd(found->transpose() * R_AB).angle(), 0.002);
  EXPECT_LT(RotationError(before, after, camera, *found),
            0.2 * RotationError(before, after, camera, Eigen::Matrix3d::Identity()));
}

TEST(PredictRotation, HasNoAnswerForBlankImages) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(80, 60, 1.2);
  const cv::Mat blank(60, 80, CV_8UC1, cv::Scalar(100));
  EXPECT_FALSE(PredictRotation(blank, blank, camera, Eigen::Matrix3d::Identity()));
}

}  // namespace
}  // namespace thalweg::visual_odometry
