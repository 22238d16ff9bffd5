#include "services/explorer/core/gaps/gap_explorer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "tests/services/explorer/support/gap_rooms.h"
#include "tests/services/explorer/support/gap_vertices.h"
#include "tests/services/explorer/support/random_polygons.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;
using test::VerticesOf;
using Kind = GapEvent::Kind;

constexpr unsigned kPolygonsOfAKind = 40;

/// Whether two lists are the same but for where they begin.
bool AreEqualAsCycles(std::vector<std::size_t> a, const std::vector<std::size_t>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a == b) return true;
    std::rotate(a.begin(), a.begin() + 1, a.end());
  }
  return a == b;
}

/// Points of a polygon, and which of them were seen from a path so far, by brute force.
class SeenPoints {
 public:
  SeenPoints(const Polygon& polygon, std::vector<Vector2d> points)
      : polygon_(polygon), points_(std::move(points)), seen_(points_.size()) {}

  /// Adds what is seen from the rest of a path that has grown.
  void Follow(const std::vector<Vector2d>& path) {
    for (; followed_ < path.size(); ++followed_) {
      const Vector2d& from = path[followed_ == 0 ? 0 : followed_ - 1];
      for (std::size_t k = 0; k < points_.size(); ++k) {
        seen_[k] = seen_[k] || IsSeenFromSegment(polygon_, from, path[followed_], points_[k]);
      }
    }
  }

  const std::vector<Vector2d>& points() const { return points_; }
  bool IsSeen(std::size_t k) const { return seen_[k]; }
  std::size_t Unseen() const { return static_cast<std::size_t>(std::ranges::count(seen_, false)); }

 private:
  const Polygon& polygon_;
  std::vector<Vector2d> points_;
  std::vector<bool> seen_;
  std::size_t followed_ = 0;
};

std::vector<Vector2d> VerticesAndPointsIn(const Polygon& polygon, test::Dice& dice) {
  std::vector<Vector2d> points = polygon.vertices();
  for (int k = 0; k < 100; ++k) points.push_back(test::RandomPointIn(dice, polygon));
  return points;
}

/// A point right in front of the middle of every wall; number k is that of the wall from vertex k on.
std::vector<Vector2d> FrontsOfWalls(const Polygon& polygon) {
  std::vector<Vector2d> points;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector2d along = polygon[polygon.Next(k)] - polygon[k];
    points.push_back(polygon[k] + along / 2.0 + 1e-8 * Turned(along, std::numbers::pi / 2.0));
  }
  return points;
}

/// The last wall that a gap hides before it disappears: that behind the row of reflex vertices that it slides
/// along. It is numbered as in FrontsOfWalls.
std::size_t LastHiddenWall(const Polygon& polygon, std::size_t vertex, GapSide hidden) {
  std::size_t v = vertex;
  while (polygon.IsReflex(HiddenNeighbor(polygon, v, hidden))) v = HiddenNeighbor(polygon, v, hidden);
  return hidden == GapSide::kLeft ? polygon.Previous(v) : v;
}

/// Checks after every event of an exploration what has to hold between tree, gaps and what was seen.
class Witness {
 public:
  Witness(const Polygon& polygon, const GapExplorer& explorer, std::vector<Vector2d> points)
      : polygon_(polygon),
        explorer_(explorer),
        points_(polygon, std::move(points)),
        fronts_(polygon, FrontsOfWalls(polygon)) {}

  void Check() {
    const PointRobot& robot = explorer_.robot();
    const GapTree& tree = explorer_.tree();
    points_.Follow(robot.path());
    fronts_.Follow(robot.path());
    const std::vector<Gap> gaps = SenseGaps(polygon_, robot.position());
    ASSERT_TRUE(AreEqualAsCycles(robot.gaps(), VerticesOf(gaps)));
    ASSERT_EQ(tree.in_sight().size(), gaps.size());
    for (const Gap& gap : gaps) {
      const auto slot = std::ranges::find(robot.gaps(), gap.vertex) - robot.gaps().begin();
      const GapTree::Node node = tree.in_sight()[static_cast<std::size_t>(slot)];
      walls_[node] = LastHiddenWall(polygon_, gap.vertex, gap.hidden);
      if (!tree.IsLeaf(node) || !tree.IsPrimitive(node)) continue;
      const Polygon pocket(PocketOf(polygon_, robot.position(), gap));
      for (std::size_t k = 0; k < points_.points().size(); ++k) {
        EXPECT_TRUE(points_.IsSeen(k) || !pocket.Contains(points_.points()[k])) << "behind a primitive gap";
      }
    }
    // Leaves that are out of sight are as they were when they merged.
    for (const GapTree::Node leaf : tree.Leaves()) {
      ASSERT_TRUE(walls_.contains(leaf));
      EXPECT_EQ(tree.IsPrimitive(leaf), fronts_.IsSeen(walls_.at(leaf))) << "leaf " << leaf;
    }
  }

  std::size_t Unseen() const { return points_.Unseen() + fronts_.Unseen(); }

 private:
  const Polygon& polygon_;
  const GapExplorer& explorer_;
  SeenPoints points_;
  SeenPoints fronts_;
  std::map<GapTree::Node, std::size_t> walls_;  ///< The last that each gap hides.
};

TEST(GapExplorer, AConvexRoomIsKnownAtOnce) {
  const Polygon room({{0, 0}, {4, 0.5}, {5, 3}, {2, 5}, {-1, 2}});
  GapExplorer explorer(room, {1.0, 1.0});
  EXPECT_FALSE(explorer.Step());
  EXPECT_EQ(explorer.robot().length(), 0.0);
}

TEST(GapExplorer, ABentCorridorIsKnownOnceItsCornerIsRounded) {
  const Polygon corridor = test::BentCorridor();
  GapExplorer explorer(corridor, {1.0, 1.0});
  EXPECT_TRUE(explorer.Step());
  EXPECT_FALSE(explorer.Step());
  ASSERT_EQ(explorer.log().size(), 1U);
  EXPECT_EQ(explorer.log()[0].event, (GapEvent{Kind::kDisappear, 0}));
}

TEST(GapExplorer, TwoDeadEndsAreLookedIntoOneAfterTheOther) {
  const Polygon corridor = test::TwoDeadEnds();
  GapExplorer explorer(corridor, {1.0, 1.7});
  // From above the line through both corners the second is behind the first: one gap, which splits.
  ASSERT_EQ(explorer.tree().in_sight().size(), 1U);
  ASSERT_TRUE(explorer.Step());
  EXPECT_EQ(explorer.log().back().event, (GapEvent{Kind::kSplit, 0}));
  EXPECT_THAT(explorer.robot().gaps(), testing::ElementsAre(6, 10));
  // The first one is at hand.
  ASSERT_TRUE(explorer.Step());
  EXPECT_EQ(explorer.log().back().event, (GapEvent{Kind::kDisappear, 1}));
  EXPECT_THAT(explorer.robot().gaps(), testing::ElementsAre(6));
  EXPECT_FALSE(explorer.tree().IsComplete());
  // On the way to the second one the wall that leads to the first is passed: its gap is primitive.
  ASSERT_TRUE(explorer.Step());
  EXPECT_EQ(explorer.log().back().event, (GapEvent{Kind::kAppear, 1}));
  EXPECT_THAT(explorer.robot().gaps(), testing::ElementsAre(6, 10));
  EXPECT_TRUE(explorer.tree().IsPrimitive(explorer.tree().in_sight()[1]));
  while (explorer.Step()) {
  }
  EXPECT_NEAR((explorer.robot().position() - corridor[6]).norm(), 0.02, 0.01);
}

class RandomPolygons : public testing::TestWithParam<test::PolygonKind> {};

TEST_P(RandomPolygons, AreSeenAsAWholeAndTheTreeIsRightAfterEachEvent) {
  std::map<Kind, int> events;
  for (unsigned seed = 1; seed <= kPolygonsOfAKind; ++seed) {
    SCOPED_TRACE(seed);
    const Polygon polygon = test::RandomPolygon(GetParam(), seed);
    test::Dice dice(seed);
    GapExplorer explorer(polygon, test::RandomPointIn(dice, polygon));
    Witness witness(polygon, explorer, VerticesAndPointsIn(polygon, dice));
    ASSERT_NO_FATAL_FAILURE(witness.Check());
    while (explorer.Step()) ASSERT_NO_FATAL_FAILURE(witness.Check());
    EXPECT_TRUE(explorer.tree().IsComplete());
    EXPECT_EQ(witness.Unseen(), 0U);
    const std::vector<Vector2d>& path = explorer.robot().path();
    double length = 0.0;
    for (std::size_t k = 1; k < path.size(); ++k) {
      EXPECT_TRUE(polygon.Contains(path[k]) && polygon.Sees(path[k - 1], path[k]));
      length += (path[k] - path[k - 1]).norm();
    }
    EXPECT_NEAR(explorer.robot().length(), length, 1e-9 * (1.0 + length));
    for (const auto& record : explorer.log()) ++events[record.event.kind];
  }
  for (const Kind kind : {Kind::kAppear, Kind::kDisappear, Kind::kSplit, Kind::kMerge})
    EXPECT_GT(events[kind], 10);
}

TEST_P(RandomPolygons, HaveEachGapOfTheTreeBroughtBackIntoSight) {
  for (unsigned seed = 1; seed <= kPolygonsOfAKind; ++seed) {
    SCOPED_TRACE(seed);
    const Polygon polygon = test::RandomPolygon(GetParam(), seed);
    test::Dice dice(seed);
    GapExplorer explorer(polygon, test::RandomPointIn(dice, polygon));
    while (explorer.Step()) {
    }
    for (const GapTree::Node leaf : explorer.tree().Leaves()) {
      if (!explorer.tree().Contains(leaf)) continue;  // It disappeared on the way to another one.
      explorer.GoTo(leaf);
      EXPECT_THAT(explorer.tree().in_sight(), testing::Contains(leaf));
      EXPECT_TRUE(explorer.tree().IsComplete());
    }
    EXPECT_TRUE(AreEqualAsCycles(explorer.robot().gaps(),
                                 VerticesOf(SenseGaps(polygon, explorer.robot().position()))));
  }
}

TEST_P(RandomPolygons, AreExploredInTheSameWayEachTime) {
  const Polygon polygon = test::RandomPolygon(GetParam(), 9);
  test::Dice dice(9);
  const Vector2d start = test::RandomPointIn(dice, polygon);
  GapExplorer once(polygon, start);
  while (once.Step()) {
  }
  GapExplorer twice(polygon, start);
  while (twice.Step()) {
  }
  EXPECT_EQ(once.robot().path(), twice.robot().path());
  ASSERT_EQ(once.log().size(), twice.log().size());
  for (std::size_t k = 0; k < once.log().size(); ++k) EXPECT_EQ(once.log()[k].event, twice.log()[k].event);
}

std::string NameOf(const testing::TestParamInfo<test::PolygonKind>& kind) {
  return test::NameOf(kind.param);
}

INSTANTIATE_TEST_SUITE_P(EachKind, RandomPolygons, testing::ValuesIn(test::kPolygonKinds), NameOf);

}  // namespace
}  // namespace thalweg::explorer
