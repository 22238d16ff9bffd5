/// The bodies of the device's kernels, run on the CPU by HostExecution, against the CPU's own solver; where
/// this build and this machine have a GPU, the GPU's results, too.
#include "services/explorer/core/field/device/solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "services/explorer/core/field/device/host_execution.h"
#include "services/explorer/core/field/harmonic_field.h"
#include "services/explorer/core/field/relaxation.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using field::device::DeviceSolver;
using field::device::HostExecution;
using testing::FieldMap;
using Twin = field::device::Solver<HostExecution>;

struct Solved {
  DenseGrid<float> phi;
  DeviceSolver::Outcome outcome;
};

Solved SolveWith(DeviceSolver& solver, const FieldMap& map, const DeviceSolver::Parameters& parameters = {}) {
  Solved solved{.phi = DenseGrid<float>(map.box(), 7.0F), .outcome = {}};
  const VoxelBox& box = map.box();
  const int size[3] = {box.size_x(), box.size_y(), box.size_z()};
  solved.outcome =
      solver.Solve(reinterpret_cast<const std::uint8_t*>(map.data()), size, parameters, solved.phi.data());
  return solved;
}

/// Both stop below the same residual, which leaves each with an error of some ten to a hundred times it.
void ExpectSameField(DeviceSolver& solver, const FieldMap& map, double screening_length_cells = 0.0) {
  constexpr double kResidual = 1e-6;
  constexpr float kError = 1e-4F;
  const double k = screening_length_cells > 0.0 ? 1.0 / screening_length_cells : 0.0;
  const Solved solved =
      SolveWith(solver, map,
                {.relative_residual = kResidual, .screening = static_cast<float>(k * k), .weak_sink = -0.5F});
  HarmonicField reference;
  const DenseGrid<float>& phi = reference.Solve(map, {.relative_residual = kResidual,
                                                      .screening_length_cells = screening_length_cells,
                                                      .weak_sink = 0.5,
                                                      .solver = HarmonicField::Solver::kCpu});
  EXPECT_EQ(solved.outcome.unknowns, reference.statistics().unknowns);
  EXPECT_LE(solved.outcome.relative_residual, kResidual);
  EXPECT_LE(solved.outcome.iterations, reference.statistics().iterations + 2);
  std::size_t off = 0;
  for (std::size_t i = 0; i < phi.size(); ++i) {
    const bool same =
        std::isnan(phi[i]) ? std::isnan(solved.phi[i]) : std::abs(phi[i] - solved.phi[i]) < kError;
    off += same ? 0 : 1;
  }
  EXPECT_EQ(off, 0U) << "of " << phi.size() << " cells";
}

/// Every kind of map: blocks of several parts, corridors of one cell, parts that nothing reaches, open space.
std::vector<FieldMap> Maps() {
  std::vector<FieldMap> maps;
  for (std::uint32_t seed = 0; seed < 3; ++seed) {
    std::mt19937 random(seed);
    maps.push_back(testing::RandomCells({{-4, 3, 9}, {27, 28, 30}}, 0.5, random));
    testing::PlaceSource(maps.back(), 1, random);
    testing::PlaceSinks(maps.back(), 5, 3, random);
    maps.push_back(testing::RandomBoxes({{0, 0, 0}, {50, 43, 22}}, 60, 12, random));
    testing::PlaceSource(maps.back(), 1, random);
    testing::PlaceSinks(maps.back(), 4, 2, random, FieldCell::kWeakSink);
    maps.push_back(testing::Maze({9, 9, 3}, 1, 1, random));
    testing::PlaceSource(maps.back(), 0, random);
    testing::PlaceSinks(maps.back(), 4, 1, random);
  }
  maps.push_back(testing::ExplorationScene({80, 70, 20}, 5));
  return maps;
}

TEST(DeviceSolver, OnTheCpuFindsTheFieldOfTheCpusSolver) {
  Twin twin;  // one for all, so that its buffers hold what another map has left
  for (const FieldMap& map : Maps()) ExpectSameField(twin, map);
}

TEST(DeviceSolver, OnTheCpuScreens) {
  Twin twin;
  for (const double length : {3.0, 30.0}) ExpectSameField(twin, Maps().back(), length);
}

TEST(DeviceSolver, OnTheCpuFallsLinearlyAlongALine) {
  Twin twin;
  for (const int axis : {0, 1, 2}) {
    for (const int n : {2, 3, 4, 17, 300}) {
      FieldMap map({{0, 0, 0}, {axis == 0 ? n : 1, axis == 1 ? n : 1, axis == 2 ? n : 1}}, FieldCell::kFree);
      map[std::size_t{0}] = FieldCell::kSource;
      map[map.size() - 1] = FieldCell::kSink;
      const Solved solved = SolveWith(twin, map);
      for (std::size_t i = 0; i < map.size(); ++i) {
        EXPECT_NEAR(solved.phi[i], 1.0 - 2.0 * static_cast<double>(i) / (n - 1), 1e-5) << i << " of " << n;
      }
    }
  }
}

TEST(DeviceSolver, OnTheCpuLeavesWhatNothingReaches) {
  Twin twin;
  FieldMap map({{0, 0, 0}, {12, 12, 12}}, FieldCell::kWall);
  testing::FillBox(map, {{2, 2, 2}, {9, 9, 9}}, FieldCell::kFree);
  const Solved alone = SolveWith(twin, map);
  EXPECT_EQ(alone.outcome.unknowns, 0U);
  EXPECT_EQ(alone.outcome.iterations, 0);
  EXPECT_EQ((alone.phi[VoxelIndex{5, 5, 5}]), 0.0F);
  EXPECT_TRUE(std::isnan(alone.phi[VoxelIndex{0, 0, 0}]));
  const FieldMap walls({{0, 0, 0}, {5, 5, 5}}, FieldCell::kWall);
  EXPECT_EQ(SolveWith(twin, walls).outcome.unknowns, 0U);
}

/// Changes go on for sweeps after single precision has lost them, so the numbers of sweeps differ.
TEST(DeviceSolver, OnTheCpuRelaxesAsTheThesisDoes) {
  Twin twin;
  const FieldMap map = testing::ExplorationScene({24, 20, 8}, 2);
  const VoxelBox& box = map.box();
  const int size[3] = {box.size_x(), box.size_y(), box.size_z()};
  DenseGrid<float> phi(box, 7.0F);
  const DeviceSolver::Relaxed relaxed =
      twin.Relax(reinterpret_cast<const std::uint8_t*>(map.data()), size, 1e-5F, 100'000, phi.data());
  EXPECT_TRUE(relaxed.stopped);
  const Relaxation reference =
      Relax(map, {.sweep = RelaxationOptions::Sweep::kJacobi, .largest_change = 1e-5});
  EXPECT_NEAR(relaxed.sweeps, reference.sweeps, 0.1 * reference.sweeps + DeviceSolver::kSweepsAtOnce);
  for (std::size_t i = 0; i < phi.size(); ++i) {
    if (std::isnan(reference.phi[i])) {
      EXPECT_TRUE(std::isnan(phi[i]));
    } else {
      EXPECT_NEAR(phi[i], reference.phi[i], 5e-3);
    }
  }
}

class OnGpu : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string why;
    solver_ = field::device::OpenDeviceSolver(why);
    if (!solver_) GTEST_SKIP() << why;
  }
  std::unique_ptr<DeviceSolver> solver_;
};

TEST_F(OnGpu, TheFieldIsThatOfTheCpusSolver) {
  for (const FieldMap& map : Maps()) ExpectSameField(*solver_, map);
  ExpectSameField(*solver_, Maps().back(), 20.0);
  ExpectSameField(*solver_, testing::ExplorationScene({220, 200, 32}, 3));
}

TEST_F(OnGpu, TwoSolvesGiveTheSameBits) {
  const FieldMap map = testing::ExplorationScene({120, 100, 24}, 4);
  const Solved first = SolveWith(*solver_, map);
  const Solved second = SolveWith(*solver_, map);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (std::isnan(first.phi[i])) continue;
    EXPECT_EQ(first.phi[i], second.phi[i]);
  }
}

TEST_F(OnGpu, JacobiSweepsAreThoseOfTheCpu) {
  const FieldMap map = testing::ExplorationScene({70, 50, 12}, 2);
  const VoxelBox& box = map.box();
  const int size[3] = {box.size_x(), box.size_y(), box.size_z()};
  const auto* const cells = reinterpret_cast<const std::uint8_t*>(map.data());
  DenseGrid<float> phi(box, 7.0F), twins(box, 7.0F);
  Twin twin;
  solver_->Relax(cells, size, 1e-9F, 64, phi.data());
  twin.Relax(cells, size, 1e-9F, 64, twins.data());
  for (std::size_t i = 0; i < phi.size(); ++i) {
    if (std::isnan(twins[i])) continue;
    EXPECT_NEAR(phi[i], twins[i], 1e-6);
  }
}

}  // namespace
}  // namespace thalweg::explorer
