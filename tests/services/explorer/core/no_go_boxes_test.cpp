#include "services/explorer/core/no_go_boxes.h"

#include <gtest/gtest.h>

#include "common/geometry/polyline.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

const Eigen::Vector3d kHere_W{0.55, 0.65, 0.65};  // the center of a voxel in the long room

bool Anywhere(const VoxelIndex& /*i*/) {
  return true;
}

/// The knowledge of an explorer in the long room, and boxes to put into it.
class NoGoBoxesTest : public testing::Test {
 protected:
  NoGoBoxesTest() { knowledge_.Update(test::LongRoom(), {}, Time{}); }
  static Eigen::AlignedBox3d Slab(double min_x, double max_x) {
    return {Eigen::Vector3d(min_x, -0.1, -0.1), Eigen::Vector3d(max_x, 1.3, 1.3)};
  }
  static NoGoBoxes::Options Around(std::vector<Eigen::AlignedBox3d> fixed = {}) {
    return {.fixed = std::move(fixed),
            .robot_radius = RobotModel{}.radius,
            .exemption = 0.3,
            .wide_exemption = 1.0};
  }

  Knowledge knowledge_{{.map = {},
                        .memory = {},
                        .robot = {},
                        .camera = DepthSensorModel{}.camera,
                        .look_range = 1.0,
                        .min_measured_share = 0.5,
                        .reach = 0.3}};
};

TEST_F(NoGoBoxesTest, ABoxAwayFromTheRobotIsPutUpAndClearedAgain) {
  NoGoBoxes boxes(Around());
  boxes.Draw(Slab(3.0, 3.5));
  const VoxelIndex inside = knowledge_.map().IndexOf({3.25, 0.65, 0.65});
  boxes.PutUp(kHere_W, knowledge_);
  EXPECT_FALSE(boxes.robot_inside());
  EXPECT_TRUE(knowledge_.map().NoGo(inside));
  boxes.ClearDrawn(knowledge_);
  EXPECT_FALSE(knowledge_.map().NoGo(inside));
  EXPECT_TRUE(boxes.drawn().empty());
}

TEST_F(NoGoBoxesTest, TheShortestPathLeavesABoxByTheNearestPlaceWhereTheBodyIsClearOfIt) {
  NoGoBoxes boxes(Around());
  boxes.Draw(Slab(-0.1, 1.0));
  boxes.PutUp(kHere_W, knowledge_);
  ASSERT_TRUE(boxes.robot_inside());
  EXPECT_FALSE(knowledge_.map().NoGo(knowledge_.map().IndexOf(kHere_W))) << "it is lifted";
  const std::vector<Eigen::Vector3d> path_W = boxes.PathOut(knowledge_.map(), kHere_W, Anywhere);
  ASSERT_FALSE(path_W.empty());
  EXPECT_EQ(path_W.front(), kHere_W);
  // Along x alone, to the first voxel center in which the body does not reach into the box.
  double nearest = 0.0;
  for (double x = kHere_W.x(); nearest == 0.0; x += 0.1) {
    const VoxelIndex i = knowledge_.map().IndexOf({x, kHere_W.y(), kHere_W.z()});
    if (!boxes.ReachIntoLifted(knowledge_.map(), i)) nearest = x;
  }
  EXPECT_GE(nearest, 1.0 + RobotModel{}.radius);
  EXPECT_NEAR(path_W.back().x(), nearest, 1e-9);
  EXPECT_NEAR(PathLength(path_W), nearest - kHere_W.x(), 1e-9);
}

TEST_F(NoGoBoxesTest, ThePathEndsOnlyWhereItMay) {
  NoGoBoxes boxes(Around());
  const Eigen::Vector3d middle_W(3.05, 0.65, 0.65);
  boxes.Draw(Slab(2.0, 3.4));  // the far side is nearer
  boxes.PutUp(middle_W, knowledge_);
  const PlanningMap& map = knowledge_.map();
  EXPECT_GT(boxes.PathOut(map, middle_W, Anywhere).back().x(), 3.4);
  const auto near_side = [&](const VoxelIndex& i) { return map.CenterOf(i).x() < 2.0; };
  EXPECT_LT(boxes.PathOut(map, middle_W, near_side).back().x(), 2.0);
}

TEST_F(NoGoBoxesTest, TheScenariosBoxesStayEvenAroundTheRobot) {
  NoGoBoxes boxes(Around({Slab(0.0, 1.0)}));
  boxes.PutUp(kHere_W, knowledge_);
  EXPECT_FALSE(boxes.robot_inside());
  boxes.ClearDrawn(knowledge_);
  EXPECT_TRUE(knowledge_.map().NoGo(knowledge_.map().IndexOf(kHere_W)));
}

TEST_F(NoGoBoxesTest, ABoxThatFillsTheRoomHasNoPathOut) {
  NoGoBoxes boxes(Around());
  boxes.Draw(Slab(-1.0, 10.0));
  boxes.PutUp(kHere_W, knowledge_);
  EXPECT_TRUE(boxes.robot_inside());
  EXPECT_TRUE(boxes.PathOut(knowledge_.map(), kHere_W, Anywhere).empty());
  boxes.Undraw();
  boxes.PutUp(kHere_W, knowledge_);
  EXPECT_FALSE(boxes.robot_inside());
}

}  // namespace
}  // namespace thalweg::explorer
