#include "services/explorer/core/field/relaxation.h"

#include <gtest/gtest.h>

#include <Eigen/SparseLU>
#include <cmath>
#include <string>
#include <vector>

#include "tests/services/explorer/core/field/named_map.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using test::NamedMap;
using test::Reached;
using testing::FieldMap;
using Sweep = RelaxationOptions::Sweep;
using Walls = RelaxationOptions::Walls;

constexpr FieldCell kFree = FieldCell::kFree;
constexpr FieldCell kSource = FieldCell::kSource;
constexpr FieldCell kSink = FieldCell::kSink;
constexpr FieldCell kWall = FieldCell::kWall;

/// A plan of one layer, the first row being y = 0.
FieldMap Plan(const std::vector<std::vector<FieldCell>>& rows) {
  const auto width = static_cast<int>(rows.front().size());
  FieldMap map({{0, 0, 0}, {width, static_cast<int>(rows.size()), 1}}, kWall);
  for (int y = 0; y < static_cast<int>(rows.size()); ++y) {
    for (int x = 0; x < width; ++x)
      map[{x, y, 0}] = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
  }
  return map;
}

double AfterOneSweep(const FieldMap& map, const VoxelIndex& cell, Walls walls = Walls::kMirrored) {
  return Relax(map, {.sweep = Sweep::kJacobi, .walls = walls, .max_sweeps = 1}).phi[cell];
}

TEST(PrintedStencil, InTheOpenIsTheMeanOfTheNeighbors) {
  const FieldMap plan = Plan({{kWall, kSource, kWall}, {kFree, kFree, kSink}, {kWall, kSource, kWall}});
  EXPECT_EQ(AfterOneSweep(plan, {1, 1, 0}), (1.0 + 0.0 - 1.0 + 1.0) / 4.0);
  FieldMap space({{0, 0, 0}, {3, 3, 3}}, kFree);
  space[{0, 1, 1}] = space[{2, 1, 1}] = space[{1, 0, 1}] = kSource;
  space[{1, 1, 2}] = kSink;
  EXPECT_DOUBLE_EQ(AfterOneSweep(space, {1, 1, 1}), (3.0 - 1.0) / 6.0);
}

TEST(PrintedStencil, BesideAWallTakesTheOppositeNeighborTwice) {
  const FieldMap plan = Plan({{kWall, kSink, kWall}, {kSource, kFree, kWall}, {kWall, kFree, kWall}});
  EXPECT_EQ(AfterOneSweep(plan, {1, 1, 0}), (2.0 * 1.0 - 1.0 + 0.0) / 4.0);
  EXPECT_EQ(AfterOneSweep(plan, {1, 1, 0}, Walls::kDropped), (1.0 - 1.0 + 0.0) / 3.0);
}

// The printed example: at a corner in 2D phi = (2 phi_{x-1} + 2 phi_{y-1}) / 4.
TEST(PrintedStencil, InACornerTakesBothNeighborsTwice) {
  const FieldMap plan = Plan({{kWall, kFree}, {kSource, kFree}});
  EXPECT_EQ(AfterOneSweep(plan, {1, 1, 0}), (2.0 * 1.0 + 2.0 * 0.0) / 4.0);
  FieldMap space({{0, 0, 0}, {2, 2, 2}}, kFree);
  space[{0, 1, 1}] = space[{1, 0, 1}] = kSource;
  space[{1, 1, 0}] = kSink;
  EXPECT_DOUBLE_EQ(AfterOneSweep(space, {1, 1, 1}), (2.0 + 2.0 - 2.0) / 6.0);
}

TEST(PrintedStencil, BetweenTwoWallsLeavesTheirAxisOut) {
  const FieldMap plan = Plan({{kSource, kFree, kSink}});
  EXPECT_EQ(AfterOneSweep(plan, {1, 0, 0}), 0.0);
  const FieldMap end = Plan({{kSource, kFree}});
  EXPECT_EQ(AfterOneSweep(end, {1, 0, 0}), 1.0);
  EXPECT_EQ(AfterOneSweep(Plan({{kFree}}), {0, 0, 0}), 0.0) << "alone";
}

TEST(Relaxation, JacobiReadsTheLastSweepAndGaussSeidelTheNewestValues) {
  const FieldMap row = Plan({{kSource, kFree, kFree, kFree, kSink}});
  const DenseGrid<double> jacobi = Relax(row, {.sweep = Sweep::kJacobi, .max_sweeps = 1}).phi;
  const DenseGrid<double> seidel = Relax(row, {.sweep = Sweep::kGaussSeidel, .max_sweeps = 1}).phi;
  EXPECT_EQ((std::vector{jacobi[1], jacobi[2], jacobi[3]}), (std::vector{0.5, 0.0, -0.5}));
  EXPECT_EQ((std::vector{seidel[1], seidel[2], seidel[3]}), (std::vector{0.5, 0.25, -0.375}));
}

TEST(Relaxation, StopsAtTheFirstSweepInWhichNoValueChangesByMoreThanItsShare) {
  std::mt19937 random(3);
  FieldMap map = testing::RandomBoxes({{0, 0, 0}, {16, 14, 12}}, 20, 5, random);
  testing::PlaceSinks(map, 4, 3, random);
  testing::PlaceSource(map, 0, random);
  for (const Sweep sweep : {Sweep::kJacobi, Sweep::kGaussSeidel}) {
    const Relaxation stopped = Relax(map, {.sweep = sweep});
    ASSERT_TRUE(stopped.stopped);
    ASSERT_GT(stopped.sweeps, 20);
    const auto largest_change = [&](int sweeps) {  // in the sweep of that number
      const DenseGrid<double> before = Relax(map, {.sweep = sweep, .max_sweeps = sweeps - 1}).phi;
      const DenseGrid<double> after = Relax(map, {.sweep = sweep, .max_sweeps = sweeps}).phi;
      double largest = 0.0;
      for (std::size_t k = 0; k < map.size(); ++k) {
        if (map[k] != kFree || after[k] == before[k]) continue;
        largest = std::max(largest, std::abs((after[k] - before[k]) / before[k]));
      }
      return largest;
    };
    EXPECT_LT(largest_change(stopped.sweeps), 1e-4);
    EXPECT_GE(largest_change(stopped.sweeps - 1), 1e-4);
  }
}

TEST(Relaxation, BesideTheLargestValueItStopsWhereNoValueChangesByMoreThanThat) {
  const FieldMap row = Plan({{kSource, kFree, kFree, kFree, kFree, kFree, kFree, kFree, kSink}});
  const RelaxationOptions options{.beside = RelaxationOptions::Beside::kLargestValue};
  const Relaxation stopped = Relax(row, options);
  ASSERT_TRUE(stopped.stopped);
  const auto largest_change = [&](int sweeps) {  // in the sweep of that number
    const DenseGrid<double> before = Relax(row, {.max_sweeps = sweeps - 1}).phi;
    const DenseGrid<double> after = Relax(row, {.max_sweeps = sweeps}).phi;
    double largest = 0.0;
    for (std::size_t k = 1; k + 1 < row.size(); ++k)
      largest = std::max(largest, std::abs(after[k] - before[k]));
    return largest;
  };
  EXPECT_LT(largest_change(stopped.sweeps), 1e-4);
  EXPECT_GE(largest_change(stopped.sweeps - 1), 1e-4);
  EXPECT_LT(stopped.sweeps, Relax(row, {}).sweeps) << "the middle is 0 in the end";
}

TEST(Relaxation, StopsAtItsBoundAndSaysSo) {
  const FieldMap row = Plan({{kSource, kFree, kFree, kFree, kSink}});
  const Relaxation bounded = Relax(row, {.max_sweeps = 3});
  EXPECT_EQ(bounded.sweeps, 3);
  EXPECT_FALSE(bounded.stopped);
}

std::vector<NamedMap> MapsWithoutWeakSinks() {
  std::vector<NamedMap> maps;
  for (const std::uint32_t seed : {1U, 2U}) {
    std::mt19937 random(seed);
    const auto add = [&](const std::string& name, FieldMap map, int sinks, int radius) {
      testing::PlaceSinks(map, sinks, 3, random);
      testing::PlaceSource(map, radius, random);
      maps.push_back({name + " " + std::to_string(seed), std::move(map)});
    };
    add("boxes", testing::RandomBoxes({{-5, 0, 3}, {13, 14, 13}}, 25, 6, random), 6, 2);
    add("cells", testing::RandomCells({{0, 0, 0}, {14, 13, 12}}, 0.6, random), 8, 0);
    add("thin maze", testing::Maze({4, 4, 2}, 1, 1, random), 2, 0);
  }
  return maps;
}

// The multigrid's stencil leaves walls out of the mean.
TEST(Relaxation, JacobiAndGaussSeidelReachThePhiOfTheMultigrid) {
  for (const NamedMap& named : MapsWithoutWeakSinks()) {
    HarmonicField multigrid;
    const DenseGrid<float>& phi = multigrid.Solve(named.map, {.relative_residual = 1e-7});
    for (const Sweep sweep : {Sweep::kJacobi, Sweep::kGaussSeidel}) {
      const Relaxation relaxed =
          Relax(named.map, {.sweep = sweep, .walls = Walls::kDropped, .largest_change = 1e-9});
      ASSERT_TRUE(relaxed.stopped) << named.name;
      double largest = 0.0;
      for (std::size_t k = 0; k < named.map.size(); ++k) {
        if (named.map[k] == kWall) {
          EXPECT_TRUE(std::isnan(relaxed.phi[k]));
          continue;
        }
        largest = std::max(largest, std::abs(relaxed.phi[k] - static_cast<double>(phi[k])));
      }
      EXPECT_LT(largest, 1e-4) << named.name << (sweep == Sweep::kJacobi ? ", Jacobi" : ", Gauss-Seidel");
    }
  }
}

/// The printed equations, of all cells at once, by Eigen's sparse LU decomposition.
DenseGrid<double> DirectSolutionOfThePrintedEquations(const FieldMap& map) {
  const DenseGrid<std::uint8_t> reached = Reached(map);
  DenseGrid<int> number(map.box(), -1);
  int count = 0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (reached[k] != 0) number[k] = count++;
  }
  const auto open = [&](const VoxelIndex& i) { return map.Get(i, kWall) != kWall; };
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (number[k] < 0) continue;
    const VoxelIndex i = map.IndexAt(k);
    const auto add = [&](const VoxelIndex& j, double weight) {
      entries.emplace_back(number[k], number[k], weight);
      if (number[j] >= 0) {
        entries.emplace_back(number[k], number[j], -weight);
      } else {
        right[number[k]] += weight * (map[j] == kSource ? 1.0 : -1.0);
      }
    };
    for (const VoxelIndex& step : {VoxelIndex{1, 0, 0}, VoxelIndex{0, 1, 0}, VoxelIndex{0, 0, 1}}) {
      const VoxelIndex up = i + step;
      const VoxelIndex down = i - step;
      if (open(up)) add(up, open(down) ? 1.0 : 2.0);
      if (open(down)) add(down, open(up) ? 1.0 : 2.0);
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd solution = solver.solve(right);
  DenseGrid<double> phi(map.box(), 0.0);
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (number[k] >= 0) phi[k] = solution[number[k]];
  }
  return phi;
}

TEST(Relaxation, WithMirroredWallsReachesTheSolutionOfThePrintedEquations) {
  for (const NamedMap& named : MapsWithoutWeakSinks()) {
    const DenseGrid<double> direct = DirectSolutionOfThePrintedEquations(named.map);
    for (const Sweep sweep : {Sweep::kJacobi, Sweep::kGaussSeidel}) {
      const Relaxation relaxed = Relax(named.map, {.sweep = sweep, .largest_change = 1e-10});
      double largest = 0.0;
      for (std::size_t k = 0; k < named.map.size(); ++k) {
        if (named.map[k] == kFree) largest = std::max(largest, std::abs(relaxed.phi[k] - direct[k]));
      }
      EXPECT_LT(largest, 1e-5) << named.name;
    }
  }
}

}  // namespace
}  // namespace thalweg::explorer
