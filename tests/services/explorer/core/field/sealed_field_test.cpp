#include "services/explorer/core/field/sealed_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using testing::FieldMap;
using testing::FillBox;

constexpr int kRoom = testing::Comb::kRoom;
constexpr auto InRoom = testing::Comb::InRoom;
using testing::PutCube;

FieldMap ExploredComb(int rooms) {
  return testing::Comb::Explored(rooms);
}

/// Solves the field with sealing on a copy of the map.
struct Solver {
  SealedField field;
  FieldMap cells;

  const DenseGrid<float>& Solve(const FieldMap& map, const std::vector<VoxelIndex>& paths = {}) {
    cells = map;
    return field.Solve(cells, {}, paths);
  }
  std::size_t unknowns() const { return field.statistics().unknowns; }
  bool IsSealed(const VoxelIndex& i) const { return cells[i] == FieldCell::kWall; }
};

TEST(SealedField, ExploredRoomsCostNothingAfterTheFirstSolve) {
  const FieldMap map = ExploredComb(20);
  Solver solver;
  solver.Solve(map);
  const std::size_t before = solver.unknowns();
  solver.Solve(map);
  HarmonicField one_room;
  one_room.Solve(ExploredComb(1), {});
  EXPECT_GT(before, 15 * one_room.statistics().unknowns);
  EXPECT_LT(solver.unknowns(), one_room.statistics().unknowns);
}

TEST(SealedField, HardlyChangesTheFieldWhereSomethingFlows) {
  const FieldMap map = ExploredComb(8);
  HarmonicField plain;
  const DenseGrid<float>& expected = plain.Solve(map, {});
  Solver solver;
  solver.Solve(map);
  const DenseGrid<float>& phi = solver.Solve(map);
  ASSERT_GT(solver.field.sealed_cells(), 0U);
  float worst = 0.0F;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (solver.cells[k] == FieldCell::kFree) {
      worst = std::max(worst, std::abs(phi[k] - expected[k]));
    }
    EXPECT_EQ(std::isnan(phi[k]), solver.cells[k] == FieldCell::kWall);
  }
  EXPECT_LT(worst, 0.05F);  // of a field that spans 2, beside sealed parts
  const DenseGrid<std::int32_t> group(map.box(), 0);
  const double inflow = HarmonicField::InflowOf(map, expected, group, 1).front();
  EXPECT_NEAR(HarmonicField::InflowOf(solver.cells, phi, group, 1).front(), inflow, 0.01 * inflow);
}

TEST(SealedField, NamesTheCellsThatTheNextSolveDoesWithout) {
  const FieldMap map = ExploredComb(8);
  Solver solver;
  EXPECT_TRUE(solver.field.sealed().empty());
  solver.Solve(map);
  const std::vector<VoxelIndex> sealed = solver.field.sealed();
  EXPECT_EQ(sealed.size(), solver.field.sealed_cells());
  solver.Solve(map);
  FieldMap expected = map;
  for (const VoxelIndex& cell : sealed) {
    EXPECT_EQ(expected[cell], FieldCell::kFree) << "or it is named twice";
    expected[cell] = FieldCell::kWall;
  }
  for (std::size_t k = 0; k < map.size(); ++k) EXPECT_EQ(solver.cells[k], expected[k]) << k;
}

TEST(SealedField, IsOpenedWhereSomethingChanges) {
  const FieldMap map = ExploredComb(8);
  const auto room_is_open_after = [&](const std::function<void(FieldMap&)>& change,
                                      const std::vector<VoxelIndex>& paths = {}) {
    Solver solver;
    solver.Solve(map);
    EXPECT_EQ(solver.field.parts(), 1U);
    FieldMap changed = map;
    change(changed);
    solver.Solve(changed, paths);
    return !solver.IsSealed(InRoom(1) + VoxelIndex{5, 5, 5});
  };
  EXPECT_FALSE(room_is_open_after([](FieldMap&) {}));
  EXPECT_TRUE(room_is_open_after([](FieldMap& m) { PutCube(m, InRoom(1), 2, FieldCell::kSink); }));
  EXPECT_TRUE(room_is_open_after([](FieldMap& m) { PutCube(m, InRoom(1), 2, FieldCell::kWeakSink); }));
  EXPECT_TRUE(room_is_open_after([](FieldMap& m) { PutCube(m, InRoom(1), 2, FieldCell::kWall); }));
  EXPECT_TRUE(room_is_open_after([](FieldMap& m) {
    PutCube(m, InRoom(7) - VoxelIndex{7, 0, 0}, 2, FieldCell::kFree);
    PutCube(m, InRoom(1), 2, FieldCell::kSource);
  }));
  EXPECT_TRUE(room_is_open_after([](FieldMap& m) {  // a wall beside it disappears
    FillBox(m, {InRoom(1) + VoxelIndex{kRoom / 2, 0, 0}, InRoom(1) + VoxelIndex{kRoom / 2 + 2, 3, 3}},
            FieldCell::kFree);
  }));
  EXPECT_TRUE(room_is_open_after([](FieldMap&) {}, {InRoom(1)}));
  EXPECT_FALSE(room_is_open_after([](FieldMap& m) { PutCube(m, InRoom(7), 1, FieldCell::kSource); }));
}

TEST(SealedField, RoomsBesideTheStreamArePartsOfTheirOwn) {
  FieldMap map = testing::Comb::Of(9);
  PutCube(map, InRoom(4), 2, FieldCell::kSource);
  PutCube(map, InRoom(0), 2, FieldCell::kSink);
  PutCube(map, InRoom(8), 2, FieldCell::kSink);
  Solver solver;
  solver.Solve(map);
  const VoxelIndex back{0, kRoom / 2 - 3, 0};
  PutCube(map, InRoom(2) + back, 1, FieldCell::kWall);
  solver.Solve(map);
  EXPECT_FALSE(solver.IsSealed(InRoom(2) + back + VoxelIndex{3, 0, 0}));
  for (const int room : {1, 3, 5, 6, 7}) EXPECT_TRUE(solver.IsSealed(InRoom(room) + back)) << room;
}

TEST(SealedField, APassageIsOpenedAsSoonAsSomethingWouldFlow) {
  // A ring with the robot in the west and frontiers in the north and the south: nothing flows through the
  // east.
  FieldMap ring({{0, 0, 0}, {60, 60, 14}}, FieldCell::kWall);
  FillBox(ring, {{1, 1, 1}, {59, 59, 13}}, FieldCell::kFree);
  FillBox(ring, {{13, 13, 1}, {47, 47, 13}}, FieldCell::kWall);
  FieldMap map = ring;
  PutCube(map, {7, 30, 7}, 3, FieldCell::kSource);
  FillBox(map, {{30, 1, 1}, {33, 13, 13}}, FieldCell::kSink);
  FillBox(map, {{30, 47, 1}, {33, 59, 13}}, FieldCell::kSink);
  const VoxelIndex east{53, 30, 7};
  Solver solver;
  solver.Solve(map);
  solver.Solve(map);
  ASSERT_TRUE(solver.IsSealed(east));
  // The north is explored, so some of the flux to the southern frontier now passes through the east.
  map = ring;
  PutCube(map, {7, 30, 7}, 3, FieldCell::kSource);
  FillBox(map, {{30, 47, 1}, {33, 59, 13}}, FieldCell::kSink);
  const DenseGrid<float>& phi = solver.Solve(map);
  EXPECT_FALSE(solver.IsSealed(east));
  HarmonicField plain;
  EXPECT_NEAR(phi[east], plain.Solve(map, {})[east], 0.01);
}

TEST(SealedField, FollowsAMapThatGrows) {
  const FieldMap map = ExploredComb(8);
  Solver solver;
  solver.Solve(map);
  const std::size_t sealed = solver.field.sealed_cells();
  VoxelBox larger = map.box();
  larger.min = larger.min - VoxelIndex{5, 0, 3};
  larger.max = larger.max + VoxelIndex{0, 7, 2};
  FieldMap grown(larger, FieldCell::kWall);
  for (std::size_t k = 0; k < map.size(); ++k) grown[map.IndexAt(k)] = map[k];
  solver.Solve(grown);
  EXPECT_GE(solver.field.sealed_cells(), sealed);
  EXPECT_TRUE(solver.IsSealed(InRoom(1)));
}

/// The robot goes to the frontier with the most flux, which is then explored, until none is left.
TEST(SealedFieldOnRandomMaps, LeadsToTheSameFrontiersAsTheWholeField) {
  int solves = 0;
  int decided = 0;
  double saved = 0.0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    std::mt19937 random(seed);
    FieldMap map = testing::FurnishedBuilding::Generate({110, 110, 34}, random);
    std::vector<VoxelIndex> sinks;
    for (int attempt = 0; attempt < 100000 && sinks.size() < 12; ++attempt) {
      const VoxelIndex at = testing::RandomCell(map.box(), random);
      if (map[at] == FieldCell::kFree) sinks.push_back(at);
    }
    VoxelIndex robot = sinks.back();
    sinks.pop_back();
    Solver sealed;
    while (!sinks.empty()) {
      FieldMap cells = map;
      DenseGrid<std::int32_t> group(map.box(), -1);
      for (std::size_t s = 0; s < sinks.size(); ++s) {
        const bool weak = seed % 2 == 0 && (sinks[s].x + sinks[s].y) % 3 != 0;
        cells[sinks[s]] = weak ? FieldCell::kWeakSink : FieldCell::kSink;
        group[sinks[s]] = static_cast<std::int32_t>(s);
      }
      cells[robot] = FieldCell::kSource;
      HarmonicField plain;
      const auto expected = HarmonicField::InflowOf(cells, plain.Solve(cells, {}), group, sinks.size());
      const DenseGrid<float>& phi = sealed.Solve(cells);
      const auto inflow = HarmonicField::InflowOf(sealed.cells, phi, group, sinks.size());
      const auto best = std::max_element(expected.begin(), expected.end());
      const auto chosen = best - expected.begin();
      // Unless another frontier is as good.
      if (std::count_if(expected.begin(), expected.end(), [&](double f) { return f > 0.94 * *best; }) == 1) {
        EXPECT_EQ(std::max_element(inflow.begin(), inflow.end()) - inflow.begin(), chosen) << "seed " << seed;
        ++decided;
      }
      for (std::size_t s = 0; s < sinks.size(); ++s) EXPECT_NEAR(inflow[s], expected[s], 0.03 * *best);
      ++solves;
      saved +=
          1.0 - static_cast<double>(sealed.unknowns()) / static_cast<double>(plain.statistics().unknowns);
      robot = sinks[static_cast<std::size_t>(chosen)];
      sinks.erase(sinks.begin() + chosen);
    }
  }
  EXPECT_GT(decided, solves / 2);
  EXPECT_GT(saved / solves, 0.03);  // these rooms have several doors each
}

}  // namespace
}  // namespace thalweg::explorer
