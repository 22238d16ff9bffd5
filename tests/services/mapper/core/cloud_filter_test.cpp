#include "services/mapper/core/cloud_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "docs/examples/own_filter.h"
#include "tests/services/mapper/core/small_clouds.h"
#include "tests/support/analytic_room.h"

namespace thalweg::mapper {
namespace {

using test::AnalyticRoom;
using test::kInfinity;
using test::kNaN;
using Type = FilterModel::Type;

/// A colored view of the room with pixels that were not measured and rays without a return.
PointCloud ViewOfRoom(std::mt19937& random) {
  const AnalyticRoom room = AnalyticRoom::Furnished();
  PointCloud cloud = room.Render(PinholeCamera::FromFieldOfView(40, 30, 1.3), room.RandomPose(random));
  std::normal_distribution<float> noise(0.0F, 0.02F);
  std::uniform_int_distribution<int> percent(0, 99);
  for (Eigen::Vector3f& p_C : cloud.points_C) {
    p_C *= 1.0F + noise(random);
    const int kind = percent(random);
    if (kind < 5) p_C.setConstant(kNaN);
    if (kind == 5) p_C = NoReturn();
    if (kind == 6) p_C *= 0.5F;  // flies between the camera and the surface
  }
  cloud.colors.resize(cloud.points_C.size(), Rgb{1, 2, 3});
  return cloud;
}

PointCloud Left(const FilterModel& options, PointCloud cloud) {
  MakeFilter(options)->Apply(cloud);
  return cloud;
}

bool IsDropped(const Eigen::Vector3f& p_C) {
  return std::isnan(p_C.x()) && std::isnan(p_C.y()) && std::isnan(p_C.z());
}

/// Expects that points that `keeps` names are left, bit for bit, and all others dropped.
template <class Keeps>
void ExpectLeft(const PointCloud& cloud, const PointCloud& left, Keeps keeps) {
  ASSERT_EQ(left.points_C.size(), cloud.points_C.size());
  EXPECT_EQ(left.width_px, cloud.width_px);
  EXPECT_EQ(left.height_px, cloud.height_px);
  EXPECT_EQ(left.colors, cloud.colors);
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    const Eigen::Vector3f& p_C = cloud.points_C[k];
    if (IsNoReturn(p_C)) {
      EXPECT_TRUE(IsNoReturn(left.points_C[k])) << k;
    } else if (p_C.hasNaN() || !keeps(k)) {
      EXPECT_TRUE(IsDropped(left.points_C[k])) << k;
    } else {
      EXPECT_EQ(left.points_C[k], p_C) << k;
    }
  }
}

TEST(CloudFilter, NoneIsNone) {
  EXPECT_EQ(MakeFilter({}), nullptr);
}

TEST(CloudFilter, DistanceDropsWhatIsFartherAway) {
  std::mt19937 random(1);
  const PointCloud cloud = ViewOfRoom(random);
  ExpectLeft(cloud, Left({.type = Type::kDistance, .max_distance = 3.0}, cloud),
             [&](std::size_t k) { return cloud.points_C[k].norm() <= 3.0F; });
}

TEST(CloudFilter, VoxelKeepsThePointOfEachCellThatIsNearestToTheirMean) {
  std::mt19937 random(2);
  const PointCloud cloud = ViewOfRoom(random);
  const double cell = 0.3;
  std::map<std::tuple<int, int, int>, std::vector<std::size_t>> cells;
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    if (!cloud.points_C[k].allFinite()) continue;
    const Eigen::Vector3d scaled = cloud.points_C[k].cast<double>() / cell;
    cells[{std::floor(scaled.x()), std::floor(scaled.y()), std::floor(scaled.z())}].push_back(k);
  }
  std::vector<bool> keeps(cloud.points_C.size(), false);
  for (const auto& [cell_index, points] : cells) {
    Eigen::Vector3d mean_C = Eigen::Vector3d::Zero();
    for (const std::size_t k : points) mean_C += cloud.points_C[k].cast<double>() / points.size();
    keeps[*std::ranges::min_element(points, {}, [&](std::size_t k) {
      return (cloud.points_C[k].cast<double>() - mean_C).norm();
    })] = true;
  }
  ASSERT_LT(cells.size(), cloud.points_C.size() / 2);
  ExpectLeft(cloud, Left({.type = Type::kVoxel, .cell = cell}, cloud),
             [&](std::size_t k) { return keeps[k]; });
}

TEST(CloudFilter, OutlierDropsWhatIsUnusuallyFarFromItsNeighbors) {
  std::mt19937 random(3);
  const PointCloud cloud = ViewOfRoom(random);
  const FilterModel options{.type = Type::kOutlier, .neighbors = 6, .deviations = 1.5};
  std::vector<std::size_t> measured;
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    if (cloud.points_C[k].allFinite()) measured.push_back(k);
  }
  std::vector<double> means(cloud.points_C.size());
  double mean = 0.0;
  for (const std::size_t k : measured) {
    std::vector<double> distances;
    for (const std::size_t other : measured) {
      if (other != k) distances.push_back((cloud.points_C[k] - cloud.points_C[other]).norm());
    }
    std::ranges::sort(distances);
    for (int n = 0; n < options.neighbors; ++n) means[k] += distances[n] / options.neighbors;
    mean += means[k] / measured.size();
  }
  double variance = 0.0;
  for (const std::size_t k : measured) variance += std::pow(means[k] - mean, 2) / (measured.size() - 1.0);
  const double limit = mean + options.deviations * std::sqrt(variance);
  const PointCloud left = Left(options, cloud);
  ExpectLeft(cloud, left, [&](std::size_t k) { return means[k] <= limit; });
  const auto dropped =
      std::ranges::count_if(measured, [&](std::size_t k) { return IsDropped(left.points_C[k]); });
  EXPECT_GT(dropped, 0);
  EXPECT_LT(dropped, static_cast<std::ptrdiff_t>(measured.size() / 10));
}

TEST(CloudFilter, TooFewPointsHaveNoOutliers) {
  PointCloud cloud{
      .width_px = 3, .height_px = 1, .points_C = {{0, 0, 1}, {0, 0.1F, 1}, {0, 9, 1}}, .colors = {}};
  ExpectLeft(cloud, Left({.type = Type::kOutlier, .neighbors = 3, .deviations = 0.0}, cloud),
             [](std::size_t) { return true; });
}

TEST(CloudFilter, CoordinatesBeyondEveryMapAreLeftToIt) {
  PointCloud cloud{.width_px = 5,
                   .height_px = 1,
                   .points_C = {{1e30F, 0, 1}, {0, -kInfinity, 1}, {0, 0, -1e30F}, {0, 0, 1}, {0, 0.01F, 1}},
                   .colors = {}};
  for (const Type type : {Type::kVoxel, Type::kOutlier}) {
    const PointCloud left = Left({.type = type, .cell = 0.001, .neighbors = 1, .deviations = 0.0}, cloud);
    for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(left.points_C[k], cloud.points_C[k]) << k;
  }
  PointCloud empty{.width_px = 0, .height_px = 0, .points_C = {}, .colors = {}};
  for (const Type type : {Type::kDistance, Type::kVoxel, Type::kOutlier}) {
    EXPECT_TRUE(Left({.type = type}, empty).points_C.empty());
  }
}

TEST(CloudFilter, ManyPointsInOnePlaceCountOnceEachAndTakeNoLonger) {
  PointCloud cloud{.width_px = 400, .height_px = 400, .points_C = {}, .colors = {}};
  // As many drivers write pixels that were not measured; then a wall, and a point far before it.
  cloud.points_C.resize(100'000, Eigen::Vector3f::Zero());
  for (int k = 0; k < 59'999; ++k) cloud.points_C.emplace_back(0.01F * (k % 245), 0.01F * (k / 245), 3.0F);
  cloud.points_C.emplace_back(1.0F, 1.0F, 1.5F);
  const PointCloud left = Left({.type = Type::kOutlier}, cloud);
  // All distances but one are 0 or about 1 cm.
  ExpectLeft(cloud, left, [](std::size_t k) { return k + 1 != 160'000; });
}

TEST(CloudFilter, RefusesOptionsThatMeanNothing) {
  EXPECT_THROW(MakeFilter({.max_distance = 0.0}), std::invalid_argument);
  EXPECT_THROW(MakeFilter({.max_distance = kNaN}), std::invalid_argument);
  EXPECT_THROW(MakeFilter({.cell = -1.0}), std::invalid_argument);
  EXPECT_THROW(MakeFilter({.cell = 1e-6}), std::invalid_argument) << "indices would overflow";
  EXPECT_THROW(MakeFilter({.neighbors = 0}), std::invalid_argument);
  EXPECT_THROW(MakeFilter({.deviations = -0.5}), std::invalid_argument);
}

TEST(OwnFilter, DropsWhatIsWithinTheBox) {
  const PointCloud cloud{
      .width_px = 4,
      .height_px = 1,
      .points_C = {{0.1F, -0.1F, 0.3F}, {0.1F, 0.3F, 0.3F}, {0.0F, 0.0F, 0.5F}, NoReturn()},
      .colors = {}};
  PointCloud left = cloud;
  ArmFilter(0.4F, 0.2F).Apply(left);
  ExpectLeft(cloud, left, [](std::size_t k) { return k != 0; });
}

}  // namespace
}  // namespace thalweg::mapper
