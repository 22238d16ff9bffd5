#include "services/explorer/core/field/harmonic_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "services/explorer/core/field/device/device_solver.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using testing::FieldMap;
using testing::FillBox;

DenseGrid<float> SolvedField(const FieldMap& map, const HarmonicField::Options& options = {}) {
  HarmonicField field;
  return field.Solve(map, options);
}

FieldMap FreeBox(int nx, int ny, int nz) {
  return FieldMap({{-3, 5, 2}, {-3 + nx, 5 + ny, 2 + nz}}, FieldCell::kFree);
}

TEST(HarmonicField, FallsLinearlyAlongALine) {
  for (const int axis : {0, 1, 2}) {
    for (const int n : {3, 4, 17, 300}) {
      FieldMap map = FreeBox(axis == 0 ? n : 1, axis == 1 ? n : 1, axis == 2 ? n : 1);
      map[std::size_t{0}] = FieldCell::kSource;
      map[map.size() - 1] = FieldCell::kSink;
      const DenseGrid<float> phi = SolvedField(map);
      for (std::size_t i = 0; i < phi.size(); ++i) {
        EXPECT_NEAR(phi[i], 1.0 - 2.0 * static_cast<double>(i) / (n - 1), 1e-5)
            << "cell " << i << " of " << n;
      }
    }
  }
}

TEST(HarmonicField, FallsLinearlyBetweenTwoPlates) {
  FieldMap map = FreeBox(41, 12, 9);
  const VoxelBox& box = map.box();
  FillBox(map, {box.min, {box.min.x + 1, box.max.y, box.max.z}}, FieldCell::kSource);
  FillBox(map, {{box.max.x - 1, box.min.y, box.min.z}, box.max}, FieldCell::kSink);
  const DenseGrid<float> phi = SolvedField(map);
  for (std::size_t i = 0; i < phi.size(); ++i) {
    EXPECT_NEAR(phi[i], 1.0 - (map.IndexAt(i).x - box.min.x) / 20.0, 5e-6);
  }
  const auto inflow = HarmonicField::InflowOf(map, phi, DenseGrid<std::int32_t>(box, 0), 1);
  EXPECT_NEAR(inflow[0], 12 * 9 / 20.0, 1e-4);  // area times slope
}

TEST(HarmonicField, InflowIsGivenByGroup) {
  FieldMap map = FreeBox(31, 4, 1);
  DenseGrid<std::int32_t> group(map.box(), -1);
  const VoxelIndex& min = map.box().min;
  FillBox(map, {{min.x, min.y + 2, min.z}, {min.x + 31, min.y + 3, min.z + 1}}, FieldCell::kWall);
  // Two channels from a common source; the lower one is three times as wide as it is long.
  FillBox(map, {{min.x + 10, min.y, min.z}, {min.x + 11, min.y + 4, min.z + 1}}, FieldCell::kSource);
  FillBox(map, {{min.x, min.y, min.z}, {min.x + 1, min.y + 2, min.z + 1}}, FieldCell::kSink);
  FillBox(map, {{min.x + 30, min.y + 3, min.z}, {min.x + 31, min.y + 4, min.z + 1}}, FieldCell::kSink);
  group[min] = 0;
  group[min + VoxelIndex{0, 1, 0}] = 0;
  group[min + VoxelIndex{30, 3, 0}] = 1;
  const auto inflow = HarmonicField::InflowOf(map, SolvedField(map), group, 2);
  EXPECT_NEAR(inflow[0], 2 * 2.0 / 10.0, 1e-5);
  EXPECT_NEAR(inflow[1], 1 * 2.0 / 20.0, 1e-5);
}

TEST(HarmonicField, AWeakSinkTakesAtItsOwnLevelAndGivesToALowerOne) {
  // A line: source, `before` faces, weak sink, `after` faces, sink.
  for (const double weight : {0.25, 0.5, 1.0}) {
    for (const auto& [before, after] : {std::pair{10, 20}, {20, 4}}) {
      FieldMap map = FreeBox(before + after + 1, 1, 1);
      map[std::size_t{0}] = FieldCell::kSource;
      map[static_cast<std::size_t>(before)] = FieldCell::kWeakSink;
      map[map.size() - 1] = FieldCell::kSink;
      const DenseGrid<float> phi = SolvedField(map, {.relative_residual = 1e-8, .weak_sink = weight});
      const double steep = (1.0 + weight) / before;
      const double flat = (1.0 - weight) / after;
      for (int i = 0; i <= before + after; ++i) {
        const double expected = i <= before ? 1.0 - i * steep : -weight - (i - before) * flat;
        EXPECT_NEAR(phi[static_cast<std::size_t>(i)], expected, 1e-5);
      }
      DenseGrid<std::int32_t> group(map.box(), 0);
      group[map.size() - 1] = 1;
      const auto inflow = HarmonicField::InflowOf(map, phi, group, 2);
      EXPECT_NEAR(inflow[0], steep - flat, 1e-5);
      EXPECT_NEAR(inflow[1], flat, 1e-5);
    }
  }
}

/// Root mean square difference from phi = a + b / r between a source ball and a sink outside a sphere.
double ShellError(int inner, int outer) {
  const int edge = 2 * outer + 3;
  FieldMap map = FreeBox(edge, edge, edge);
  const Eigen::Vector3d center = VoxelCenter(map.box().min, 1.0) + Eigen::Vector3d::Constant(outer + 1);
  const auto radius = [&](std::size_t i) { return (VoxelCenter(map.IndexAt(i), 1.0) - center).norm(); };
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (radius(i) <= inner) map[i] = FieldCell::kSource;
    if (radius(i) >= outer) map[i] = FieldCell::kSink;
  }
  const DenseGrid<float> phi = SolvedField(map);
  const double b = 2.0 / (1.0 / inner - 1.0 / outer);
  const double a = 1.0 - b / inner;
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] != FieldCell::kFree) continue;
    const double error = phi[i] - (a + b / radius(i));
    squares += error * error;
    ++count;
  }
  return std::sqrt(squares / static_cast<double>(count));
}

TEST(HarmonicField, ConvergesToTheSphericalShellAsTheGridIsRefined) {
  const double coarse = ShellError(6, 15);
  const double medium = ShellError(12, 30);
  const double fine = ShellError(24, 60);
  EXPECT_LT(coarse, 0.1);  // the ball is a staircase, so errors are of the order of a cell over its radius
  EXPECT_LT(medium, 0.75 * coarse);
  EXPECT_LT(fine, 0.4 * coarse);
}

TEST(HarmonicField, ScreenedLineIsTheDiscreteHyperbolicCosine) {
  const int n = 60;
  FieldMap map = FreeBox(n, 1, 1);
  map[std::size_t{0}] = FieldCell::kSource;
  const double length = 7.5;
  const DenseGrid<float> phi =
      SolvedField(map, {.relative_residual = 1e-8, .screening_length_cells = length});
  const double rate = std::acosh(1.0 + 0.5 / (length * length));
  for (int i = 0; i < n; ++i) {  // symmetric about the face of the wall at the far end
    const double expected = std::cosh(rate * (n - 0.5 - i)) / std::cosh(rate * (n - 0.5));
    EXPECT_NEAR(phi[static_cast<std::size_t>(i)], expected, 1e-6);
  }
}

TEST(HarmonicField, IsNanInWallsAndOneAndMinusOneWhereGiven) {
  std::mt19937 random(3);
  FieldMap map = testing::RandomBoxes({{0, 0, 0}, {20, 20, 20}}, 60, 8, random);
  testing::PlaceSinks(map, 5, 3, random);
  testing::PlaceSource(map, 2, random);
  const DenseGrid<float> phi = SolvedField(map);
  ASSERT_EQ(phi.box(), map.box());
  for (std::size_t i = 0; i < map.size(); ++i) {
    EXPECT_EQ(std::isnan(phi[i]), map[i] == FieldCell::kWall);
    if (map[i] == FieldCell::kSource) {
      EXPECT_EQ(phi[i], 1.0F);
    }
    if (map[i] == FieldCell::kSink) {
      EXPECT_EQ(phi[i], -1.0F);
    }
  }
}

TEST(HarmonicField, CellsThatNothingReachesAreZeroAndNoUnknowns) {
  FieldMap map = FreeBox(9, 5, 5);
  const VoxelIndex& min = map.box().min;
  FillBox(map, {{min.x + 4, min.y, min.z}, {min.x + 5, min.y + 5, min.z + 5}}, FieldCell::kWall);
  map[min] = FieldCell::kSource;
  HarmonicField field;
  const DenseGrid<float>& phi = field.Solve(map, {});
  EXPECT_EQ(field.statistics().unknowns, 4U * 25U - 1U);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const int x = map.IndexAt(i).x - min.x;
    if (x < 4) {
      EXPECT_NEAR(phi[i], 1.0, 1e-5);
    }
    if (x > 4) {
      EXPECT_EQ(phi[i], 0.0F);
    }
  }
}

TEST(HarmonicField, WithOnlySourcesOrOnlySinksIsConstant) {
  for (const FieldCell given : {FieldCell::kSource, FieldCell::kSink}) {
    FieldMap map = FreeBox(30, 20, 10);
    map[std::size_t{777}] = given;
    const DenseGrid<float> phi = SolvedField(map);
    for (std::size_t i = 0; i < map.size(); ++i) {
      EXPECT_NEAR(phi[i], given == FieldCell::kSource ? 1.0 : -1.0, 1e-4);
    }
  }
}

TEST(HarmonicField, WithoutUnknownsOnlyCopiesWhatIsGiven) {
  HarmonicField field;
  EXPECT_EQ(field.Solve(FieldMap(), {}).size(), 0U);
  EXPECT_EQ(field.statistics().unknowns, 0U);
  EXPECT_TRUE(
      std::isnan(field.Solve(FieldMap({{0, 0, 0}, {3, 3, 3}}, FieldCell::kWall), {})[std::size_t{0}]));
  FieldMap pair({{0, 0, 0}, {2, 1, 1}}, FieldCell::kSource);
  pair[std::size_t{1}] = FieldCell::kSink;
  EXPECT_EQ(field.Solve(pair, {})[std::size_t{1}], -1.0F);
  EXPECT_EQ(field.statistics().iterations, 0);
  const FieldMap free({{0, 0, 0}, {4, 4, 4}}, FieldCell::kFree);
  for (const double screening : {0.0, 3.0}) {
    EXPECT_EQ(field.Solve(free, {.screening_length_cells = screening})[std::size_t{5}], 0.0F);
  }
}

TEST(HarmonicField, ASingleCellIsTheMeanOfItsNeighbors) {
  FieldMap map = FreeBox(3, 1, 2);
  map[std::size_t{0}] = FieldCell::kSource;
  map[std::size_t{2}] = FieldCell::kSource;
  map[std::size_t{4}] = FieldCell::kSink;
  map[std::size_t{3}] = map[std::size_t{5}] = FieldCell::kWall;
  EXPECT_NEAR(SolvedField(map)[std::size_t{1}], 1.0 / 3.0, 1e-6);
}

TEST(HarmonicField, ASourceBesideASinkDoesNotDisturbTheRest) {
  FieldMap map = FreeBox(12, 1, 1);
  map[std::size_t{4}] = FieldCell::kSource;
  map[std::size_t{5}] = FieldCell::kSink;
  const DenseGrid<float> phi = SolvedField(map);
  EXPECT_NEAR(phi[std::size_t{0}], 1.0, 1e-5);
  EXPECT_NEAR(phi[std::size_t{11}], -1.0, 1e-5);
  EXPECT_EQ(HarmonicField::InflowOf(map, phi, DenseGrid<std::int32_t>(map.box(), 0), 1)[0], 2.0);
}

/// Where there is a GPU, its results are compared in device/solver_test.cpp.
TEST(HarmonicField, SaysWhyThereIsNoGpu) {
  HarmonicField field;
  FieldMap map = FreeBox(12, 1, 1);
  map[std::size_t{4}] = FieldCell::kSource;
  map[std::size_t{9}] = FieldCell::kSink;
  std::string why;
  if (field::device::OpenDeviceSolver(why)) {
    field.Solve(map, {.solver = HarmonicField::Solver::kGpu});
    EXPECT_TRUE(field.statistics().on_gpu);
    return;
  }
  EXPECT_THAT([&] { field.Solve(map, {.solver = HarmonicField::Solver::kGpu}); },
              ::testing::ThrowsMessage<std::runtime_error>(why));
  EXPECT_THAT([] { HarmonicField::RequireGpu(); },
              ::testing::ThrowsMessage<std::invalid_argument>(::testing::HasSubstr(why)));
  field.Solve(map, {.solver = HarmonicField::Solver::kAutomatic});
  EXPECT_FALSE(field.statistics().on_gpu);
}

TEST(HarmonicField, OneSolverServesBoxesOfAnySizeInTurn) {
  HarmonicField field;
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    for (const int edge : {40, 12, 25}) {
      std::mt19937 random(seed);
      FieldMap map = testing::RandomBoxes({{0, 0, 0}, {edge, edge, edge}}, edge, 9, random);
      testing::PlaceSinks(map, 4, 2, random);
      testing::PlaceSource(map, 1, random);
      const DenseGrid<float>& reused = field.Solve(map, {});
      const DenseGrid<float> fresh = SolvedField(map);
      for (std::size_t i = 0; i < map.size(); ++i) {
        if (map[i] != FieldCell::kWall) {
          EXPECT_EQ(reused[i], fresh[i]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace thalweg::explorer
