#include "services/explorer/core/field/streamline.h"

#include <gtest/gtest.h>

#include <string>

#include "common/voxel/ray.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using testing::FieldMap;

constexpr double kCell = 0.1;

void ExpectWithinFreeSpace(const FieldMap& map, const Streamline& line) {
  for (std::size_t k = 1; k < line.points_W.size(); ++k) {
    const bool open = TraverseVoxels(line.points_W[k - 1], line.points_W[k], kCell, [&](const VoxelIndex& i) {
      return map.Get(i, FieldCell::kWall) != FieldCell::kWall;
    });
    ASSERT_TRUE(open) << "segment " << k << " of " << line.points_W.size();
  }
}

FieldCell CellOfEnd(const FieldMap& map, const Streamline& line) {
  return map.Get(VoxelAt(line.points_W.back(), kCell), FieldCell::kWall);
}

double Length(const Streamline& line) {
  double length = 0.0;
  for (std::size_t k = 1; k < line.points_W.size(); ++k) {
    length += (line.points_W[k] - line.points_W[k - 1]).norm();
  }
  return length;
}

TEST(Streamline, RunsStraightBetweenTwoPlates) {
  FieldMap map({{0, 0, 0}, {50, 10, 10}}, FieldCell::kFree);
  testing::FillBox(map, {{0, 0, 0}, {1, 10, 10}}, FieldCell::kSource);
  testing::FillBox(map, {{49, 0, 0}, {50, 10, 10}}, FieldCell::kSink);
  HarmonicField field;
  field.Solve(map, {});
  const Eigen::Vector3d start(0.33, 0.41, 0.77);
  const Streamline down = TraceStreamline(map, field.phi(), kCell, start, false, {});
  EXPECT_EQ(down.end, StreamlineEnd::kArrived);
  EXPECT_NEAR(Length(down), 4.9 - 0.33, 0.03);
  for (const Eigen::Vector3d& p : down.points_W) EXPECT_LT((p - start).tail<2>().norm(), 0.01);
  const Streamline up = TraceStreamline(map, field.phi(), kCell, {4.95, 0.45, 0.45}, true, {});
  EXPECT_EQ(up.end, StreamlineEnd::kArrived);
  EXPECT_EQ(CellOfEnd(map, up), FieldCell::kSource);
}

TEST(Streamline, EndsAtOnceWhereItStartsInItsTarget) {
  FieldMap map({{0, 0, 0}, {5, 1, 1}}, FieldCell::kFree);
  map[std::size_t{0}] = FieldCell::kSource;
  map[std::size_t{4}] = FieldCell::kSink;
  HarmonicField field;
  field.Solve(map, {});
  const Streamline line = TraceStreamline(map, field.phi(), kCell, {0.45, 0.05, 0.05}, false, {});
  EXPECT_EQ(line.end, StreamlineEnd::kArrived);
  EXPECT_EQ(line.points_W.size(), 1U);
}

TEST(Streamline, IsStuckInAWallAndWhereNothingIsReached) {
  FieldMap map({{0, 0, 0}, {7, 1, 1}}, FieldCell::kFree);
  map[std::size_t{0}] = FieldCell::kSource;
  map[std::size_t{1}] = FieldCell::kSink;
  map[std::size_t{3}] = FieldCell::kWall;
  HarmonicField field;
  field.Solve(map, {});
  for (const double x : {0.35, 0.55, 3.0}) {
    const Streamline line = TraceStreamline(map, field.phi(), kCell, {x, 0.05, 0.05}, false, {});
    EXPECT_EQ(line.end, StreamlineEnd::kStuck);
  }
}

TEST(Streamline, StopsAtItsGreatestLength) {
  FieldMap map({{0, 0, 0}, {100, 1, 1}}, FieldCell::kFree);
  map[std::size_t{0}] = FieldCell::kSource;
  map[std::size_t{99}] = FieldCell::kSink;
  HarmonicField field;
  field.Solve(map, {});
  const Streamline line =
      TraceStreamline(map, field.phi(), kCell, {0.05, 0.05, 0.05}, false, {.max_length_cells = 20.0});
  EXPECT_EQ(line.end, StreamlineEnd::kTooLong);
  EXPECT_NEAR(Length(line), 20.0 * kCell, 1.5 * kCell);
}

/// Traces a map down from `count` random cells and up from every sink cell, or from `count` of them.
void ExpectEveryTraceArrives(const std::string& name, const FieldMap& map, std::size_t count,
                             std::mt19937& random) {
  SCOPED_TRACE(name);
  HarmonicField field;
  field.Solve(map, {});
  std::vector<VoxelIndex> free;
  std::vector<VoxelIndex> sinks;
  std::vector<VoxelIndex> queue;
  DenseGrid<std::uint8_t> seen(map.box(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] != FieldCell::kSource) continue;
    seen[i] = 1;
    queue.push_back(map.IndexAt(i));
  }
  for (std::size_t k = 0; k < queue.size(); ++k) {  // what the robot can reach
    (IsSink(map[queue[k]]) ? sinks : free).push_back(queue[k]);
    for (const VoxelIndex& d : kFaceNeighbors) {
      const VoxelIndex next = queue[k] + d;
      if (map.Get(next, FieldCell::kWall) == FieldCell::kWall || seen[next] != 0) continue;
      seen[next] = 1;
      queue.push_back(next);
    }
  }
  if (sinks.empty()) return;
  std::uniform_real_distribution<double> within(0.001, 0.999);
  for (const bool upward : {false, true}) {
    const std::vector<VoxelIndex>& starts = upward ? sinks : free;
    for (std::size_t k = 0; k < std::min(count, starts.size()); ++k) {
      const VoxelIndex& cell = starts[starts.size() <= count ? k : random() % starts.size()];
      const Eigen::Vector3d start =
          kCell * Eigen::Vector3d(cell.x + within(random), cell.y + within(random), cell.z + within(random));
      const Streamline line = TraceStreamline(map, field.phi(), kCell, start, upward, {});
      ASSERT_EQ(line.end, StreamlineEnd::kArrived)
          << (upward ? "up" : "down") << " from " << cell.x << ' ' << cell.y << ' ' << cell.z;
      const FieldCell end = CellOfEnd(map, line);
      ASSERT_TRUE(upward ? end == FieldCell::kSource : IsSink(end));
      if (end == FieldCell::kWeakSink) {
        const double weak = -HarmonicField::Options{}.weak_sink;
        ASSERT_GE(field.phi()[cell], weak - 1e-3) << "it has gone up";
      }
      ASSERT_NO_FATAL_FAILURE(ExpectWithinFreeSpace(map, line));
    }
  }
}

TEST(Streamline, NeverLeavesFreeSpaceAndAlwaysArrivesOnRandomMaps) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    std::mt19937 random(seed);
    const auto check = [&](const std::string& name, FieldMap map, int sinks, int radius) {
      testing::PlaceSinks(map, sinks, 3, random);
      testing::PlaceSource(map, radius, random);
      ExpectEveryTraceArrives(name + " " + std::to_string(seed), map, 40, random);
      testing::PlaceSinks(map, 2 * sinks, 3, random, FieldCell::kWeakSink);
      ExpectEveryTraceArrives(name + " " + std::to_string(seed) + ", weak sinks", map, 40, random);
    };
    check("thin maze", testing::Maze({8, 8, 3}, 1, 1, random), 2, 0);
    check("wide maze", testing::Maze({6, 5, 3}, 3, 2, random), 3, 1);
    check("boxes", testing::RandomBoxes({{-9, -8, -7}, {31, 32, 23}}, 80, 10, random), 6, 2);
    check("open boxes", testing::RandomBoxes({{0, 0, 0}, {40, 30, 20}}, 12, 9, random), 1, 3);
    check("caves", testing::RandomCells({{0, 0, 0}, {30, 30, 20}}, 0.45, random), 6, 2);
    check("rooms", testing::FurnishedBuilding::Generate({60, 50, 24}, random), 5, 3);
  }
}

}  // namespace
}  // namespace thalweg::explorer
