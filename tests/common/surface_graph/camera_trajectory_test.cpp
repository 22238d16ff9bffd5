#include "common/surface_graph/camera_trajectory.h"

#include <gtest/gtest.h>

#include <numeric>

#include "common/surface_graph/view_graph.h"
#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;

constexpr double kClose = 1e-5;

TEST(LookingAlong, PutsTheOpticalAxisThereAndTheImageUpright) {
  const Eigen::Vector3d p_W(1, 2, 3);
  for (const Eigen::Vector3d& toward : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 2, 0.5),
                                        Eigen::Vector3d(0.3, 0.1, -2), Eigen::Vector3d(0, -1, 1)}) {
    const Eigen::Vector3d forward_W = toward.normalized();
    const RigidTransform T_WC = LookingAlong(p_W, forward_W, RigidTransform::Identity());
    EXPECT_EQ(T_WC.translation(), p_W);
    EXPECT_NEAR((T_WC.linear().col(2) - forward_W).norm(), 0.0, 1e-12);
    EXPECT_NEAR(T_WC.linear()(2, 0), 0.0, 1e-12) << "the image's rows are horizontal";
    EXPECT_LT(T_WC.linear()(2, 1), 0.0) << "its columns run downward";
    EXPECT_NEAR(T_WC.linear().determinant(), 1.0, 1e-12);
  }
  EXPECT_NEAR((LookingAlong(p_W, {1, 0, 0}, RigidTransform::Identity()).linear() - BodyFromOptical()).norm(),
              0.0, 1e-12);
}

TEST(LookingAlong, StraightDownKeepsTheAxisOfThePoseBefore) {
  const RigidTransform before = LookingAlong({0, 0, 0}, {0, 1, 0}, RigidTransform::Identity());
  const RigidTransform down = LookingAlong({0, 0, 0}, {0, 0, -1}, before);
  EXPECT_NEAR((down.linear().col(0) - before.linear().col(0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((down.linear().transpose() * down.linear() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
}

TEST(CameraTrajectory, KeepsItsHeightOverASphereAndLooksBackAtIt) {
  const Eigen::Vector3d center_W(0.0, 0.0, 3.0);
  const auto sphere = [&](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    return test::SphereAt(center_W, 1.0, o, r);
  };
  const View view = test::ViewOf(test::Rig(200, 200, 250.0), RigidTransform::Identity(), sphere);
  const ViewGraph part = GraphOf(view);
  std::vector<Vertex> path;
  for (int u = 40; u < 160; ++u) path.push_back(part.vertex_of_pixel[view.PixelAt(u, 90)]);
  const Eigen::Vector3d rift_normal = Eigen::Vector3d(1.0, 0.0, -1.0).normalized();
  const auto poses = CameraTrajectory(
      part.graph, path, [](Vertex) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); }, rift_normal, 0.4,
      RigidTransform::Identity());
  ASSERT_EQ(poses.size(), path.size());
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    EXPECT_NEAR((poses[i].T_WC.translation() - center_W).norm(), 1.4, 1e-3);
    const Eigen::Vector3d seen_C = poses[i].T_WC.inverse() * part.graph.Position(path[i]).cast<double>();
    EXPECT_NEAR((seen_C - Eigen::Vector3d(0, 0, 0.4)).norm(), 0.0, kClose) << "straight ahead, at its height";
    EXPECT_EQ(poses[i].above_W, part.graph.Position(path[i]).cast<double>());
  }
  EXPECT_NEAR((poses.back().T_WC.linear().col(2) + rift_normal).norm(), 0.0, 1e-12);
  const Eigen::Vector3d last_C =
      poses.back().T_WC.inverse() * part.graph.Position(path.back()).cast<double>();
  EXPECT_NEAR((last_C - Eigen::Vector3d(0, 0, 0.4)).norm(), 0.0, kClose);
}

TEST(CameraTrajectory, LeavesOutVerticesWithoutANormal) {
  SurfaceGraph graph;
  for (const float x : {0.0F, 1.0F, 2.0F, 3.0F}) graph.AddVertex({x, 0.0F, 0.0F});
  for (const Vertex vertex : {0U, 1U, 2U}) graph.AddEdge(vertex, vertex + 1);
  const auto poses = CameraTrajectory(
      graph, {0, 1, 2, 3}, [](Vertex) -> Eigen::Vector3d { return Eigen::Vector3d::UnitZ(); },
      Eigen::Vector3d::UnitZ(), 1.0, RigidTransform::Identity());
  EXPECT_EQ(poses.size(), 1U);
}

TEST(PosesToLookFrom, AreEvenlySpacedAndEndAboveTheRift) {
  std::vector<CameraPose> poses(9);
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].above_W.x() = static_cast<double>(i);
  const std::vector<CameraPose> chosen = PosesToLookFrom(poses, 4);
  ASSERT_EQ(chosen.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(chosen[k].above_W.x(), 2.0 * static_cast<double>(k + 1));
  EXPECT_TRUE(PosesToLookFrom({}, 4).empty());
}

}  // namespace
}  // namespace thalweg::surface
