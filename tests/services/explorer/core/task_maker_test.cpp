#include "services/explorer/core/task_maker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/angles.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using test::kStart;
using testing::SizeIs;

constexpr VoxelBox kWideRoom{{0, 0, 0}, {60, 40, 30}};

std::vector<Eigen::Vector3d> PointsOf(const Task& task) {
  std::vector<Eigen::Vector3d> points_W;
  for (const RigidTransform& T_WB : task.plan.T_WBs) points_W.push_back(T_WB.translation());
  return points_W;
}

/// The sharpest corner of a path [rad].
double SharpestCorner(const std::vector<Eigen::Vector3d>& path_W) {
  double sharpest = 0.0;
  for (std::size_t n = 2; n < path_W.size(); ++n) {
    const Eigen::Vector3d before_W = path_W[n - 1] - path_W[n - 2];
    const Eigen::Vector3d after_W = path_W[n] - path_W[n - 1];
    sharpest = std::max(sharpest, std::atan2(before_W.cross(after_W).norm(), before_W.dot(after_W)));
  }
  return sharpest;
}

/// A robot in a room of 6 x 4 x 3 m whose far end is unknown.
class TaskMakerTest : public testing::Test {
 protected:
  /// Makes the knowledge again, from what the options and the map are by now.
  TaskMaker Maker(const TaskMaker::Lead* lead = nullptr) {
    knowledge_.emplace(KnowledgeOptions(options_));
    if (options_.robot.drives) T_WB_ = knowledge_->InPlane(T_WB_);
    knowledge_->Update(changes_, {}, kStart);
    return {options_, *knowledge_, lead};
  }
  const PlanningMap& map() const { return knowledge_->map(); }
  static TaskMaker::Lead LeadTo(const RigidTransform& T_WB) {
    return {.path = {.T_WBs = {test::At(0.55, 1.05, 1.55), test::At(0.95, 1.05, 1.55), T_WB},
                     .narrow = {false, false, false}},
            .hears = {},
            .flight = {}};
  }
  /// How many of the voxels lie in sight and in the image of a body's camera.
  std::size_t ShownOf(const std::vector<VoxelIndex>& voxels, const RigidTransform& T_WB) const {
    return static_cast<std::size_t>(std::ranges::count_if(voxels, [&](const VoxelIndex& i) {
      const Eigen::Vector3d offset_W = map().CenterOf(i) - T_WB.translation();
      const std::optional<Eigen::Vector2d> uv = options_.camera.Project(
          options_.robot.T_BC.linear().transpose() * T_WB.linear().transpose() * offset_W);
      return uv && offset_W.norm() <= options_.look_range &&
             map().InSight(T_WB.translation(), map().CenterOf(i));
    }));
  }
  /// Two candidates at the far end: its halves by y.
  std::vector<Candidate> HalvesOfTheFarEnd() const {
    std::vector<Candidate> candidates(2);
    test::ForEachVoxel({{60, 0, 0}, {61, 40, 30}}, [&](const VoxelIndex& i) {
      candidates[i.y < 20 ? 0 : 1].cluster.unknowns.push_back(i);
    });
    candidates[0].cluster.center_W = {6.05, 1.0, 1.5};
    candidates[1].cluster.center_W = {6.05, 3.0, 1.5};
    return candidates;
  }

  ExplorerOptions options_ = test::GoingOptions();
  std::vector<VoxelChange> changes_ = test::LongRoom(kWideRoom);
  std::optional<Knowledge> knowledge_;
  RigidTransform T_WB_ = test::At(1.05, 1.05, 1.55);
  StageTimings timings_;

  /// With a corner of a right angle, far from all walls.
  const std::vector<Eigen::Vector3d> path_W_ = {{1.05, 1.05, 1.55}, {3.05, 1.05, 1.55}, {3.05, 2.55, 1.55}};
  const Eigen::Matrix3d R_WB_ = RotationFromYawPitch(-70.0 * kDegree, 20.0 * kDegree);
};

TEST_F(TaskMakerTest, ATurnStaysWhereTheRobotIs) {
  const Task task = *Maker().Turn(Purpose::kFindFreeSpace, R_WB_, T_WB_);
  EXPECT_EQ(task.plan.kind, Plan::Kind::kLook);
  EXPECT_EQ(task.plan.purpose, Purpose::kFindFreeSpace);
  ASSERT_THAT(task.plan.T_WBs, SizeIs(1));
  EXPECT_EQ(task.plan.T_WBs[0].translation(), T_WB_.translation());
  EXPECT_EQ(task.plan.T_WBs[0].linear(), R_WB_);
  EXPECT_EQ(task.plan.length, 0.0);
  EXPECT_FALSE(task.plan.target_W);
  EXPECT_FALSE(task.plan.ending);
  EXPECT_FALSE(task.turn_first);
}

TEST_F(TaskMakerTest, ARobotThatTurnsOnlyInCurvesDrivesToWhereItLooksAndToAnyHeadingOtherwise) {
  options_.robot.drives = true;
  options_.robot.height = 0.4;
  options_.robot.drive = Drive::kAckermann;
  options_.robot.min_turning_radius = 0.4;
  const TaskMaker make = Maker();
  const Eigen::Matrix3d back = RotationFromYawPitch(3.0, 0.0);
  const std::optional<Task> turn = make.Turn(Purpose::kLookAt, back, T_WB_);
  ASSERT_TRUE(turn);
  EXPECT_EQ(turn->plan.kind, Plan::Kind::kGo);
  EXPECT_GT(turn->plan.length, 0.5);
  EXPECT_LT(AngleBetween(turn->plan.T_WBs.back().linear(), back), 10.1 * kDegree);
  EXPECT_EQ(turn->narrow.size(), turn->plan.T_WBs.size());
  const std::optional<Task> stay = make.Turn(Purpose::kLookAt, RotationFromYawPitch(0.1, 0.0), T_WB_);
  ASSERT_TRUE(stay);
  EXPECT_EQ(stay->plan.kind, Plan::Kind::kLook) << "it looks there already";
  const std::optional<Task> go =
      make.Follow(Purpose::kGoTo, {T_WB_.translation(), {3.05, 1.05, 1.55}}, back, T_WB_);
  ASSERT_TRUE(go);
  EXPECT_NEAR(go->plan.length, 2.0, 0.15) << "straight, whatever the heading at its end";
  EXPECT_FALSE(make.Turn(Purpose::kLookAt, back, test::At(-3, 0, 1.55))) << "where nothing is known";
}

TEST_F(TaskMakerTest, ALookAroundTurnsToTheUnknownAndAimsAtAllOfItInTheImage) {
  const TaskMaker make = Maker();
  const RigidTransform near_the_end = test::At(5.55, 2.05, 1.55);
  const std::optional<Task> look = make.LookAround(near_the_end, 1);
  ASSERT_TRUE(look);
  EXPECT_EQ(look->plan.kind, Plan::Kind::kLook);
  EXPECT_EQ(look->plan.purpose, Purpose::kLookAround);
  ASSERT_THAT(look->plan.T_WBs, SizeIs(1));
  const RigidTransform& T_WB = look->plan.T_WBs[0];
  EXPECT_EQ(T_WB.translation(), near_the_end.translation());
  ASSERT_TRUE(look->plan.target_W);
  const Eigen::Vector3d ahead_W = T_WB * Eigen::Vector3d(1.0, 0.0, 0.0);
  EXPECT_LT((*look->plan.target_W - ahead_W).norm(), 1e-9) << "a meter ahead";
  std::vector<VoxelIndex> far_end;
  test::ForEachVoxel({{60, 0, 0}, {61, 40, 30}}, [&](const VoxelIndex& i) { far_end.push_back(i); });
  for (const Eigen::Matrix3d& R_WB : knowledge_->views().candidates())
    EXPECT_LE(ShownOf(far_end, MakeTransform(R_WB, T_WB.translation())), look->target.size());
  EXPECT_EQ(look->target.size(), ShownOf(far_end, T_WB));
  EXPECT_EQ(ShownOf(look->target, T_WB), look->target.size());
  EXPECT_EQ(look->plan.target_unknown, look->target.size());
  EXPECT_EQ(look->plan.target_doubtful, 0U);
  // Exactly as much as it shows is enough.
  EXPECT_TRUE(make.LookAround(near_the_end, look->target.size()));
  EXPECT_FALSE(make.LookAround(near_the_end, look->target.size() + 1));
}

TEST_F(TaskMakerTest, ALookAroundWantsNothingThatWasLookedAtOrSetAside) {
  const RigidTransform near_the_end = test::At(5.55, 2.05, 1.55);
  const std::optional<Task> first = Maker().LookAround(near_the_end, 1);
  ASSERT_TRUE(first);
  for (const bool aside : {false, true}) {
    const TaskMaker make = Maker();
    for (const VoxelIndex& i : first->target) {
      if (aside) {
        knowledge_->memory().SetAside(i, AsideReason::kVisited, kStart);
      } else {
        knowledge_->memory().CountLook(i, AsideReason::kLookedAt, Sensed::kDepth, kStart);
      }
    }
    const std::optional<Task> second = make.LookAround(near_the_end, 1);
    ASSERT_TRUE(second) << "what was outside of the image is left";
    for (const VoxelIndex& i : second->target)
      EXPECT_THAT(first->target, testing::Not(testing::Contains(i))) << i.y << ' ' << i.z;
  }
}

TEST_F(TaskMakerTest, WithNothingUnknownInSightThereIsNoLookAround) {
  EXPECT_FALSE(Maker().LookAround(T_WB_, 1)) << "the far end is beyond the range of a look";
}

TEST_F(TaskMakerTest, FollowsAPathAsItIsAndTurnsAtItsEnd) {
  const Task task = *Maker().Follow(Purpose::kGoTo, path_W_, R_WB_, T_WB_);
  EXPECT_EQ(task.plan.kind, Plan::Kind::kGo);
  EXPECT_EQ(task.plan.purpose, Purpose::kGoTo);
  EXPECT_NEAR(task.plan.length, 3.5, 1e-12);
  const std::vector<Eigen::Vector3d> points_W = PointsOf(task);
  EXPECT_EQ(points_W.front(), path_W_.front());
  EXPECT_EQ(points_W.back(), path_W_.back());
  EXPECT_NEAR(PathLength(points_W), 3.5, 1e-9);
  EXPECT_NEAR(SharpestCorner(points_W), 90.0 * kDegree, 1e-9) << "it stops to turn";
  EXPECT_EQ(task.plan.T_WBs.back().linear(), R_WB_);
  EXPECT_EQ(task.narrow.size(), points_W.size());
  EXPECT_EQ(task.clearance.size(), points_W.size() - 1);
  EXPECT_TRUE(std::ranges::none_of(task.narrow, [](bool narrow) { return narrow; }));
  EXPECT_TRUE(task.StillClear(map(), path_W_.front(), options_.least_clearance(), options_.robot.radius));
}

TEST_F(TaskMakerTest, TurnsFirstToAHoleInAWallRightAhead) {
  test::Fill(changes_, {{15, 0, 0}, {16, 40, 30}}, VoxelState::kOccupied);
  test::Fill(changes_, {{15, 9, 14}, {16, 12, 17}}, VoxelState::kFree);
  T_WB_ = MakeTransform(RotationFromYawPitch(std::numbers::pi, 0.0), {1.25, 1.05, 1.55});
  const std::vector<Eigen::Vector3d> through_W = {T_WB_.translation(), {3.05, 1.05, 1.55}};
  const Task task = *Maker().Follow(Purpose::kGoTo, through_W, R_WB_, T_WB_);
  EXPECT_TRUE(task.turn_first);
  EXPECT_NEAR(task.plan.T_WBs.front().linear()(0, 0), 1.0, 1e-9);
  EXPECT_TRUE(std::ranges::any_of(task.narrow, [](bool narrow) { return narrow; }));
}

TEST_F(TaskMakerTest, WhereTimeCountsACornerBecomesACurve) {
  options_.minimize = Minimize::kTime;
  const Task task = *Maker().Follow(Purpose::kGoTo, path_W_, R_WB_, T_WB_);
  const std::vector<Eigen::Vector3d> points_W = PointsOf(task);
  EXPECT_LT((points_W.front() - path_W_.front()).norm(), 1e-9);
  EXPECT_LT((points_W.back() - path_W_.back()).norm(), 1e-9);
  EXPECT_LT(SharpestCorner(points_W), 45.0 * kDegree);
  EXPECT_LT(PathLength(points_W), 3.5) << "it cuts the corner";
  EXPECT_NEAR(task.plan.length, 3.5, 1e-12) << "what was decided on";
}

TEST_F(TaskMakerTest, APathThatIsLedToBeginsOnTheLastSegmentOfItsLead) {
  options_.minimize = Minimize::kTime;
  const TaskMaker::Lead lead = LeadTo(T_WB_);
  const Task task = *Maker(&lead).Follow(Purpose::kGoTo, path_W_, R_WB_, T_WB_);
  EXPECT_LT((task.plan.T_WBs.front().translation() - Eigen::Vector3d(0.95, 1.05, 1.55)).norm(), 1e-9);
  EXPECT_NEAR(task.plan.length, 3.5, 1e-12) << "without what leads there";
  EXPECT_FALSE(task.lead_poses);
}

TEST_F(TaskMakerTest, ARobotInFlightSwingsOntoItsPathWhereThatIsClear) {
  options_.minimize = Minimize::kTime;
  TaskMaker::Lead lead = LeadTo(T_WB_);
  lead.hears = {.pose = 1, .T_WB = lead.path.T_WBs[1], .left = 9.0};
  lead.flight =
      Flight{.p_W = {0.95, 1.05, 1.55}, .v_W = {0.5, 0.0, 0.0}, .max_speed = 0.5, .max_acceleration = 1.0};
  const Task task = *Maker(&lead).Follow(Purpose::kGoTo, path_W_, R_WB_, T_WB_);
  ASSERT_EQ(task.lead_poses, 2U) << "the rest of what leads to the path is not flown";
  const std::vector<RigidTransform>& T_WBs = task.plan.T_WBs;
  EXPECT_EQ(T_WBs.front().translation(), lead.flight->p_W);
  EXPECT_LT((T_WBs.back().translation() - path_W_.back()).norm(), 1e-9);
  for (const RigidTransform& T_WB : T_WBs) {
    EXPECT_GE(map().ClearanceAt(T_WB.translation(), PlanningMap::Obstacles::kOccupiedAndUnknown, 1.0),
              options_.clearance() - 1e-6);
  }
  // One that flies there already goes on.
  lead.flight->p_W = path_W_.front() - Eigen::Vector3d(0.1, 0.0, 0.0);
  const Task straight = *Maker(&lead).Follow(Purpose::kGoTo, path_W_, R_WB_, T_WB_);
  EXPECT_EQ(straight.plan.T_WBs.front().translation(), lead.flight->p_W);
  EXPECT_EQ(straight.lead_poses, 2U);
  EXPECT_LT((straight.plan.T_WBs.back().translation() - path_W_.back()).norm(), 1e-9);
  lead.flight->p_W = {0.95, 1.05, 1.55};
  // Where it would turn back, it goes on to where it can stand.
  lead.flight->v_W = {-0.5, 0.0, 0.0};
  EXPECT_FALSE(Maker(&lead).Follow(Purpose::kGoTo, path_W_, R_WB_, T_WB_)->lead_poses);
}

TEST_F(TaskMakerTest, FacesTheDirectionOfTravelWhereTheRulesSaySo) {
  options_.loop.face_target = false;
  const Task task = *Maker().Follow(Purpose::kGoTo, path_W_, R_WB_, T_WB_);
  ASSERT_THAT(task.plan.T_WBs, SizeIs(3));
  EXPECT_LT((task.plan.T_WBs[1].linear().col(0) - Eigen::Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_LT((task.plan.T_WBs[2].linear().col(0) - Eigen::Vector3d::UnitY()).norm(), 1e-9)
      << "at the end, too, whatever is to be seen";
}

TEST_F(TaskMakerTest, ARobotThatMovesOnlyWhereItFacesTurnsOnlyWhereItStands) {
  options_.robot.drives = true;
  options_.robot.height = 0.4;
  options_.robot.drive = Drive::kDifferential;
  const Eigen::Matrix3d R_WB = RotationFromYawPitch(-70.0 * kDegree, 0.0);
  const Task task = *Maker().Follow(Purpose::kGoTo, path_W_, R_WB, T_WB_);
  const std::vector<RigidTransform>& T_WBs = task.plan.T_WBs;
  double traveled = 0.0;
  for (std::size_t n = 1; n < T_WBs.size(); ++n) {
    const Eigen::Vector3d along_W = T_WBs[n].translation() - T_WBs[n - 1].translation();
    traveled += along_W.norm();
    if (along_W.norm() < 1e-9) continue;
    EXPECT_NEAR(T_WBs[n].linear().col(0).dot(along_W.normalized()), 1.0, 1e-9) << n;
  }
  EXPECT_NEAR(traveled, 3.5, 1e-9);
  EXPECT_LT((T_WBs.back().linear() - R_WB).norm(), 1e-12) << "at last it turns to what is to be seen";
}

TEST_F(TaskMakerTest, ARobotThatDrivesStaysAtTheHeightOfItsPlane) {
  options_.robot.drives = true;
  options_.robot.height = 0.4;
  T_WB_ = test::At(1.05, 1.05, 0.38);
  std::vector<Eigen::Vector3d> path_W = path_W_;
  for (std::size_t n = 0; n < path_W.size(); ++n) path_W[n].z() = 0.35 + 0.02 * static_cast<double>(n);
  const Task task = *Maker().Follow(Purpose::kGoTo, path_W, Eigen::Matrix3d::Identity(), T_WB_);
  ASSERT_FALSE(task.plan.T_WBs.empty());
  for (const Eigen::Vector3d& p_W : PointsOf(task)) EXPECT_EQ(p_W.z(), 0.38);
}

TEST_F(TaskMakerTest, SmoothingMakesStepsStraightAndKeepsTheEnds) {
  // Steps of a voxel to the front and to the left, in the middle of the room.
  std::vector<Eigen::Vector3d> steps_W = {T_WB_.translation()};
  for (int n = 0; n < 20; ++n)
    steps_W.emplace_back(steps_W.back() +
                         (n % 2 == 0 ? Eigen::Vector3d(0.1, 0, 0) : Eigen::Vector3d(0, 0.1, 0)));
  const std::vector<Eigen::Vector3d> path_W = Maker().Smoothed(steps_W);
  EXPECT_EQ(path_W.front(), steps_W.front());
  EXPECT_EQ(path_W.back(), steps_W.back());
  EXPECT_NEAR(PathLength(path_W), std::numbers::sqrt2, 1e-9) << "1 m to the front and 1 m to the left";
}

TEST_F(TaskMakerTest, SmoothingLeadsAPathAwayFromAWallUnlessThatIsNotWanted) {
  const std::vector<Eigen::Vector3d> along_W = {{1.05, 0.15, 1.55}, {1.55, 0.15, 1.55}, {4.05, 0.15, 1.55}};
  const auto farthest = [&](const std::vector<Eigen::Vector3d>& path_W) {
    double y = 0.0;
    for (const Eigen::Vector3d& p_W : path_W) y = std::max(y, p_W.y());
    return y;
  };
  const std::vector<Eigen::Vector3d> path_W = Maker().Smoothed(along_W);
  EXPECT_GE(farthest(path_W), options_.clearance() + options_.comfort.distance - 0.05);
  EXPECT_EQ(path_W.front(), along_W.front());
  EXPECT_EQ(path_W.back(), along_W.back());
  options_.comfort.distance = 0.0;
  EXPECT_EQ(Maker().Smoothed(along_W), (std::vector{along_W.front(), along_W.back()}));
}

TEST_F(TaskMakerTest, SeeingAFrontierSaysWhatItIsToShow) {
  options_.loop.stop_short = false;
  const TaskMaker make = Maker();
  const std::vector<Candidate> candidates = HalvesOfTheFarEnd();
  const Choice choice{
      .candidate = 1, .path_W = {T_WB_.translation(), {5.35, 3.05, 1.55}}, .scores = {0.25, 0.75}};
  const Task task = *make.See(choice, candidates, T_WB_, timings_);
  EXPECT_EQ(task.plan.kind, Plan::Kind::kGo);
  EXPECT_EQ(task.plan.purpose, Purpose::kSeeFrontier);
  EXPECT_EQ(task.plan.target_W, candidates[1].cluster.center_W);
  EXPECT_EQ(task.plan.frontiers, 2U);
  EXPECT_EQ(task.target, candidates[1].cluster.unknowns);
  EXPECT_EQ(task.plan.target_unknown, 600U);
  EXPECT_EQ(task.plan.target_doubtful, 0U);
  EXPECT_EQ(task.choice.candidate, 1U);
  EXPECT_EQ(task.choice.path_W, choice.path_W) << "as the strategy decided, before it was shaped";
  EXPECT_EQ(task.choice.scores, choice.scores);
  EXPECT_FALSE(task.plan.ending);
  EXPECT_LT((task.plan.T_WBs.back().translation() - choice.path_W.back()).norm(), 1e-9);
  EXPECT_EQ(timings_["comfort"].Summarize().count, 1U);
  // No other of the views shows more of the target.
  const std::size_t shown = ShownOf(task.target, task.plan.T_WBs.back());
  EXPECT_GT(shown, 0U);
  for (const Eigen::Matrix3d& R_WB : knowledge_->views().candidates())
    EXPECT_LE(ShownOf(task.target, MakeTransform(R_WB, task.plan.T_WBs.back().translation())), shown);
}

TEST_F(TaskMakerTest, ATargetOfTheStrategysOwnTakesTheClustersPlace) {
  options_.loop.stop_short = false;
  const TaskMaker make = Maker();
  const std::vector<Candidate> candidates = HalvesOfTheFarEnd();
  // 40 degrees to the right and to the left of the wall's normal: no view shows both.
  for (const int y : {24, 36}) {
    const std::vector<VoxelIndex> target = {{60, y, 15}, {60, y, 16}};
    const Choice choice{
        .candidate = 0, .path_W = {T_WB_.translation(), {5.35, 3.05, 1.55}}, .target = target};
    const Task task = *make.See(choice, candidates, T_WB_, timings_);
    EXPECT_EQ(task.target, target);
    EXPECT_EQ(task.plan.target_unknown, 2U);
    EXPECT_EQ(task.plan.target_W, candidates[0].cluster.center_W);
    EXPECT_EQ(ShownOf(target, task.plan.T_WBs.back()), 2U) << y;
  }
}

TEST_F(TaskMakerTest, StopsWhereHalfOfWhatTheEndShowsIsInSight) {
  const std::vector<Candidate> candidates = HalvesOfTheFarEnd();
  const std::vector<VoxelIndex> target = {{60, 10, 15}, {60, 11, 15}};
  // The first voxel is in range of a look from 1 m before it; a path is cut at points that are at most 0.2 m
  // apart.
  const Choice choice{.candidate = 0, .path_W = {T_WB_.translation(), {5.75, 1.05, 1.55}}, .target = target};
  options_.loop.stop_short = false;
  EXPECT_NEAR(Maker().See(choice, candidates, T_WB_, timings_)->plan.length, 4.7, 1e-9);
  options_.loop.stop_short = true;
  const Task task = *Maker().See(choice, candidates, T_WB_, timings_);
  EXPECT_LE(task.plan.length, 4.0 + 0.2);
  EXPECT_GE(task.plan.length, 4.0 - 1e-9) << "from (5.05, 1.05, 1.55) on it sees the first";
  EXPECT_GE(ShownOf(target, task.plan.T_WBs.back()), 1U);
  EXPECT_EQ(task.choice.path_W, choice.path_W);
}

TEST_F(TaskMakerTest, AViewOfTheStrategysOwnIsTakenAtTheEndOfThePath) {
  const std::vector<Candidate> candidates = HalvesOfTheFarEnd();
  Choice choice{.candidate = 0,
                .path_W = {T_WB_.translation(), {5.75, 1.05, 1.55}},
                .target = {{60, 10, 15}, {60, 11, 15}}};
  // Neither the view that shows the target best, nor one of those to choose from.
  choice.R_WB = RotationFromYawPitch(13.0 * kDegree, 7.0 * kDegree);
  const Task task = *Maker().See(choice, candidates, T_WB_, timings_);
  EXPECT_NEAR(task.plan.length, 4.7, 1e-9) << "the path is not cut where the target comes into sight";
  EXPECT_EQ(task.plan.T_WBs.back().linear(), *choice.R_WB);
  EXPECT_EQ(task.target, choice.target);
}

TEST_F(TaskMakerTest, CountsTheDoubtfulApartFromTheUnknown) {
  options_.doubt.max_log_odds = 0.5;
  std::vector<VoxelChange> doubtful = test::BoxOf({{60, 28, 14}, {61, 31, 16}}, VoxelState::kOccupied);
  for (VoxelChange& change : doubtful) change.log_odds = 0.2F;
  changes_.insert(changes_.end(), doubtful.begin(), doubtful.end());
  const Choice choice{.candidate = 1, .path_W = {T_WB_.translation(), {5.35, 3.05, 1.55}}};
  const Task task = *Maker().See(choice, HalvesOfTheFarEnd(), T_WB_, timings_);
  EXPECT_EQ(task.plan.target_doubtful, 6U);
  EXPECT_EQ(task.plan.target_unknown, 594U);
}

/// Four facets of the wall at y = 0, whose middle is at (2.1, 0, 1.6).
InspectionView ViewOfAWall(const VoxelIndex& place, double length) {
  return {.place = place,
          .R_WB = RotationFromYawPitch(-90.0 * kDegree, 0.0),
          .facets = {{{20, -1, 15}, 2}, {{21, -1, 15}, 2}, {{20, -1, 16}, 2}, {{21, -1, 16}, 2}},
          .length = length};
}

TEST_F(TaskMakerTest, InspectsFromHereByATurn) {
  const TaskMaker make = Maker();
  PathSearch search;
  search.Flood(map(), {{map().IndexOf(T_WB_.translation()), 0}});
  const InspectionView view = ViewOfAWall(map().IndexOf(T_WB_.translation()), 0.0);
  ASSERT_EQ(view.facets[0].before(), (VoxelIndex{20, 0, 15})) << "the side that faces the room";
  const Task task = *make.Inspect(view, search, T_WB_);
  EXPECT_EQ(task.plan.kind, Plan::Kind::kLook);
  EXPECT_EQ(task.plan.purpose, Purpose::kInspect);
  ASSERT_THAT(task.plan.T_WBs, SizeIs(1));
  EXPECT_EQ(task.plan.T_WBs[0].translation(), T_WB_.translation());
  EXPECT_EQ(task.plan.T_WBs[0].linear(), view.R_WB);
  EXPECT_NEAR(task.plan.inspects, 4 * 0.01, 1e-12);
  ASSERT_TRUE(task.plan.target_W);
  EXPECT_LT((*task.plan.target_W - Eigen::Vector3d(2.1, 0.0, 1.6)).norm(), 1e-9);
  EXPECT_EQ(task.facets, view.facets);
  EXPECT_TRUE(task.target.empty());
}

TEST_F(TaskMakerTest, InspectsFromElsewhereByAStraightenedPath) {
  const TaskMaker make = Maker();
  PathSearch search;
  search.Flood(map(), {{map().IndexOf(T_WB_.translation()), 0}});
  const VoxelIndex place{40, 25, 15};
  const InspectionView view = ViewOfAWall(place, search.Length(place));
  const Task task = *make.Inspect(view, search, T_WB_);
  EXPECT_EQ(task.plan.kind, Plan::Kind::kGo);
  EXPECT_EQ(task.plan.purpose, Purpose::kInspect);
  EXPECT_EQ(task.plan.T_WBs.front().translation(), T_WB_.translation());
  EXPECT_LT((task.plan.T_WBs.back().translation() - map().CenterOf(place)).norm(), 1e-9);
  EXPECT_EQ(task.plan.T_WBs.back().linear(), view.R_WB);
  EXPECT_NEAR(task.plan.length, std::hypot(3.0, 1.5), 1e-6) << "3 m to the front and 1.5 m to the left";
  EXPECT_NEAR(task.plan.inspects, 4 * 0.01, 1e-12);
  EXPECT_EQ(task.facets, view.facets);
}

TEST(EndedTask, HasNoPathAndKeepsItsEnding) {
  const Task task = Ended(Ending{
      .outcome = Outcome::kTooMuchUnknown, .missed = {{AsideReason::kVisited, 1.44}}, .left_frontiers = 3});
  EXPECT_EQ(task.plan.kind, Plan::Kind::kDone);
  EXPECT_EQ(task.plan.purpose, Purpose::kEnd);
  EXPECT_TRUE(task.plan.T_WBs.empty());
  EXPECT_FALSE(task.plan.target_W);
  ASSERT_TRUE(task.plan.ending);
  EXPECT_EQ(task.plan.ending->outcome, Outcome::kTooMuchUnknown);
  EXPECT_EQ(task.plan.ending->left_frontiers, 3U);
  ASSERT_THAT(task.plan.ending->missed, SizeIs(1));
  EXPECT_EQ(task.plan.ending->missed[0].area, 1.44);
  EXPECT_EQ(test::EndOf(Ended(Outcome::kNoPathHome).plan), Outcome::kNoPathHome);
}

}  // namespace
}  // namespace thalweg::explorer
