#include "common/surface_graph/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/common/surface_graph/scenes.h"
#include "tests/support/analytic_room.h"

namespace thalweg::surface {
namespace {

using test::Rig;
using test::ViewOf;
using testing::HasSubstr;

/// The only surface of a view.
Surface Of(const View& view) {
  Surface surface({});
  surface.Add(view);
  return surface;
}

TEST(Surface, AreaOfASphereWithinAConeIsThatOfACap) {
  // Rays within `alpha` of the axis meet a sphere of radius R around (0, 0, D) within the polar angle phi,
  // where D sin(alpha) = R sin(alpha + phi).
  const double alpha = 0.2;
  const double distance = 2.0;
  const double radius = 0.6;
  const double phi = std::asin(distance * std::sin(alpha) / radius) - alpha;
  const auto cap = [&](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    return r.z() < r.norm() * std::cos(alpha) ? test::kNothing
                                              : test::SphereAt({0.0, 0.0, distance}, radius, o, r);
  };
  const double expected = 2.0 * std::numbers::pi * radius * radius * (1.0 - std::cos(phi));
  EXPECT_NEAR(Of(ViewOf(Rig(800, 800, 1800.0), RigidTransform::Identity(), cap)).Area(), expected,
              0.01 * expected);
}

TEST(Surface, AreaOfABoxIsThatOfTheSidesThatAreSeen) {
  thalweg::test::AnalyticRoom room;
  room.walls = Eigen::AlignedBox3d(Eigen::Vector3d(-9, -9, -9), Eigen::Vector3d(9, 9, 9));
  room.boxes = {Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -0.4, -0.3), Eigen::Vector3d(0.5, 0.4, 0.3))};
  const Eigen::Vector3d eye_W = Eigen::Vector3d(-2.0, -1.6, 1.4);
  const RigidTransform T_WC =
      MakeTransform(RotationFromYawPitch(std::atan2(1.6, 2.0), -0.5) * BodyFromOptical(), eye_W);
  const auto box_alone = [&](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    const double along = room.CastRay(o, r);
    return along < 4.5 ? along : test::kNothing;
  };
  const Surface surface = Of(ViewOf(Rig(1400, 1400, 2000.0), T_WC, box_alone));
  const double expected = 1.0 * 0.8 + 1.0 * 0.6 + 0.8 * 0.6;
  EXPECT_NEAR(surface.Area(), expected, 0.01 * expected);
  EXPECT_TRUE(FindRifts(surface.graph(), 0.1).empty());
}

TEST(Surface, AreaOfAStepIsThatOfBothItsWallsWithoutTheRift) {
  // 512 columns and 384 rows of pixels at f = 400: each wall fills half of the image.
  const Surface surface = Of(ViewOf(Rig(512, 384, 400.0), RigidTransform::Identity(), test::StepAt));
  const double near = (255 * 2.0 / 400) * (383 * 2.0 / 400);
  const double far = (255 * 4.0 / 400) * (383 * 4.0 / 400);
  EXPECT_NEAR(surface.Area(), near + far, 1e-3 * (near + far));
}

TEST(Surface, AreaOfAWallWithADoorwayIsThatOfTheWallAndOfWhatIsSeenThroughIt) {
  const auto doorway = [](const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
    const double wall = test::PlaneAt(2.0, o, r);
    const Eigen::Vector3d p_W = o + wall * r;
    const bool in_the_door = std::abs(p_W.x()) < 0.45 && p_W.y() > -0.7;
    return in_the_door ? test::PlaneAt(3.5, o, r) : wall;
  };
  Surface surface = Of(ViewOf(Rig(1024, 768, 800.0), RigidTransform::Identity(), doorway));
  // The door's lower edge is that of the image, 0.96 m below the axis.
  const double door = 0.9 * (0.7 + 0.96);
  const double expected = 2.56 * 1.92 - door + door * (3.5 * 3.5) / (2.0 * 2.0);
  EXPECT_NEAR(surface.Area(), expected, 0.01 * expected);
  const Move move = surface.PlanMove();
  ASSERT_EQ(move.rifts.size(), 1U) << "from one side of the door to the other, as one";
  const double outline_px = 800 * (0.9 + 2 * (0.7 + 0.96)) / 2.0;
  EXPECT_NEAR(static_cast<double>(move.rifts[0].edges.size()), outline_px, 0.01 * outline_px);
}

TEST(Surface, OfTwoViewsOfOnePlaneIsThatOfOneWiderView) {
  constexpr int kShift = 17;
  const auto [a, b] = test::PlaneTwice(Rig(60, 40, 50.0), 2.0, kShift);
  Surface surface({});
  surface.Add(a);
  const Addition addition = surface.Add(b);
  EXPECT_EQ(surface.raw_point_count(), 2U * 60U * 40U);
  EXPECT_EQ(addition.points - addition.dropped, 40U * kShift);
  EXPECT_EQ(surface.vertex_count(), (60U + kShift) * 40U);
  EXPECT_NEAR(surface.Area(), (59 + kShift) * 0.04 * 39 * 0.04, 1e-4);
}

TEST(Surface, RiftVerticesAreNotCountedAndLeaveWithTheNextView) {
  const StereoGeometry rig = Rig(100, 80, 70.0);
  const View first = ViewOf(rig, RigidTransform::Identity(), test::StepAt);
  const View second = ViewOf(rig, test::Shifted({1.0, 0.0, 0.0}), test::StepAt);
  Surface planned({});
  Surface unplanned({});
  planned.Add(first);
  unplanned.Add(first);
  EXPECT_EQ(planned.PlanMove().rifts.size(), 1U);
  EXPECT_EQ(planned.PlanMove().rifts.size(), 1U) << "a plan does not change the next one";
  EXPECT_EQ(planned.graph().vertex_count(), unplanned.graph().vertex_count() + 1);
  EXPECT_EQ(planned.vertex_count(), unplanned.vertex_count());
  EXPECT_EQ(planned.edge_count(), unplanned.edge_count());
  const Addition addition = planned.Add(second);
  EXPECT_EQ(addition.deleted, unplanned.Add(second).deleted);
  EXPECT_GT(addition.deleted, 0U);
  EXPECT_EQ(planned.graph().vertex_count(), unplanned.graph().vertex_count());
  EXPECT_EQ(planned.graph().edge_count(), unplanned.graph().edge_count());
}

TEST(Surface, TheMoveGoesToTheRiftAndLooksAlongItsNormal) {
  Surface surface({});
  surface.Add(ViewOf(Rig(100, 80, 70.0), RigidTransform::Identity(), test::StepAt));
  const Move move = surface.PlanMove();
  ASSERT_EQ(move.ranked.size(), 1U);
  EXPECT_EQ(move.path.vertices.front(), surface.CameraVertex());
  EXPECT_EQ(move.path.vertices.back(), move.rifts[0].vertex);
  EXPECT_NEAR(move.path.length, move.ranked[0].distance, 1e-9);
  ASSERT_TRUE(move.rift_normal);
  const Eigen::Vector3d end_W =
      move.rifts[0].center_W.cast<double>() + surface.options().height * *move.rift_normal;
  ASSERT_FALSE(move.poses.empty());
  EXPECT_NEAR((move.poses.back().T_WC.translation() - end_W).norm(), 0.0, 1e-6);
  EXPECT_GT(end_W.x(), 0.9) << "beside the step, from where what is behind it can be seen";
}

TEST(Surface, AnExplorationWithoutRiftsIsOver) {
  Surface surface({});
  EXPECT_EQ(surface.CameraVertex(), SurfaceGraph::kNone);
  EXPECT_TRUE(surface.PlanMove().poses.empty()) << "nothing was seen";
  surface.Add(test::PlaneTwice(Rig(60, 40, 50.0), 2.0, 0).first);
  const Move move = surface.PlanMove();
  EXPECT_TRUE(move.rifts.empty());
  EXPECT_TRUE(move.poses.empty());
}

TEST(Surface, AnEmptyViewAddsNothing) {
  Surface surface({});
  View blank{.rig = Rig(30, 20, 50.0), .disparities = std::vector<float>(600, 0.0F), .colors = {}};
  EXPECT_EQ(surface.Add(blank).points, 0U);
  EXPECT_EQ(surface.PlanMove().rifts.size(), 0U);
  EXPECT_EQ(surface.Area(), 0.0);
}

TEST(Surface, TheCameraThatSawAVertexFirstIsKnown) {
  const auto [a, b] = test::PlaneTwice(Rig(60, 40, 50.0), 2.0, 17);
  Surface surface({});
  surface.Add(a);
  surface.Add(b);
  EXPECT_EQ(surface.CameraOf(0), a.T_WC.translation());
  EXPECT_EQ(surface.CameraOf(60 * 40 - 1), a.T_WC.translation());
  EXPECT_EQ(surface.CameraOf(60 * 40), b.T_WC.translation());
}

TEST(Surface, BadOptionsAreRefusedByName) {
  const auto refusal = [](const auto& spoil) -> std::string {
    SurfaceOptions options;
    spoil(options);
    try {
      Surface surface(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_THAT(refusal([](SurfaceOptions& o) { o.rift_edge = 0.0; }), HasSubstr("rift_edge"));
  EXPECT_THAT(refusal([](SurfaceOptions& o) { o.height = 1e300; }), HasSubstr("height must be above 0 and at"));
  EXPECT_THAT(refusal([](SurfaceOptions& o) { o.merge_distance = NAN; }), HasSubstr("merge_distance"));
  EXPECT_THAT(refusal([](SurfaceOptions& o) { o.seen_through = 1.0; }), HasSubstr("seen_through"));
  EXPECT_THAT(refusal([](SurfaceOptions& o) { o.weights.distance = -1.0; }), HasSubstr("weights.distance"));
  EXPECT_THAT(refusal([](SurfaceOptions& o) { o.weights.edges = INFINITY; }), HasSubstr("weights.edges"));
  EXPECT_THAT(refusal([](SurfaceOptions& o) { o.height = -1.0; }), HasSubstr("height"));
}

}  // namespace
}  // namespace thalweg::surface
