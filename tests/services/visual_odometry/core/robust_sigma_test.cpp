#include "services/visual_odometry/core/robust_sigma.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <vector>

#include "common/base/median.h"

namespace thalweg::visual_odometry {
namespace {

constexpr double kSigma = 0.7;

/// The median of what residuals in two and in three dimensions give.
/// @param outliers  Share of the residuals that are far too long.
double SigmaOfMany(double outliers) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> error(0.0, kSigma);
  constexpr int kMany = 20'000;
  std::vector<double> sigmas;
  for (int n = 0; n < kMany; ++n) {
    Eigen::Vector3d residual(error(random), error(random), error(random));
    if (n < outliers * kMany) residual *= 1000.0;
    sigmas.push_back(SigmaByLength(residual.norm(), 3));
    sigmas.push_back(SigmaByLength(residual.head<2>().norm(), 2));
  }
  return Median(sigmas);
}

TEST(SigmaByLength, TheMedianOfManyIsTheStandardDeviationWhateverTheirDimensions) {
  EXPECT_NEAR(SigmaOfMany(0.0), kSigma, 0.02 * kSigma);
}

TEST(SigmaByLength, FewOutliersHardlyMatter) {
  EXPECT_NEAR(SigmaOfMany(0.05), kSigma, 0.06 * kSigma);
}

}  // namespace
}  // namespace thalweg::visual_odometry
