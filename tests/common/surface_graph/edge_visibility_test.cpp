#include "common/surface_graph/edge_visibility.h"

#include <gtest/gtest.h>

#include <random>

#include "common/surface_graph/rift.h"
#include "common/surface_graph/view_graph.h"
#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using test::Rig;

TEST(PixelsOfALine, FollowItWithinHalfAPixelFromEndToEnd) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 500; ++trial) {
    const int u0 = static_cast<int>(random() % 60);
    const int v0 = static_cast<int>(random() % 60);
    const int u1 = static_cast<int>(random() % 60);
    const int v1 = static_cast<int>(random() % 60);
    std::vector<Eigen::Vector2d> pixels;
    ForEachPixelOfLine(u0, v0, u1, v1, [&](int u, int v) { pixels.emplace_back(u, v); });
    const int steps = std::max(std::abs(u1 - u0), std::abs(v1 - v0));
    ASSERT_EQ(pixels.size(), static_cast<std::size_t>(steps) + 1);
    EXPECT_EQ(pixels.front(), Eigen::Vector2d(u0, v0));
    EXPECT_EQ(pixels.back(), Eigen::Vector2d(u1, v1));
    for (int i = 0; i <= steps; ++i) {
      const double along = steps > 0 ? static_cast<double>(i) / steps : 0.0;
      const Eigen::Vector2d ideal(u0 + along * (u1 - u0), v0 + along * (v1 - v0));
      EXPECT_LE((pixels[static_cast<std::size_t>(i)] - ideal).cwiseAbs().maxCoeff(), 0.5 + 1e-9);
    }
  }
}

/// An edge across a doorway at z = 2, which fills 100 pixels of a row; `seen` of them show a wall at z = 5,
/// the others something before the edge.
bool DoorwayEdgeDies(int seen, float hidden_depth, double share) {
  View view{.rig = Rig(200, 5, 100.0), .disparities = {}, .colors = {}};
  DepthImage depth{200, 5, std::vector<float>(1000, hidden_depth)};
  for (int i = 0; i < seen; ++i) depth.depths[view.PixelAt(50 + i, 2)] = 5.0F;
  view.disparities = DisparitiesOf(depth, view.rig);
  const Eigen::Vector3d a_C = 2.0 * view.rig.camera.RayAtUnitDepth(50, 2);
  const Eigen::Vector3d b_C = 2.0 * view.rig.camera.RayAtUnitDepth(149, 2);
  return IsSeenThrough(view, a_C, b_C, {.share = share, .margin = 0.01});
}

TEST(EdgeVisibility, AnEdgeAcrossADoorwayDiesExactlyWhenMoreThanThreeQuartersOfItAreSeenThrough) {
  for (int seen = 0; seen <= 100; ++seen) {
    EXPECT_EQ(DoorwayEdgeDies(seen, 1.5F, 0.75), seen > 75) << seen;
    EXPECT_EQ(DoorwayEdgeDies(seen, std::numeric_limits<float>::quiet_NaN(), 0.75), seen > 75)
        << seen << ", and the rest not measured";
    EXPECT_EQ(DoorwayEdgeDies(seen, 1.5F, 0.5), seen > 50) << seen;
  }
}

// From z = 1 at one end to z = 9 at the other, before a wall at z = 3: the edge is nearer than the wall while
// its inverse depth, which is linear in the image, is above 1/3: for 3/4 of its pixels.
TEST(EdgeVisibility, TheDepthAlongAnEdgeIsThatOfPerspective) {
  View view{.rig = Rig(200, 5, 100.0), .disparities = {}, .colors = {}};
  const auto dies = [&](float wall) {
    view.disparities = DisparitiesOf({200, 5, std::vector<float>(1000, wall)}, view.rig);
    return IsSeenThrough(view, view.rig.camera.RayAtUnitDepth(20, 2),
                         9.0 * view.rig.camera.RayAtUnitDepth(180, 2), {.share = 0.75, .margin = 0.0});
  };
  EXPECT_FALSE(dies(2.9F));
  EXPECT_TRUE(dies(3.1F));
}

TEST(EdgeVisibility, AnEdgeThatLeavesTheImageOrBeginsBehindTheCameraIsNotJudged) {
  View view{.rig = Rig(200, 5, 100.0), .disparities = {}, .colors = {}};
  view.disparities = DisparitiesOf({200, 5, std::vector<float>(1000, 5.0F)}, view.rig);
  const Eigen::Vector3d inside(0.0, 0.0, 2.0);
  EXPECT_TRUE(IsSeenThrough(view, inside, {1.0, 0.0, 2.0}, {}));
  EXPECT_FALSE(IsSeenThrough(view, inside, {3.0, 0.0, 2.0}, {}));
  EXPECT_FALSE(IsSeenThrough(view, inside, {0.0, 0.0, -2.0}, {}));
}

TEST(EdgeVisibility, NoEdgeIsSeenThroughInTheImageThatItIsFrom) {
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0.0, 0.05);
  const RigidTransform T_WC =
      MakeTransform(RotationFromYawPitch(0.7, 0.2) * BodyFromOptical(), {5.0, -3.0, 1.0});
  const auto noisy = [&](const Eigen::Vector3d&, const Eigen::Vector3d&) { return 3.0 + noise(random); };
  const View view = test::ViewOf(Rig(100, 80, 70.0), T_WC, noisy);
  ViewGraph part = GraphOf(view);
  ASSERT_FALSE(FindRifts(part.graph, 0.1).empty());
  EXPECT_EQ(DeleteEdgesSeenThrough(view, 0.1, 0, {}, part.graph), 0U);
}

TEST(EdgeVisibility, TheRiftOfAStepDiesWhenItIsLookedThroughFromTheSide) {
  const StereoGeometry rig = Rig(200, 150, 120.0);
  ViewGraph part = GraphOf(test::ViewOf(rig, RigidTransform::Identity(), test::StepAt));
  ASSERT_EQ(FindRifts(part.graph, 0.1).size(), 1U);
  const std::size_t edges = part.graph.edge_count();
  // From the left, nothing is seen of the room behind the near wall.
  const View from_the_left = test::ViewOf(rig, test::Shifted({-0.5, 0.0, 0.0}), test::StepAt);
  EXPECT_EQ(DeleteEdgesSeenThrough(from_the_left, 0.1, 0, {}, part.graph), 0U);
  const View from_the_right = test::ViewOf(rig, test::Shifted({1.0, 0.0, 0.0}), test::StepAt);
  EXPECT_EQ(DeleteEdgesSeenThrough(from_the_right, 0.1, 0, {}, part.graph), 150U);
  EXPECT_TRUE(FindRifts(part.graph, 0.1).empty());
  EXPECT_EQ(part.graph.edge_count(), edges - 150U);
}

}  // namespace
}  // namespace thalweg::surface
