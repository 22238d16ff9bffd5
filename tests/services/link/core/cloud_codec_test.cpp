#include "services/link/core/cloud_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/geometry/pinhole_camera.h"

namespace thalweg::link {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// What a pinhole camera sees of the plane n . p = d.
PointCloud PlaneSeenBy(const PinholeCamera& camera, const Eigen::Vector3d& n, double d) {
  PointCloud cloud{.width_px = camera.width_px, .height_px = camera.height_px, .points_C = {}, .colors = {}};
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector3d ray = camera.RayAtUnitDepth(u, v);
      cloud.points_C.push_back((ray * (d / n.dot(ray))).cast<float>());
    }
  }
  return cloud;
}

/// Encodes and decodes with a coder and a decoder of their own.
PointCloud AcrossTheLink(CloudEncoder& encoder, const PointCloud& cloud, std::size_t* bytes = nullptr) {
  const CodedCloud coded = encoder.Encode(cloud);
  CloudDecoder decoder;
  if (coded.table) {
    EXPECT_FALSE(decoder.SetTable(*coded.table));
  }
  if (bytes != nullptr) *bytes = coded.bytes.size();
  const auto decoded = decoder.Decode(coded.bytes);
  EXPECT_TRUE(decoded) << decoded.error();
  return decoded ? *decoded : PointCloud();
}

TEST(CloudCodec, MovesNoPointOfAPlaneByMoreThanHalfAStepInDepth) {
  const auto camera = PinholeCamera::FromFieldOfView(100, 80, 1.5);
  const PointCloud cloud = PlaneSeenBy(camera, Eigen::Vector3d(0.3, -0.2, 0.93).normalized(), 2.3);
  CloudEncoder encoder({.depth_step = 0.005});
  std::size_t bytes = 0;
  const PointCloud decoded = AcrossTheLink(encoder, cloud, &bytes);
  ASSERT_EQ(decoded.points_C.size(), cloud.points_C.size());
  EXPECT_EQ(decoded.width_px, 100);
  EXPECT_EQ(decoded.height_px, 80);
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    EXPECT_NEAR(decoded.points_C[k].z(), cloud.points_C[k].z(), 0.0025 + 1e-5);
    // The point stays on its ray.
    const Eigen::Vector3f off = decoded.points_C[k].normalized() - cloud.points_C[k].normalized();
    EXPECT_LT(off.norm(), 1e-5F);
  }
  // 8000 pixels on a plane: rounding is all that is left to say.
  EXPECT_LT(bytes, 8000U * 3 / 8);
}

TEST(CloudCodec, KeepsWhatIsNotMeasuredAndWhatHasNoReturn) {
  const auto camera = PinholeCamera::FromFieldOfView(40, 30, 1.2);
  PointCloud cloud = PlaneSeenBy(camera, Eigen::Vector3d::UnitZ(), 3.0);
  std::mt19937 random(5);
  std::vector<int> kinds;
  for (Eigen::Vector3f& p_C : cloud.points_C) {
    const int kind = static_cast<int>(random() % 4);
    kinds.push_back(kind);
    if (kind == 0) p_C = Eigen::Vector3f::Constant(kNaN);
    if (kind == 1) p_C = NoReturn();
    if (kind == 2) p_C *= 2.0F + static_cast<float>(random() % 1000) / 10.0F;  // far from what is expected
  }
  CloudEncoder encoder({});
  const PointCloud decoded = AcrossTheLink(encoder, cloud);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (kinds[k] == 0) {
      EXPECT_TRUE(decoded.points_C[k].array().isNaN().all());
    } else if (kinds[k] == 1) {
      EXPECT_TRUE(IsNoReturn(decoded.points_C[k]));
    } else {
      EXPECT_NEAR(decoded.points_C[k].z(), cloud.points_C[k].z(), 0.0026F + 1e-6F * cloud.points_C[k].z());
    }
  }
}

TEST(CloudCodec, FitsASensorThatIsNoPinholeCameraByATableOfItsOwn) {
  constexpr int kWidth = 32;
  constexpr int kHeight = 24;
  std::mt19937 random(6);
  PointCloud cloud{.width_px = kWidth, .height_px = kHeight, .points_C = {}, .colors = {}};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double yaw = 0.04 * (u - 16) + 0.002 * (v - 12);  // a fisheye that is rolled
      const double pitch = 0.04 * (v - 12) - 0.002 * (u - 16);
      const double depth = 1.0 + 1e-3 * static_cast<double>(random() % 4000);
      cloud.points_C.emplace_back(std::tan(yaw) * depth, std::tan(pitch) * depth, depth);
    }
  }
  CloudEncoder encoder({.depth_step = 0.002});
  const PointCloud decoded = AcrossTheLink(encoder, cloud);
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    EXPECT_LT((decoded.points_C[k] - cloud.points_C[k]).norm(), 0.001 * 1.6 + 1e-5);
  }
  // The table crosses once: the next cloud has the same.
  const CodedCloud first = encoder.Encode(cloud);
  for (Eigen::Vector3f& p_C : cloud.points_C) p_C *= 1.1F;
  EXPECT_EQ(encoder.Encode(cloud).table, first.table);
}

TEST(CloudCodec, LearnsDirectionsOfPixelsThatAreMeasuredLater) {
  PointCloud cloud{.width_px = 2, .height_px = 2, .points_C = {}, .colors = {}};
  cloud.points_C = {{0.1F, 0.2F, 1.0F}, {0.5F, 0.1F, 1.0F}, {0.3F, 0.9F, 1.0F}, {kNaN, kNaN, kNaN}};
  CloudEncoder encoder({});
  const auto first = encoder.Encode(cloud).table;
  cloud.points_C[0] = {kNaN, kNaN, kNaN};
  cloud.points_C[3] = {1.4F, 1.2F, 2.0F};
  const auto second = encoder.Encode(cloud).table;
  EXPECT_NE(first, second);
  cloud.points_C = {{0.2F, 0.4F, 2.0F}, {0.5F, 0.1F, 1.0F}, {0.3F, 0.9F, 1.0F}, {0.7F, 0.6F, 1.0F}};
  EXPECT_EQ(encoder.Encode(cloud).table, second);
  const PointCloud decoded = AcrossTheLink(encoder, cloud);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_LT((decoded.points_C[k] - cloud.points_C[k]).norm(), 0.006F);
}

TEST(CloudCodec, RoundsThePointsOfOtherCloudsAndMergesEqualOnes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-20.0F, 20.0F);
  PointCloud cloud{.width_px = 3001, .height_px = 1, .points_C = {}, .colors = {}};
  for (int k = 0; k < 3000; ++k)
    cloud.points_C.emplace_back(uniform(random), uniform(random), uniform(random));
  cloud.points_C.emplace_back(cloud.points_C[7]);
  CloudEncoder encoder({.point_step = 0.01});
  std::size_t bytes = 0;
  const PointCloud decoded = AcrossTheLink(encoder, cloud, &bytes);
  EXPECT_EQ(decoded.points_C.size(), 3000U);
  for (const Eigen::Vector3f& p_C : cloud.points_C) {
    float nearest = 1e9F;
    for (const Eigen::Vector3f& other : decoded.points_C) {
      nearest = std::min(nearest, (other - p_C).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(nearest, 0.005F + 1e-4F);
  }
  EXPECT_LT(bytes, 3000U * 6);
}

TEST(CloudCodec, ColorsCrossOnlyIfAskedFor) {
  const auto camera = PinholeCamera::FromFieldOfView(20, 10, 1.2);
  PointCloud cloud = PlaneSeenBy(camera, Eigen::Vector3d::UnitZ(), 3.0);
  cloud.points_C[3] = Eigen::Vector3f::Constant(kNaN);
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    cloud.colors.push_back({static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(3 * k), 250});
  }
  CloudEncoder plain({});
  EXPECT_TRUE(AcrossTheLink(plain, cloud).colors.empty());
  CloudEncoder colored({.colors = true});
  const PointCloud decoded = AcrossTheLink(colored, cloud);
  ASSERT_EQ(decoded.colors.size(), cloud.colors.size());
  for (std::size_t k = 0; k < cloud.colors.size(); ++k) {
    if (k == 3) continue;
    EXPECT_EQ(decoded.colors[k], cloud.colors[k]);
  }
  // Points without order take their colors along.
  const PointCloud two{.width_px = 2,
                       .height_px = 1,
                       .points_C = {{2.0F, 0.0F, -1.0F}, {1.0F, 0.0F, 1.0F}},
                       .colors = {{1, 2, 3}, {4, 5, 6}}};
  const PointCloud sorted = AcrossTheLink(colored, two);
  ASSERT_EQ(sorted.points_C.size(), 2U);
  EXPECT_NEAR(sorted.points_C[0].x(), 1.0F, 1e-5F);
  EXPECT_EQ(sorted.colors, (std::vector<Rgb>{{4, 5, 6}, {1, 2, 3}}));
}

TEST(CloudCodec, ACloudWithoutAnyPointStaysOne) {
  PointCloud cloud{.width_px = 3, .height_px = 1, .points_C = {}, .colors = {}};
  cloud.points_C.assign(3, Eigen::Vector3f::Constant(kNaN));
  CloudEncoder encoder({});
  const PointCloud decoded = AcrossTheLink(encoder, cloud);
  ASSERT_EQ(decoded.points_C.size(), 1U);
  EXPECT_TRUE(decoded.points_C[0].array().isNaN().all());
}

TEST(CloudCodec, RefusesACloudWhoseTableHasNotArrived) {
  const auto camera = PinholeCamera::FromFieldOfView(20, 10, 1.2);
  CloudEncoder encoder({});
  const CodedCloud coded = encoder.Encode(PlaneSeenBy(camera, Eigen::Vector3d::UnitZ(), 3.0));
  const auto decoded = CloudDecoder().Decode(coded.bytes);
  ASSERT_FALSE(decoded);
  EXPECT_NE(decoded.error().find("ray table"), std::string::npos);
}

TEST(CloudCodec, GarbledBytesGiveACloudOfTheSameSizeOrAReason) {
  const auto camera = PinholeCamera::FromFieldOfView(20, 10, 1.2);
  CloudEncoder encoder({.colors = true});
  PointCloud cloud = PlaneSeenBy(camera, Eigen::Vector3d(0.1, 0.2, 1.0).normalized(), 3.0);
  cloud.colors.assign(cloud.points_C.size(), Rgb{1, 2, 3});
  const CodedCloud coded = encoder.Encode(cloud);
  CloudDecoder decoder;
  ASSERT_FALSE(decoder.SetTable(*coded.table));
  std::mt19937 random(8);
  int refused = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    Buffer bad = coded.bytes;
    for (int change = 0; change < 3; ++change)
      bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    if (random() % 4 == 0) bad.resize(random() % bad.size());
    const auto decoded = decoder.Decode(bad);
    if (decoded) {
      EXPECT_TRUE(bad[0] % 2 != 0 || decoded->points_C.size() == 200U);
    } else {
      ++refused;
      EXPECT_FALSE(decoded.error().empty());
    }
    Buffer table = *coded.table;
    table[random() % table.size()] = static_cast<std::uint8_t>(random());
    const auto other = RayTable::Decode(table);
    EXPECT_TRUE(other || !other.error().empty());
  }
  EXPECT_GT(refused, 10'000);
}

}  // namespace
}  // namespace thalweg::link
