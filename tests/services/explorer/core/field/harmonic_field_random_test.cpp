#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <string>

#include "services/explorer/core/field/harmonic_field.h"
#include "tests/services/explorer/core/field/named_map.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using test::NamedMap;
using test::Reached;
using testing::FieldMap;

constexpr double kWeak = 0.3;

/// Maps of every topology, small enough for a direct solver, with and without weak sinks.
std::vector<NamedMap> SmallMaps() {
  std::vector<NamedMap> maps;
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    std::mt19937 random(seed);
    const auto add = [&](const std::string& name, FieldMap map, int sinks, int radius) {
      testing::PlaceSinks(map, sinks, 3, random);
      testing::PlaceSource(map, radius, random);
      FieldMap weaker = map;
      testing::PlaceSinks(weaker, sinks, 3, random, FieldCell::kWeakSink);
      maps.push_back({name + " " + std::to_string(seed), std::move(map)});
      maps.push_back({name + " " + std::to_string(seed) + ", weak sinks", std::move(weaker)});
    };
    add("boxes", testing::RandomBoxes({{-5, 0, 3}, {16, 18, 17}}, 30, 8, random), 6, 2);
    add("cells", testing::RandomCells({{0, 0, 0}, {19, 18, 15}}, 0.55, random), 8, 2);
    add("thin maze", testing::Maze({7, 7, 3}, 1, 1, random), 2, 0);
    add("wide maze", testing::Maze({5, 4, 3}, 3, 1, random), 3, 1);
    add("rooms", testing::FurnishedBuilding::Generate({30, 26, 16}, random), 5, 2);
    add("pocket", testing::RandomBoxes({{0, 0, 0}, {4, 4, 4}}, 3, 2, random), 1, 0);
  }
  return maps;
}

/// The same field computed by Eigen's sparse Cholesky decomposition in double precision; 0 in unconnected
/// cells.
DenseGrid<double> DirectSolution(const FieldMap& map, double screening_length) {
  const DenseGrid<std::uint8_t> reached = Reached(map);
  DenseGrid<int> number(map.box(), -1);
  int count = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (reached[i] != 0) number[i] = count++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (reached[i] == 0) continue;
    double diagonal = screening_length > 0.0 ? 1.0 / (screening_length * screening_length) : 0.0;
    for (const VoxelIndex& d : kFaceNeighbors) {
      const VoxelIndex next = map.IndexAt(i) + d;
      const FieldCell cell = map.Get(next, FieldCell::kWall);
      if (cell == FieldCell::kWall) continue;
      diagonal += 1.0;
      if (cell == FieldCell::kFree) entries.emplace_back(number[i], number[next], -1.0);
      if (cell == FieldCell::kSource) b[number[i]] += 1.0;
      if (cell == FieldCell::kSink) b[number[i]] -= 1.0;
      if (cell == FieldCell::kWeakSink) b[number[i]] -= kWeak;
    }
    entries.emplace_back(number[i], number[i], diagonal);
  }
  DenseGrid<double> phi(map.box(), 0.0);
  if (count == 0) return phi;
  Eigen::SparseMatrix<double> a(count, count);
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd x = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(a).solve(b);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (reached[i] != 0) phi[i] = x[number[i]];
  }
  return phi;
}

double TotalInflow(const FieldMap& map, const DenseGrid<float>& phi) {
  return HarmonicField::InflowOf(map, phi, DenseGrid<std::int32_t>(map.box(), 0), 1)[0];
}

/// Flux out of the sources: the inflow into them, with all signs reversed.
double TotalOutflow(const FieldMap& map, const DenseGrid<float>& phi) {
  FieldMap turned = map;
  DenseGrid<float> minus = phi;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] == FieldCell::kSource) turned[i] = FieldCell::kSink;
    if (IsSink(map[i])) turned[i] = FieldCell::kSource;
    minus[i] = -phi[i];
  }
  return TotalInflow(turned, minus);
}

TEST(HarmonicFieldOnRandomMaps, EqualsADirectSolver) {
  for (const NamedMap& m : SmallMaps()) {
    for (const double screening : {0.0, 4.0}) {
      SCOPED_TRACE(m.name + ", screening " + std::to_string(screening));
      HarmonicField field;
      const DenseGrid<float>& phi = field.Solve(
          m.map, {.relative_residual = 1e-8, .screening_length_cells = screening, .weak_sink = kWeak});
      EXPECT_LE(field.statistics().relative_residual, 1e-8);
      const DenseGrid<double> expected = DirectSolution(m.map, screening);
      double worst = 0.0;
      for (std::size_t i = 0; i < m.map.size(); ++i) {
        if (m.map[i] == FieldCell::kFree) worst = std::max(worst, std::abs(phi[i] - expected[i]));
      }
      EXPECT_LT(worst, 1e-5);
    }
  }
}

TEST(HarmonicFieldOnRandomMaps, AFormerFieldOfASmallerMapLeadsToTheSameOneSooner) {
  int cold = 0;
  int warm = 0;
  for (const NamedMap& m : SmallMaps()) {
    SCOPED_TRACE(m.name);
    HarmonicField field;
    const DenseGrid<float> phi = field.Solve(m.map, {});
    cold += field.statistics().iterations;
    HarmonicField again;
    again.Solve(m.map, {}, phi);
    EXPECT_LE(again.statistics().iterations, 1) << "it begins at the solution";

    FieldMap smaller = m.map;  // without its last two planes of x
    for (std::size_t k = 0; k < smaller.size(); ++k) {
      if (smaller.IndexAt(k).x >= smaller.box().max.x - 2) smaller[k] = FieldCell::kWall;
    }
    const DenseGrid<float> former = HarmonicField().Solve(smaller, {});
    const DenseGrid<float>& warmed = again.Solve(m.map, {}, former);
    warm += again.statistics().iterations;
    EXPECT_LE(again.statistics().relative_residual, 1e-6);
    for (std::size_t k = 0; k < m.map.size(); ++k) {
      if (m.map[k] != FieldCell::kFree) continue;
      ASSERT_NEAR(warmed[k], phi[k], 1e-3);
    }
  }
  EXPECT_LT(warm, cold);
}

TEST(HarmonicFieldOnRandomMaps, ObeysTheDiscreteMaximumPrinciple) {
  for (const NamedMap& m : SmallMaps()) {
    SCOPED_TRACE(m.name);
    HarmonicField field;
    const DenseGrid<float>& phi = field.Solve(m.map, {.relative_residual = 1e-8});
    for (std::size_t i = 0; i < m.map.size(); ++i) {
      if (m.map[i] != FieldCell::kFree) continue;
      float low = 2.0F;
      float high = -2.0F;
      for (const VoxelIndex& d : kFaceNeighbors) {
        const VoxelIndex next = m.map.IndexAt(i) + d;
        if (m.map.Get(next, FieldCell::kWall) == FieldCell::kWall) continue;
        low = std::min(low, phi[next]);
        high = std::max(high, phi[next]);
      }
      if (low > high) continue;  // isolated between walls
      EXPECT_GE(phi[i], low - 1e-6F);
      EXPECT_LE(phi[i], high + 1e-6F);
    }
  }
}

TEST(HarmonicFieldOnRandomMaps, WhatLeavesTheSourceArrivesInTheSinks) {
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
    FieldMap map = testing::ExplorationScene({70, 60, 30}, seed);
    std::mt19937 random(seed);
    if (seed > 2) testing::PlaceSinks(map, 20, 4, random, FieldCell::kWeakSink);
    for (const double accuracy : {1e-6, 1e-8}) {
      HarmonicField field;
      const DenseGrid<float>& phi = field.Solve(map, {.relative_residual = accuracy, .weak_sink = kWeak});
      const double out = TotalOutflow(map, phi);
      EXPECT_NEAR(TotalInflow(map, phi) / out, 1.0, 1e-6) << "seed " << seed << ", accuracy " << accuracy;
    }
  }
}

TEST(HarmonicFieldOnRandomMaps, NeedsNoMoreIterationsForMoreUnknowns) {
  for (const VoxelIndex& size : {VoxelIndex{36, 36, 20}, {75, 75, 30}, {130, 130, 50}}) {
    HarmonicField field;
    field.Solve(testing::ExplorationScene(size, 5), {});
    EXPECT_LE(field.statistics().iterations, 15) << field.statistics().unknowns << " unknowns";
    EXPECT_LE(field.statistics().relative_residual, 1e-6);
  }
}

TEST(HarmonicFieldOnRandomMaps, IsTheSameForAnyNumberOfThreads) {
  std::mt19937 random(11);
  FieldMap cells = testing::RandomCells({{0, 0, 0}, {60, 50, 40}}, 0.6, random);
  testing::PlaceSinks(cells, 20, 3, random);
  testing::PlaceSource(cells, 2, random);
  for (const FieldMap& map : {testing::ExplorationScene({80, 70, 40}, 9), cells}) {
    HarmonicField one;
    one.Solve(map, {.threads = 1});
    for (const int threads : {2, 3}) {
      HarmonicField many;
      many.Solve(map, {.threads = threads});
      EXPECT_EQ(many.statistics().iterations, one.statistics().iterations);
      std::size_t different = 0;
      for (std::size_t i = 0; i < map.size(); ++i) {
        different += map[i] != FieldCell::kWall && one.phi()[i] != many.phi()[i] ? 1 : 0;
      }
      EXPECT_EQ(different, 0U) << threads << " threads";
    }
  }
}

TEST(HarmonicFieldOnRandomMaps, AWarmStartSavesIterationsAndChangesNothingElse) {
  const FieldMap map = testing::ExplorationScene({60, 60, 30}, 2);
  HarmonicField cold;
  cold.Solve(map, {.relative_residual = 1e-7});
  // The former field covers less, and did not yet have the cells that are sinks now.
  const VoxelBox& box = map.box();
  DenseGrid<float> former({box.min + VoxelIndex{-4, 3, 5}, box.max + VoxelIndex{-7, 2, 0}}, 0.0F);
  for (std::size_t i = 0; i < former.size(); ++i) {
    former[i] = cold.phi().Get(former.IndexAt(i), std::numeric_limits<float>::quiet_NaN());
  }
  HarmonicField warm;
  warm.Solve(map, {.relative_residual = 1e-7}, former);
  HarmonicField again;
  again.Solve(map, {.relative_residual = 1e-6}, cold.phi());
  EXPECT_LE(again.statistics().iterations, 2);
  double worst = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] == FieldCell::kWall) continue;
    worst = std::max(worst, std::abs(static_cast<double>(warm.phi()[i]) - cold.phi()[i]));
  }
  EXPECT_LT(worst, 1e-5);
}

}  // namespace
}  // namespace thalweg::explorer
