#include "services/explorer/core/gaps/gap_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "services/explorer/core/gaps/gap_explorer.h"
#include "services/explorer/core/gaps/shadows.h"
#include "tests/services/explorer/support/random_polygons.h"

namespace thalweg::explorer {
namespace {

using Eigen::Vector2d;
using Node = GapTracker::Node;

constexpr double kStep = 0.2;  ///< [m] Between two looks, at most.

/// A row of cells: a digit is the number of the shadow that a cell lies in, a dot lies in none.
DenseGrid<int> RowOf(const std::string& cells) {
  DenseGrid<int> row({{0, 0, 0}, {static_cast<int>(cells.size()), 1, 1}}, kNoShadow);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] != '.') row[k] = cells[k] - '0';
  }
  return row;
}

TEST(GapTracker, HasAGapForEachShadowAndNoneOnceItIsGone) {
  GapTracker tracker;
  tracker.Update(RowOf("00..11"));
  ASSERT_EQ(tracker.in_sight().size(), 2U);
  const Node left = tracker.in_sight()[0];
  const Node right = tracker.in_sight()[1];
  EXPECT_LT(left, right);
  EXPECT_EQ(tracker.LeafAt({0, 0, 0}), left);
  EXPECT_EQ(tracker.LeafAt({2, 0, 0}), std::nullopt);
  EXPECT_EQ(tracker.LeafAt({9, 0, 0}), std::nullopt) << "outside of the plane";
  tracker.Update(RowOf("....00"));
  EXPECT_EQ(tracker.in_sight(), std::vector{right}) << "whatever the number of its shadow";
  EXPECT_FALSE(tracker.Contains(left));
  tracker.Update(RowOf("...000"));
  EXPECT_EQ(tracker.LeafAt({3, 0, 0}), right) << "its shadow has grown";
  tracker.Update(RowOf("......"));
  EXPECT_TRUE(tracker.Leaves().empty());
}

TEST(GapTracker, ALeafThatSplitsIsTwoOthers) {
  GapTracker tracker;
  tracker.Update(RowOf("000000"));
  const Node whole = tracker.in_sight()[0];
  tracker.Update(RowOf("00..11"));
  EXPECT_FALSE(tracker.Contains(whole));
  EXPECT_EQ(tracker.in_sight().size(), 2U);
  EXPECT_EQ(tracker.Leaves(), tracker.in_sight());
}

TEST(GapTracker, GapsThatMergeComeOutAsTheyWere) {
  GapTracker tracker;
  tracker.Update(RowOf("0..1..2"));
  const std::vector<Node> leaves = tracker.in_sight();
  tracker.Update(RowOf("0000..1"));
  ASSERT_EQ(tracker.in_sight().size(), 2U);
  const Node merged = tracker.in_sight()[0];
  EXPECT_EQ(tracker.Children(merged), (std::vector{leaves[0], leaves[1]}));
  EXPECT_EQ(tracker.LeafAt({1, 0, 0}), leaves[0]) << "which is nearer";
  EXPECT_EQ(tracker.LeafAt({2, 0, 0}), leaves[1]);
  tracker.Update(RowOf("0000000"));
  EXPECT_EQ(tracker.Level(leaves[0]), 2U);
  EXPECT_EQ(tracker.Level(leaves[2]), 1U);
  tracker.Update(RowOf("0000..1"));
  EXPECT_EQ(tracker.in_sight(), (std::vector{merged, leaves[2]}));
  tracker.Update(RowOf("0..1..2"));
  EXPECT_EQ(tracker.in_sight(), leaves);
}

TEST(GapTracker, ALeafThatVanishesWithinAMergedGapLeavesTheOther) {
  GapTracker tracker;
  tracker.Update(RowOf("00..11"));
  const Node left = tracker.in_sight()[0];
  tracker.Update(RowOf("000000"));
  tracker.Update(RowOf("00...."));
  EXPECT_EQ(tracker.in_sight(), std::vector{left});
  EXPECT_EQ(tracker.Level(left), 0U);
}

TEST(GapTracker, SeveralEventsAtATimeAreNoneTooMany) {
  GapTracker tracker;
  tracker.Update(RowOf("0000..11.22."));
  const std::vector<Node> leaves = tracker.in_sight();
  // The first splits in three, the second and third merge, another appears.
  tracker.Update(RowOf("0.12..3333.4"));
  ASSERT_EQ(tracker.in_sight().size(), 5U);
  EXPECT_FALSE(tracker.Contains(leaves[0]));
  EXPECT_EQ(tracker.Children(tracker.in_sight()[3]), (std::vector{leaves[1], leaves[2]}));
  EXPECT_EQ(tracker.Leaves().size(), 6U);
}

TEST(GapTracker, CellsThatGoOverToAnotherLeafChangeTheirNameOnly) {
  GapTracker tracker;
  tracker.Update(RowOf("0000.111"));
  const std::vector<Node> leaves = tracker.in_sight();
  tracker.Update(RowOf("000.1111"));
  EXPECT_EQ(tracker.in_sight(), leaves);
  tracker.Update(RowOf("00.11111"));
  EXPECT_EQ(tracker.in_sight(), leaves);
  EXPECT_EQ(tracker.LeafAt({3, 0, 0}), leaves[1]);
}

/// What holds after every look.
void ExpectATree(const GapTracker& tracker, const DenseGrid<int>& shadows) {
  const std::vector<Node> leaves = tracker.Leaves();
  EXPECT_EQ(std::set(leaves.begin(), leaves.end()).size(), leaves.size());
  std::set<Node> named;
  for (std::size_t k = 0; k < shadows.size(); ++k) {
    const auto leaf = tracker.LeafAt(shadows.IndexAt(k));
    ASSERT_EQ(leaf.has_value(), shadows[k] != kNoShadow);
    if (!leaf) continue;
    ASSERT_EQ(std::ranges::count(leaves, *leaf), 1);
    named.insert(*leaf);
  }
  EXPECT_EQ(named.size(), leaves.size()) << "each leaf hides something";
}

TEST(GapTracker, IsATreeWhateverTheMapShows) {
  std::mt19937 random(5);
  GapTracker tracker;
  for (int look = 0; look < 300; ++look) {
    const int edge = 12 + look % 9;  // the map's box grows and shrinks
    DenseGrid<PlaneCell> plane({{-edge, -10, 0}, {edge, 10, 1}}, PlaneCell::kWall);
    for (std::size_t k = 0; k < plane.size(); ++k) {
      const unsigned draw = random() % 8;
      plane[k] = draw == 0 ? PlaneCell::kWall : draw == 1 ? PlaneCell::kUnseen : PlaneCell::kFree;
    }
    const DenseGrid<int> shadows = FindShadows(plane, {static_cast<int>(random() % 10), 0, 0}, 1);
    tracker.Update(shadows);
    ASSERT_NO_FATAL_FAILURE(ExpectATree(tracker, shadows)) << "look " << look;
  }
}

/// A gap with its parts, which have no order.
template <class Tree>
std::string ShapeOf(const Tree& tree, std::size_t node) {
  std::vector<std::string> parts;
  for (const std::size_t part : tree.Children(node)) parts.push_back(ShapeOf(tree, part));
  std::ranges::sort(parts);
  std::string shape = "(";
  for (const std::string& part : parts) shape += part;
  return shape + ")";
}

/// A point that a gap hides, next to the middle of the line of sight past it.
Vector2d PointBehind(const Gap& gap, const std::vector<Vector2d>& pocket, const Polygon& polygon) {
  const Polygon outline(pocket);
  const Vector2d& vertex = polygon[gap.vertex];
  const Vector2d along = pocket.back() - vertex;
  const Vector2d aside = Turned(along, gap.hidden == GapSide::kLeft ? 1.5707963 : -1.5707963);
  for (double share = 0.1; share > 1e-12; share /= 2.0) {
    const Vector2d point = vertex + 0.5 * along + share * aside;
    if (outline.Contains(point)) return point;
  }
  ADD_FAILURE() << "the pocket is too thin";
  return vertex;
}

/// Positions along what a path has gained since it had `from` points.
std::vector<Vector2d> LooksAlong(const std::vector<Vector2d>& path, std::size_t from, double step) {
  std::vector<Vector2d> looks;
  for (std::size_t k = from; k < path.size(); ++k) {
    const int count = 1 + static_cast<int>((path[k] - path[k - 1]).norm() / step);
    for (int n = 1; n < count; ++n) looks.emplace_back(path[k - 1] + n * (path[k] - path[k - 1]) / count);
    looks.push_back(path[k]);
  }
  return looks;
}

/// Takes points of a polygon for cells, none beside another, and tells a tracker which gap hides each.
class PointWorld {
 public:
  explicit PointWorld(const Polygon& polygon) : polygon_(polygon) {}

  void Add(const Vector2d& point) { points_.push_back(point); }
  /// Adds a point behind each gap, so that none is overlooked.
  void AddBehindGapsAt(const Vector2d& robot) {
    for (const Gap& gap : SenseGaps(polygon_, robot))
      points_.push_back(PointBehind(gap, PocketOf(polygon_, robot, gap), polygon_));
  }
  DenseGrid<int> ShadowsFrom(const Vector2d& robot) const {
    DenseGrid<int> shadows({{0, 0, 0}, {2 * static_cast<int>(points_.size()), 1, 1}}, kNoShadow);
    const std::vector<Gap> gaps = SenseGaps(polygon_, robot);
    for (std::size_t number = 0; number < gaps.size(); ++number) {
      const Polygon pocket(PocketOf(polygon_, robot, gaps[number]));
      for (std::size_t k = 0; k < points_.size(); ++k) {
        if (pocket.Contains(points_[k])) shadows[2 * k] = static_cast<int>(number);
      }
    }
    return shadows;
  }

 private:
  const Polygon& polygon_;
  std::vector<Vector2d> points_;
};

class TrackedPolygon : public testing::TestWithParam<test::PolygonKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, TrackedPolygon, testing::ValuesIn(test::kPolygonKinds),
                         [](const auto& its) { return test::NameOf(its.param); });

TEST_P(TrackedPolygon, HasTheTreeOfTheEventsOnceEachIsLookedAt) {
  std::size_t merged = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    const Polygon polygon = test::RandomPolygon(GetParam(), seed);
    test::Dice dice(seed);
    const Vector2d start = test::RandomPointIn(dice, polygon);
    PointWorld world(polygon);
    for (int k = 0; k < 200; ++k) world.Add(test::RandomPointIn(dice, polygon));
    GapExplorer before(polygon, start);
    while (before.Step()) {
    }
    world.AddBehindGapsAt(start);
    for (const Vector2d& at : LooksAlong(before.robot().path(), 1, kStep)) world.AddBehindGapsAt(at);

    GapExplorer explorer(polygon, start);
    GapTracker tracker;
    tracker.Update(world.ShadowsFrom(start));
    std::size_t followed = 1;
    while (explorer.Step()) {
      const PointRobot& robot = explorer.robot();
      for (const Vector2d& at : LooksAlong(robot.path(), followed, kStep))
        tracker.Update(world.ShadowsFrom(at));
      followed = robot.path().size();
      const std::vector<Gap> gaps = SenseGaps(polygon, robot.position());
      ASSERT_EQ(tracker.in_sight().size(), gaps.size());
      for (std::size_t number = 0; number < gaps.size(); ++number) {
        const auto slot = std::ranges::find(robot.gaps(), gaps[number].vertex) - robot.gaps().begin();
        const std::string shape =
            ShapeOf(explorer.tree(), explorer.tree().in_sight()[static_cast<std::size_t>(slot)]);
        ASSERT_EQ(ShapeOf(tracker, tracker.in_sight()[number]), shape) << explorer.log().size() << " events";
        merged += shape == "()" ? 0 : 1;
      }
    }
  }
  EXPECT_GT(merged, 0U);
}

}  // namespace
}  // namespace thalweg::explorer
