#include "services/explorer/core/field/descent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "services/explorer/core/field/relaxation.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

constexpr double kSize = 0.1;

/// Circles about the z axis, once in 2 pi, and rises: a helix.
std::optional<Eigen::Vector3d> Helix(const Eigen::Vector3d& p) {
  return Eigen::Vector3d(-p.y(), p.x(), 0.3);
}

double ErrorAfter(double length, Integrator integrator, int steps) {
  Eigen::Vector3d p(1.0, 0.0, 0.0);
  for (int n = 0; n < steps; ++n) p = *StepAlong(integrator, Helix, p, length / steps);
  return (p - Eigen::Vector3d(std::cos(length), std::sin(length), 0.3 * length)).norm();
}

TEST(StepAlong, ConvergesWithTheOrderOfItsMethod) {
  const std::pair<Integrator, double> orders[] = {
      {Integrator::kEuler, 1.0}, {Integrator::kImprovedEuler, 2.0}, {Integrator::kRungeKutta4, 4.0}};
  for (const auto& [integrator, order] : orders) {
    for (const int steps : {80, 160, 320}) {
      const double coarse = ErrorAfter(2.0, integrator, steps);
      const double fine = ErrorAfter(2.0, integrator, 2 * steps);
      EXPECT_NEAR(std::log2(coarse / fine), order, 0.05) << steps;
    }
  }
}

TEST(StepAlong, ImprovedEulerIsThePrintedFormula) {
  const Eigen::Vector3d p(0.4, -0.7, 0.2);
  const double h = 0.3;
  const Eigen::Vector3d expected = p + h / 2.0 * (*Helix(p) + *Helix(p + h * *Helix(p)));
  EXPECT_EQ(*StepAlong(Integrator::kImprovedEuler, Helix, p, h), expected);
}

TEST(StepAlong, EndsWhereTheFieldIsNotDefined) {
  const auto half = [](const Eigen::Vector3d& p) {
    return p.x() < 1.0 ? std::optional<Eigen::Vector3d>({1.0, 0.0, 0.0}) : std::nullopt;
  };
  for (const Integrator integrator : {Integrator::kImprovedEuler, Integrator::kRungeKutta4}) {
    EXPECT_TRUE(StepAlong(integrator, half, {0.5, 0.0, 0.0}, 0.4));
    EXPECT_FALSE(StepAlong(integrator, half, {0.5, 0.0, 0.0}, 1.2));
  }
  EXPECT_FALSE(StepAlong(Integrator::kEuler, half, {1.5, 0.0, 0.0}, 0.1));
}

// Central differences are exact for a quadratic, and its gradient is linear.
TEST(GradientField, IsExactBetweenTheCentersForAQuadratic) {
  const VoxelBox box{{-6, -5, -4}, {6, 7, 8}};
  const DenseGrid<FieldCell> cells(box, FieldCell::kFree);
  DenseGrid<double> phi(box, 0.0);
  for (std::size_t k = 0; k < phi.size(); ++k) {
    const Eigen::Vector3d c = VoxelCenter(phi.IndexAt(k), kSize);
    phi[k] = 2.0 * c.x() * c.x() - c.y() * c.y() + 3.0 * c.z() - c.z() * c.z();
  }
  const GradientField gradient(cells, phi, kSize);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inside(-0.25, 0.25);
  for (int n = 0; n < 200; ++n) {
    const Eigen::Vector3d p(inside(random), inside(random), inside(random));
    const Eigen::Vector3d expected(4.0 * p.x(), -2.0 * p.y(), 3.0 - 2.0 * p.z());
    ASSERT_TRUE(gradient.At(p));
    EXPECT_LT((*gradient.At(p) - expected).norm(), 1e-9);
    EXPECT_LT((*gradient.Downhill(p) + expected.normalized()).norm(), 1e-9);
  }
}

TEST(GradientField, HasNoSlopeIntoAWall) {
  DenseGrid<FieldCell> cells({{0, 0, 0}, {5, 5, 5}}, FieldCell::kFree);
  DenseGrid<double> phi(cells.box(), 0.0);
  for (std::size_t k = 0; k < phi.size(); ++k) {
    const VoxelIndex i = phi.IndexAt(k);
    phi[k] = i.x + 10.0 * i.y + 100.0 * i.z;
  }
  cells[{3, 2, 2}] = FieldCell::kWall;
  phi[{3, 2, 2}] = std::numeric_limits<double>::quiet_NaN();
  const GradientField gradient(cells, phi, 1.0);
  EXPECT_EQ(gradient.AtCenter({2, 2, 2}), Eigen::Vector3d(0.0, 10.0, 100.0));
  EXPECT_EQ(gradient.AtCenter({1, 2, 2}), Eigen::Vector3d(1.0, 10.0, 100.0));
  EXPECT_EQ(gradient.AtCenter({0, 0, 4}), Eigen::Vector3d::Zero())
      << "at an edge of the grid, a wall on each axis";
  EXPECT_TRUE(gradient.At({3.1, 2.5, 2.5})) << "beside the wall's face";
  EXPECT_FALSE(gradient.At({3.5, 2.5, 2.5})) << "at its center";
}

TEST(FollowDescent, GoesStraightThroughACorridor) {
  DenseGrid<FieldCell> cells({{0, 0, 0}, {40, 5, 5}}, FieldCell::kFree);
  ForEachVoxel({{39, 0, 0}, {40, 5, 5}}, [&](const VoxelIndex& i) { cells[i] = FieldCell::kSink; });
  cells[{3, 2, 2}] = FieldCell::kSource;
  const Relaxation solved = Relax(cells, {.largest_change = 1e-8});
  for (const Integrator integrator :
       {Integrator::kEuler, Integrator::kImprovedEuler, Integrator::kRungeKutta4}) {
    const Streamline line = FollowDescent(cells, solved.phi, kSize, {3, 2, 2}, {.integrator = integrator});
    EXPECT_EQ(line.end, StreamlineEnd::kArrived);
    EXPECT_EQ(line.points_W.front(), VoxelCenter({3, 2, 2}, kSize));
    EXPECT_EQ(VoxelAt(line.points_W.back(), kSize).x, 39);
    for (const Eigen::Vector3d& p_W : line.points_W) {
      EXPECT_NEAR(p_W.y(), 0.25, 1e-6);
      EXPECT_NEAR(p_W.z(), 0.25, 1e-6);
    }
  }
}

TEST(FollowDescent, BeginsTowardsTheLowestNeighborAndStaysWhereThereIsAGradient) {
  int arrived = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    testing::FieldMap map = testing::RandomBoxes({{0, 0, 0}, {18, 16, 12}}, 16, 6, random);
    testing::PlaceSinks(map, 4, 3, random);
    testing::PlaceSource(map, 0, random);
    VoxelIndex start;
    for (std::size_t k = 0; k < map.size(); ++k) {
      if (map[k] == FieldCell::kSource) start = map.IndexAt(k);
    }
    const Relaxation solved = Relax(map, {.largest_change = 1e-6});
    const GradientField gradient(map, solved.phi, kSize);
    const Streamline line = FollowDescent(map, solved.phi, kSize, start, {});
    const auto cell_at = [&](const Eigen::Vector3d& p_W) {
      return map.Get(VoxelAt(p_W, kSize), FieldCell::kWall);
    };
    for (const Eigen::Vector3d& p_W : line.points_W) EXPECT_TRUE(gradient.At(p_W));
    EXPECT_EQ(line.end == StreamlineEnd::kArrived, cell_at(line.points_W.back()) == FieldCell::kSink);
    arrived += line.end == StreamlineEnd::kArrived ? 1 : 0;
    if (line.points_W.size() < 2) continue;
    const double first = solved.phi[VoxelAt(line.points_W[1], kSize)];
    for (const VoxelIndex& step : kFaceNeighbors) {
      if (map.Get(start + step, FieldCell::kWall) == FieldCell::kWall) continue;
      EXPECT_LE(first, solved.phi[start + step]);
    }
  }
  EXPECT_GE(arrived, 15) << "of 20; the others end in corners";
}

TEST(FollowDescent, IsStuckWhereNoSinkIsConnected) {
  DenseGrid<FieldCell> cells({{0, 0, 0}, {9, 3, 3}}, FieldCell::kFree);
  ForEachVoxel({{5, 0, 0}, {6, 3, 3}}, [&](const VoxelIndex& i) { cells[i] = FieldCell::kWall; });
  cells[{1, 1, 1}] = FieldCell::kSource;
  cells[{8, 1, 1}] = FieldCell::kSink;
  const Relaxation solved = Relax(cells, {});
  // What the sweeps leave of a slope leads nowhere.
  const Streamline line = FollowDescent(cells, solved.phi, kSize, {1, 1, 1}, {});
  EXPECT_NE(line.end, StreamlineEnd::kArrived);
}

}  // namespace
}  // namespace thalweg::explorer
