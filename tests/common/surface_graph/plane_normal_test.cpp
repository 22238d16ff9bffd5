#include "common/surface_graph/plane_normal.h"

#include <gtest/gtest.h>

#include "common/surface_graph/view_graph.h"
#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using test::Rig;
using test::ViewOf;
using Vertex = SurfaceGraph::Vertex;

TEST(PlaneNormal, OfAPlaneIsItsNormalTowardsTheCamera) {
  const RigidTransform T_WC = MakeTransform(RotationFromYawPitch(0.4, -0.5) * BodyFromOptical(), {1, 2, 1.5});
  const auto floor = [](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    return r.z() < 0.0 ? -o.z() / r.z() : test::kNothing;
  };
  const ViewGraph part = GraphOf(ViewOf(Rig(60, 40, 60.0), T_WC, floor));
  for (Vertex vertex = 0; vertex < part.graph.vertex_count(); vertex += 13) {
    const auto normal = PlaneNormal(part.graph, vertex, T_WC.translation());
    ASSERT_TRUE(normal);
    EXPECT_NEAR(normal->z(), 1.0, 1e-4);
    EXPECT_NEAR(PlaneNormal(part.graph, vertex, {0, 0, -3})->z(), -1.0, 1e-4) << "from below";
  }
}

TEST(PlaneNormal, OfASphereIsItsRadius) {
  const Eigen::Vector3d center_W(0.0, 0.0, 3.0);
  const auto sphere = [&](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    return test::SphereAt(center_W, 1.0, o, r);
  };
  const View view = ViewOf(Rig(200, 200, 250.0), RigidTransform::Identity(), sphere);
  const ViewGraph part = GraphOf(view);
  for (int v = 50; v < 150; v += 7) {  // within the disc of 88 px, where all have four neighbors
    for (int u = 50; u < 150; u += 7) {
      const Vertex vertex = part.vertex_of_pixel[view.PixelAt(u, v)];
      ASSERT_NE(vertex, SurfaceGraph::kNone);
      const auto normal = PlaneNormal(part.graph, vertex, Eigen::Vector3d::Zero());
      ASSERT_TRUE(normal);
      const Eigen::Vector3d radius = part.graph.Position(vertex).cast<double>() - center_W;
      EXPECT_GT(normal->dot(radius.normalized()), 0.999);
    }
  }
}

TEST(PlaneNormal, PointsOnALineHaveNone) {
  SurfaceGraph graph;
  for (const float x : {0.0F, 1.0F, 2.0F}) graph.AddVertex({x, 2.0F * x, 0.0F});
  graph.AddEdge(0, 1);
  EXPECT_FALSE(PlaneNormal(graph, 1, Eigen::Vector3d::UnitZ())) << "two points";
  graph.AddEdge(1, 2);
  EXPECT_FALSE(PlaneNormal(graph, 1, Eigen::Vector3d::UnitZ()));
}

/// The normal of the only rift that a camera sees.
Eigen::Vector3d NormalSeen(const RigidTransform& T_WC) {
  ViewGraph part = GraphOf(ViewOf(Rig(101, 80, 70.0), T_WC, test::StepAt));
  std::vector<Rift> rifts = FindRifts(part.graph, 0.1);
  EXPECT_EQ(rifts.size(), 1U);
  AddRiftVertices(rifts, part.graph);
  return RiftNormal(part.graph, rifts.front(), T_WC.translation()).value();
}

// The hidden part of the far wall lies behind the near one, at x < 0: it is to be looked at from x > 0.
TEST(RiftNormal, OfAStepPointsToTheSideFromWhichTheHiddenWallIsSeen) {
  for (const double x : {-0.3, 0.0, 0.1, 0.4}) {
    const Eigen::Vector3d normal = NormalSeen(test::Shifted({x, 0.0, 0.0}));
    EXPECT_GT(normal.x(), 0.5) << x;
    EXPECT_NEAR(normal.y(), 0.0, 1e-2) << x;
    // The rift lies in the plane of the line of sight (-x, 2) past the edge of the near wall, to two pixels.
    EXPECT_NEAR(std::abs(normal.dot(Eigen::Vector3d(-x, 0.0, 2.0).normalized())), 0.0, 2.0 / 70.0) << x;
  }
}

TEST(RiftNormal, OfAThingThatIsSeenAllAroundPointsToTheCamera) {
  View view{.rig = Rig(90, 60, 80.0), .disparities = std::vector<float>(90 * 60, 3.2F), .colors = {}};
  for (int v = 20; v < 40; ++v) {
    for (int u = 35; u < 55; ++u) view.disparities[view.PixelAt(u, v)] = 3.4F;
  }
  ViewGraph part = GraphOf(view);
  std::vector<Rift> rifts = FindRifts(part.graph, 0.1);
  ASSERT_EQ(rifts.size(), 1U);
  AddRiftVertices(rifts, part.graph);
  EXPECT_LT(RiftNormal(part.graph, rifts[0], Eigen::Vector3d::Zero())->z(), -0.99);
}

}  // namespace
}  // namespace thalweg::surface
