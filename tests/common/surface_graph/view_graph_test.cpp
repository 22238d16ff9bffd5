#include "common/surface_graph/view_graph.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using test::Rig;
using test::ViewOf;

TEST(ViewGraph, EachValidPixelIsAVertexAndEachPairOfValidNeighborsAnEdge) {
  std::mt19937 random(2);
  View view{.rig = Rig(37, 23, 40.0), .disparities = {}, .colors = {}};
  for (int i = 0; i < 37 * 23; ++i) {
    const bool valid = random() % 4 != 0;
    view.disparities.push_back(valid ? 1.0F + 0.001F * static_cast<float>(random() % 1000) : 0.0F);
  }
  const ViewGraph result = GraphOf(view);
  std::size_t vertices = 0;
  std::size_t edges = 0;
  for (int v = 0; v < 23; ++v) {
    for (int u = 0; u < 37; ++u) {
      const auto valid = [&](int u2, int v2) {
        return u2 < 37 && v2 < 23 && view.disparities[view.PixelAt(u2, v2)] > 0.0F;
      };
      if (!valid(u, v)) continue;
      ++vertices;
      for (const auto& [u2, v2] : {std::pair(u + 1, v), std::pair(u, v + 1)}) {
        if (!valid(u2, v2)) continue;
        ++edges;
        const auto a = result.vertex_of_pixel[view.PixelAt(u, v)];
        const auto b = result.vertex_of_pixel[view.PixelAt(u2, v2)];
        EXPECT_TRUE(result.graph.AreNeighbors(a, b));
      }
    }
  }
  EXPECT_EQ(result.graph.vertex_count(), vertices);
  EXPECT_EQ(result.graph.edge_count(), edges);
}

// A sphere of radius R whose center is D in front of the camera fills a disc of f R / sqrt(D^2 - R^2) px.
// Each row and each column of the disc has one edge less than vertices.
TEST(ViewGraph, OfASphereHasTheVerticesAndEdgesOfADisc) {
  const double f = 600.0;
  const Eigen::Vector3d center_W(0.0, 0.0, 2.0);
  const auto sphere = [&](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    return test::SphereAt(center_W, 0.5, o, r);
  };
  const ViewGraph result = GraphOf(ViewOf(Rig(512, 384, f), RigidTransform::Identity(), sphere));
  const double radius_px = f * 0.5 / std::sqrt(4.0 - 0.25);
  const double vertices = std::numbers::pi * radius_px * radius_px;
  EXPECT_NEAR(static_cast<double>(result.graph.vertex_count()), vertices, 0.01 * vertices);
  const double edges = 2.0 * vertices - 4.0 * radius_px;
  EXPECT_NEAR(static_cast<double>(result.graph.edge_count()), edges, 0.01 * edges);
  for (SurfaceGraph::Vertex vertex = 0; vertex < result.graph.vertex_count(); vertex += 101) {
    EXPECT_NEAR((result.graph.Position(vertex).cast<double>() - center_W).norm(), 0.5, 1e-5);
  }
}

TEST(ViewGraph, StandsInTheWorldWhereTheCameraSawIt) {
  const RigidTransform T_WC =
      MakeTransform(RotationFromYawPitch(0.7, -0.3) * BodyFromOptical(), {3.0, -2.0, 1.5});
  const auto floor = [](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    return r.z() < 0.0 ? -o.z() / r.z() : test::kNothing;
  };
  const View view = ViewOf(Rig(80, 60, 60.0), T_WC, floor);
  const ViewGraph result = GraphOf(view);
  ASSERT_GT(result.graph.vertex_count(), 2000U);
  for (SurfaceGraph::Vertex vertex = 0; vertex < result.graph.vertex_count(); ++vertex) {
    const Eigen::Vector3f& p_W = result.graph.Position(vertex);
    EXPECT_NEAR(p_W.z(), 0.0, 1e-5 * p_W.norm());
  }
}

}  // namespace
}  // namespace thalweg::surface
