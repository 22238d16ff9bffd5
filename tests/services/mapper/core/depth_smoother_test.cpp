#include "services/mapper/core/depth_smoother.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <random>

#include "tests/services/mapper/core/small_clouds.h"

namespace thalweg::mapper {
namespace {

using test::kNaN;

constexpr int kSize = 60;  // [px]
constexpr double kDepthSigma = 0.02;

/// A cloud whose inverse depth is the given function of the pixel plus noise; a tenth of it is not measured.
PointCloud NoisyCloud(const std::function<double(int, int)>& inverse_depth) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, kDepthSigma);
  PointCloud cloud{.width_px = kSize, .height_px = kSize, .points_C = {}, .colors = {}};
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      const double z = 1.0 / (inverse_depth(u, v) + noise(random));
      const Eigen::Vector3d ray(0.01 * (u - kSize / 2), 0.01 * (v - kSize / 2), 1.0);
      cloud.points_C.push_back(random() % 10 == 0 ? Eigen::Vector3f::Constant(kNaN)
                                                  : Eigen::Vector3f((z * ray).cast<float>()));
    }
  }
  return cloud;
}

double Slanted(int u, int v) {
  return 0.5 + 0.004 * u - 0.002 * v;
}

struct Errors {
  double rms = 0.0;         ///< [1/m]
  double normalized = 0.0;  ///< Root mean square of the error divided by the reported sigma.
  std::size_t count = 0;
};

Errors ErrorsOf(const DepthSmoother& smoother, const std::function<double(int, int)>& truth,
                const std::function<bool(int, int)>& counts) {
  Errors errors;
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      const auto pixel = static_cast<std::size_t>(v * kSize + u);
      const auto value = static_cast<double>(smoother.inverse_depths()[pixel]);
      if (std::isnan(value) || !counts(u, v)) continue;
      const double error = value - truth(u, v);
      errors.rms += error * error;
      errors.normalized += std::pow(error / static_cast<double>(smoother.sigmas()[pixel]), 2.0);
      ++errors.count;
    }
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(errors.count));
  errors.normalized = std::sqrt(errors.normalized / static_cast<double>(errors.count));
  return errors;
}

bool Everywhere(int, int) {
  return true;
}

TEST(DepthSmoother, OnAPlaneErrorsShrinkWithTheWindowAndAreAsStated) {
  const PointCloud cloud = NoisyCloud(Slanted);
  double before = kDepthSigma;
  for (const int window : {3, 5, 11, 21}) {
    DepthSmoother smoother({.sigma = kDepthSigma, .window_px = window});
    smoother.Smooth(cloud);
    const Errors errors = ErrorsOf(smoother, Slanted, Everywhere);
    EXPECT_GT(errors.count, 0.85 * kSize * kSize);
    EXPECT_LT(errors.rms, 0.75 * before) << window;
    EXPECT_NEAR(errors.normalized, 1.0, 0.2) << window;
    before = errors.rms;
  }
}

TEST(DepthSmoother, IsLeastSquaresOverItsWindow) {
  const PointCloud cloud = NoisyCloud(Slanted);
  DepthSmoother smoother({.sigma = kDepthSigma, .window_px = 7});
  smoother.Smooth(cloud);
  int compared = 0;
  for (int v = 3; v < kSize - 3; ++v) {
    for (int u = 3; u < kSize - 3; ++u) {
      Eigen::MatrixX3d pixels(49, 3);
      Eigen::VectorXd values(49);
      int n = 0;
      for (int dv = -3; dv <= 3; ++dv) {
        for (int du = -3; du <= 3; ++du) {
          const Eigen::Vector3f& p_C = cloud.points_C[static_cast<std::size_t>((v + dv) * kSize + u + du)];
          if (std::isnan(p_C.z())) continue;
          pixels.row(n) << 1.0, du, dv;
          values[n++] = static_cast<double>(1.0F / p_C.z());
        }
      }
      const Eigen::Matrix3d normal = pixels.topRows(n).transpose() * pixels.topRows(n);
      const double sigma = kDepthSigma * std::sqrt(normal.inverse()(0, 0));
      const auto pixel = static_cast<std::size_t>(v * kSize + u);
      // By chance another window may have been chosen here; then sigma differs.
      if (std::abs(static_cast<double>(smoother.sigmas()[pixel]) - sigma) > 1e-6 * sigma) continue;
      const Eigen::Vector3d plane = pixels.topRows(n).colPivHouseholderQr().solve(values.head(n));
      EXPECT_NEAR(static_cast<double>(smoother.inverse_depths()[pixel]), plane[0], 1e-6);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1500);
}

TEST(DepthSmoother, AStepIsNotBlurred) {
  const auto step = [](int u, int) { return u < kSize / 2 ? 0.5 : 0.5 + 6 * kDepthSigma; };
  const auto beside = [](int u, int) { return std::abs(u - kSize / 2) < 6; };
  const PointCloud cloud = NoisyCloud(step);
  DepthSmoother smoother({.sigma = kDepthSigma, .window_px = 11});
  smoother.Smooth(cloud);
  const Errors errors = ErrorsOf(smoother, step, beside);
  EXPECT_LT(errors.rms, 0.5 * kDepthSigma);
  EXPECT_LT(errors.normalized, 1.5);
}

TEST(DepthSmoother, LeavesAloneWhatItCannotSmooth) {
  PointCloud cloud = NoisyCloud(Slanted);
  const auto as_measured = [&cloud](DepthErrorModel error) {
    DepthSmoother smoother(error);
    smoother.Smooth(cloud);
    for (std::size_t pixel = 0; pixel < cloud.points_C.size(); ++pixel) {
      const float z = cloud.points_C[pixel].z();
      const bool same = std::isnan(z) ? std::isnan(smoother.inverse_depths()[pixel])
                                      : smoother.inverse_depths()[pixel] == 1.0F / z &&
                                            smoother.sigmas()[pixel] == static_cast<float>(kDepthSigma);
      if (!same) return false;
    }
    return smoother.inverse_depths().size() == cloud.points_C.size();
  };
  EXPECT_TRUE(as_measured({.sigma = kDepthSigma, .window_px = 1}));
  EXPECT_FALSE(as_measured({.sigma = kDepthSigma, .window_px = 11}));
  cloud.points_C.pop_back();  // no longer organized
  EXPECT_TRUE(as_measured({.sigma = kDepthSigma, .window_px = 11}));
  cloud = {};
  EXPECT_TRUE(as_measured({.sigma = kDepthSigma, .window_px = 11}));
}

TEST(DepthSmoother, RefusesModelsThatMakeNoSense) {
  EXPECT_THROW(DepthSmoother({.sigma = 0.0}), std::invalid_argument);
  EXPECT_THROW(DepthSmoother({.sigma = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(DepthSmoother({.sigma = kDepthSigma, .window_px = 4}), std::invalid_argument);
  EXPECT_THROW(DepthSmoother({.sigma = kDepthSigma, .window_px = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::mapper
