#include "services/surface/evaluation/exploration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using testing::HasSubstr;

const StereoGeometry kRig = test::Rig(160, 120, 110.0);

View StepFrom(const RigidTransform& T_WC) {
  return test::ViewOf(kRig, T_WC, test::StepAt);
}

/// A camera that can go anywhere.
Result<View> Anywhere(const RigidTransform& T_WC, const Eigen::Vector3d&) {
  return StepFrom(T_WC);
}

TEST(Explore, LooksOnTheWayToTheRiftAsOftenAsAsked) {
  std::vector<SurfaceRow> rows;
  std::vector<std::size_t> rifts;
  const Exploration made = Explore(
      StepFrom(RigidTransform::Identity()), Anywhere, {.surface = {}, .moves = 1, .views_per_move = 3},
      {.measured = [&](const SurfaceRow& row, const Surface&, const Move&) { rows.push_back(row); },
       .refused = nullptr});
  EXPECT_EQ(made.end, ExplorationEnd::kAllMoves);
  EXPECT_EQ(made.moves, 1);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].name, "first view");
  EXPECT_EQ(rows[0].views, 1U);
  EXPECT_EQ(rows[0].points, 160U * 120U);
  EXPECT_EQ(rows[0].vertices, 160U * 120U);
  EXPECT_EQ(rows[0].edges, 2U * 160U * 120U - 160U - 120U);
  EXPECT_EQ(rows[0].rifts, 1U);
  EXPECT_EQ(rows[0].rift_edges, 120U);
  EXPECT_EQ(rows[0].reachable_rifts, 1U);
  EXPECT_EQ(rows[1].views, 4U);
  EXPECT_EQ(rows[1].points, made.surface.raw_point_count());
  EXPECT_GT(rows[1].deleted_edges, 0U) << "the rift was looked through";
  EXPECT_GT(rows[1].area, rows[0].area);
  EXPECT_GT(rows[1].cubes, rows[0].cubes);
}

TEST(Explore, WhereTheCameraCannotGoIsReportedAndLeftOut) {
  std::vector<std::string> refused;
  int asked = 0;
  const Camera sometimes = [&](const RigidTransform& T_WC, const Eigen::Vector3d&) -> Result<View> {
    if (++asked % 2 == 0) return Error{"a wall"};
    return StepFrom(T_WC);
  };
  const Exploration made = Explore(
      StepFrom(RigidTransform::Identity()), sometimes, {.surface = {}, .moves = 1, .views_per_move = 2},
      {.measured = nullptr, .refused = [&](const std::string& why) { refused.push_back(why); }});
  EXPECT_EQ(made.surface.views().size(), 2U);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0], "move 1, view 2 of 2: a wall");
}

// Since nothing is new, it would plan the same move for ever.
TEST(Explore, EndsWhereTheCameraCanTakeNoPoseOfItsWay) {
  int refused = 0;
  const Camera nowhere = [](const RigidTransform&, const Eigen::Vector3d&) -> Result<View> {
    return Error{"a wall"};
  };
  const Exploration made =
      Explore(StepFrom(RigidTransform::Identity()), nowhere, {.surface = {}, .moves = 9, .views_per_move = 2},
              {.measured = nullptr, .refused = [&](const std::string&) { ++refused; }});
  EXPECT_EQ(made.end, ExplorationEnd::kNowhere);
  EXPECT_EQ(made.moves, 1);
  EXPECT_EQ(refused, 2);
  EXPECT_EQ(made.surface.views().size(), 1U);
}

TEST(Explore, EndsWhereNoRiftIsLeft) {
  int rows = 0;
  const View plane = test::PlaneTwice(kRig, 2.0, 0).first;
  const Exploration made =
      Explore(plane, Anywhere, {.surface = {}, .moves = 10},
              {.measured = [&](const auto&, const auto&, const auto&) { ++rows; }, .refused = nullptr});
  EXPECT_EQ(made.end, ExplorationEnd::kNoRift);
  EXPECT_EQ(made.moves, 0);
  EXPECT_EQ(rows, 1);
}

TEST(Explore, RefusesOptionsByName) {
  for (const ExplorationOptions& options : {ExplorationOptions{.surface = {}, .moves = -1},
                                            ExplorationOptions{.surface = {}, .views_per_move = 0}}) {
    EXPECT_THROW(CheckOptions(options), std::invalid_argument);
  }
}

TEST(AddEach, MeasuresTheSurfaceAfterEachViewUnderItsName) {
  const auto shifted = [](std::size_t k) { return test::Shifted({0.4 * static_cast<double>(k), 0, 0}); };
  std::vector<SurfaceRow> rows;
  std::vector<std::size_t> loaded;
  const Surface whole =
      AddEach(3,
              [&](std::size_t k) {
                loaded.push_back(k);
                return NamedView{"view " + std::to_string(k), StepFrom(shifted(k))};
              },
              {},
              {.measured = [&](const SurfaceRow& row, const auto&, const auto&) { rows.push_back(row); },
               .refused = nullptr});
  EXPECT_EQ(loaded, (std::vector<std::size_t>{0, 1, 2}));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_GT(rows[1].deleted_edges, 0U) << "the second view looks through the first one's rift";
  Surface alone({});
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Addition addition = alone.Add(StepFrom(shifted(k)));
    SurfaceRow expected = Measure("view " + std::to_string(k), alone, alone.PlanMove());
    expected.deleted_edges = addition.deleted;
    EXPECT_EQ(ToJson(rows[k]), ToJson(expected));
  }
  EXPECT_EQ(whole.edge_count(), alone.edge_count());
}

TEST(AddEach, LeavesOutAViewWithoutAnyMeasurementAndNamesIt) {
  std::vector<std::string> rows;
  std::vector<std::string> refused;
  const Surface whole = AddEach(
      3,
      [&](std::size_t k) {
        NamedView next{"view " + std::to_string(k), StepFrom(RigidTransform::Identity())};
        if (k == 1) next.view.disparities.assign(next.view.disparities.size(), 0.0F);
        return next;
      },
      {},
      {.measured = [&](const SurfaceRow& row, const auto&, const auto&) { rows.push_back(row.name); },
       .refused = [&](const std::string& why) { refused.push_back(why); }});
  EXPECT_EQ(rows, (std::vector<std::string>{"view 0", "view 2"}));
  EXPECT_EQ(refused, (std::vector<std::string>{"view 1: no pixel has a measurement"}));
  EXPECT_EQ(whole.views().size(), 2U);
}

TEST(CompareSearches, FindOneLengthByDijkstraAndAStar) {
  Surface surface({});
  surface.Add(StepFrom(RigidTransform::Identity()));
  const Move move = surface.PlanMove();
  const std::vector<SearchRow> rows = CompareSearches(surface, move);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].method, "Dijkstra");
  EXPECT_EQ(rows[2].method, "A*");
  EXPECT_NEAR(rows[2].length, rows[0].length, 1e-9);
  EXPECT_LT(rows[2].looked_at, rows[0].looked_at);
  EXPECT_GE(rows[1].length, rows[0].length - 1e-9);
}

TEST(SurfaceRows, AsTextAndJsonSayTheSame) {
  SurfaceRow row;
  row.name = "move 1";
  row.points = 548978;
  row.area = 52.125;
  EXPECT_THAT(ToText(row), HasSubstr("548978"));
  EXPECT_THAT(ToText(row), HasSubstr("52.1"));
  EXPECT_EQ(ToJson(row)["raw_points"], 548978);
  EXPECT_EQ(ToJson(row)["area_m2"], 52.125);
  EXPECT_EQ(RowHeading().find('\n') + 1, ToText(row).size()) << "columns stand under their headings";
}

}  // namespace
}  // namespace thalweg::surface
