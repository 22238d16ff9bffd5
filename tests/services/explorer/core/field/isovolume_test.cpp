#include "services/explorer/core/field/isovolume.h"

#include <gtest/gtest.h>

#include <cmath>

#include "services/explorer/core/field/relaxation.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using testing::FieldMap;

/// A corridor: free cells up to the robot at x = 6, free cells beyond it, and a frontier at x = 9.
FieldMap Corridor() {
  FieldMap map({{0, 0, 0}, {10, 1, 1}}, FieldCell::kFree);
  map[{6, 0, 0}] = FieldCell::kSource;
  map[{9, 0, 0}] = FieldCell::kSink;
  return map;
}

DenseGrid<double> After(int sweeps, const FieldMap& map) {
  return Relax(map, {.sweep = RelaxationOptions::Sweep::kJacobi, .max_sweeps = sweeps}).phi;
}

DenseGrid<double> Converged(const FieldMap& map) {
  const Relaxation relaxed =
      Relax(map, {.walls = RelaxationOptions::Walls::kDropped, .largest_change = 1e-15});
  EXPECT_TRUE(relaxed.stopped);
  return relaxed.phi;
}

std::size_t CountOf(const DenseGrid<std::uint8_t>& found) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < found.size(); ++k) count += found[k];
  return count;
}

FieldMap RandomMap(unsigned seed) {
  std::mt19937 random(seed);
  FieldMap map({{0, 0, 0}, {9, 8, 4}}, FieldCell::kFree);
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (random() % 100 < 35) map[k] = FieldCell::kWall;
  }
  testing::PlaceSource(map, 0, random);
  for (int n = 0; n < 3; ++n) {
    const VoxelIndex at = testing::RandomCell(map.box(), random);
    if (map[at] == FieldCell::kFree) map[at] = FieldCell::kSink;
  }
  return map;
}

TEST(Isovolume, IsTheDeadEndWhichUnfinishedSweepsHaveNotReached) {
  const FieldMap map = Corridor();
  const DenseGrid<double> phi = After(3, map);
  ASSERT_EQ(phi[(VoxelIndex{0, 0, 0})], 0.0);
  EXPECT_EQ(FindIsovolume(map, phi, {0, 0, 0}).size(), 3U);  // the cells at 0
  EXPECT_EQ(FindIsovolume(map, phi, {5, 0, 0}).size(), 6U);  // down to them
}

TEST(Isovolume, HoldsNoSink) {
  const FieldMap map = Corridor();
  EXPECT_TRUE(FindIsovolume(map, After(3, map), {7, 0, 0}).empty());
  EXPECT_TRUE(FindIsovolume(map, After(3, map), {9, 0, 0}).empty());
}

TEST(Isovolume, IsNotBegunInAWall) {
  FieldMap map = Corridor();
  map[{2, 0, 0}] = FieldCell::kWall;
  EXPECT_TRUE(FindIsovolume(map, After(3, map), {2, 0, 0}).empty());
  EXPECT_TRUE(FindIsovolume(map, After(3, map), {-1, 0, 0}).empty());
}

TEST(Isovolume, OfTheExactFieldIsNothingWhereASinkCanBeReached) {
  const FieldMap corridor = Corridor();
  DenseGrid<double> phi(corridor.box(), 1.0);  // on the robot's side
  phi[{7, 0, 0}] = 1.0 / 3.0;
  phi[{8, 0, 0}] = -1.0 / 3.0;
  phi[{9, 0, 0}] = -1.0;
  EXPECT_EQ(CountOf(AllIsovolumes(corridor, phi)), 0U);
}

TEST(Isovolume, OfAConvergedFieldIsWhatRoundingLeftOfAPlateau) {
  const FieldMap corridor = Corridor();
  DenseGrid<double> phi = Converged(corridor);
  ASSERT_LT((phi[{0, 0, 0}]), 1.0);  // it rose from 0
  ASSERT_GT((phi[{0, 0, 0}]), 1.0 - 1e-9);
  EXPECT_EQ(CountOf(AllIsovolumes(corridor, phi)), 6U);
  for (std::size_t k = 0; k < phi.size(); ++k) phi[k] = std::round(phi[k] * 1e9) / 1e9;
  EXPECT_EQ(CountOf(AllIsovolumes(corridor, phi)), 0U);
}

TEST(Isovolume, OfAConvergedFieldIsEverythingWhereNoSinkCanBeReached) {
  FieldMap map = Corridor();
  map[{8, 0, 0}] = FieldCell::kWall;
  const DenseGrid<std::uint8_t> found = AllIsovolumes(map, Converged(map));
  for (int x = 0; x < 10; ++x) EXPECT_EQ((found[{x, 0, 0}]), x < 8 ? 1 : 0) << x;
}

TEST(Isovolume, AllTogetherAreTheUnionOverAllSeeds) {
  std::size_t found_in_all = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const FieldMap map = RandomMap(seed);
    const DenseGrid<double> phi = After(static_cast<int>(seed % 8), map);
    DenseGrid<std::uint8_t> expected(map.box(), 0);
    for (std::size_t k = 0; k < map.size(); ++k) {
      for (const VoxelIndex& i : FindIsovolume(map, phi, map.IndexAt(k))) expected[i] = 1;
    }
    const DenseGrid<std::uint8_t> found = AllIsovolumes(map, phi);
    for (std::size_t k = 0; k < map.size(); ++k) EXPECT_EQ(found[k], expected[k]) << seed << ", cell " << k;
    found_in_all += CountOf(found);
  }
  EXPECT_GT(found_in_all, 500U);
}

}  // namespace
}  // namespace thalweg::explorer
