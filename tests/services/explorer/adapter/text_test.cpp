#include "services/explorer/adapter/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using testing::HasSubstr;
using testing::Not;

Plan ToAFrontier() {
  Plan plan;
  plan.kind = Plan::Kind::kGo;
  plan.purpose = Purpose::kSeeFrontier;
  plan.length = 3.25;
  plan.target_unknown = 34;
  plan.frontiers = 5;
  return plan;
}

TEST(PlanText, NamesPathTargetAndChoice) {
  Plan plan = ToAFrontier();
  EXPECT_EQ(PlanText(plan, 5.0), "going 3.2 m to see 34 unknown voxels, one of 5 frontiers");
  plan.target_doubtful = 2;
  plan.frontiers = 1;
  plan.length = 0.0;
  EXPECT_EQ(PlanText(plan, 5.0), "turning to see 34 unknown and 2 doubtful voxels, the last frontier known");
  plan.target_unknown = 0;
  EXPECT_THAT(PlanText(plan, 5.0), HasSubstr("to see 2 doubtful voxels"));
}

TEST(PlanText, OfATurnBeforeANarrowPassageSaysWhatFollows) {
  Plan plan = ToAFrontier();
  plan.kind = Plan::Kind::kLook;
  plan.faces_passage_first = true;
  EXPECT_EQ(PlanText(plan, 5.0),
            "turning to the narrow passage ahead, then going 3.2 m to see 34 unknown voxels, one of 5 "
            "frontiers");
}

TEST(PlanText, OnTheWayHomeSaysWhy) {
  Plan plan;
  plan.kind = Plan::Kind::kGo;
  plan.purpose = Purpose::kGoHome;
  plan.length = 12.0;
  plan.homeward = Outcome::kTimeBudget;
  EXPECT_EQ(PlanText(plan, 5.0), "going home, 12.0 m: time budget");
}

TEST(PlanText, OfAnEndSaysWhatStayedUnknownAndWhy) {
  Plan plan;
  plan.ending = Ending{};
  EXPECT_EQ(PlanText(plan, 5.0), "done: complete");
  EXPECT_EQ(DetailsText(*plan.ending, 5.0), "");
  plan.ending->doubtful_voxels = 16;
  plan.ending->missed = {{AsideReason::kTooSmall, 0.1}, {AsideReason::kVisited, 1.34}};
  plan.ending->missed_area = 1.44;
  plan.ending->missed_share = 0.045;
  EXPECT_EQ(PlanText(plan, 5.0),
            "done: complete; 16 known voxels stayed doubtful; 1.44 m2 of frontier stayed unknown, 4.5 % of "
            "the border of free space: 0.10 m2 too small to matter, 1.34 m2 visited without progress");
  EXPECT_EQ("done: complete; " + DetailsText(*plan.ending, 5.0), PlanText(plan, 5.0));
  plan.ending->left_frontiers = 3;
  plan.ending->left_area = 0.42;
  EXPECT_THAT(PlanText(plan, 5.0), HasSubstr("; 3 frontiers, 0.42 m2 in all, were not worth the path; 1.44"));
  plan.ending->outcome = Outcome::kTooMuchUnknown;
  EXPECT_THAT(PlanText(plan, 1.0), HasSubstr("done: incomplete: too much stayed unknown"));
  EXPECT_THAT(PlanText(plan, 1.0), HasSubstr("range of 1.0 m"));
  EXPECT_THAT(PlanText(plan, 1.0), Not(HasSubstr("hidden")));
  plan.ending->hidden_area = 0.3;
  EXPECT_THAT(PlanText(plan, 1.0),
              HasSubstr("progress; 0.30 m2 of it are hidden by unknown space that bars the path; "));
  EXPECT_THAT(PlanText(plan, 1.0), Not(HasSubstr("was open")));
  plan.ending->shut_area = 0.25;
  plan.ending->shut_ways_W = {{1.0, 2.0, 0.5}};
  EXPECT_THAT(PlanText(plan, 1.0),
              HasSubstr("the path; 0.25 m2 of it are behind a way that was open and shut "
                        "at the end: (1.00, 2.00, 0.50); does"));
  plan.ending->shut_ways_W.emplace_back(3.0, 4.0, 0.5);
  EXPECT_THAT(PlanText(plan, 1.0),
              HasSubstr("0.25 m2 of it are behind ways that were open and shut at the end: "
                        "(1.00, 2.00, 0.50), (3.00, 4.00, 0.50); "));
  plan.ending->tight_ways = {{{5.0, 6.0, 0.5}, 0.4}};
  EXPECT_THAT(
      PlanText(plan, 1.0),
      HasSubstr("; 0.40 m2 of it can be seen only through a gap too narrow for the robot's paths, given "
                "explorer.safety_margin_m and mapper.voxel_size_m: (5.00, 6.00, 0.50); does"));
  for (int n = 1; n < 5; ++n) plan.ending->tight_ways.push_back({{5.0 + n, 6.0, 0.5}, 0.01});
  EXPECT_THAT(PlanText(plan, 1.0),
              HasSubstr("0.44 m2 of it can be seen only through gaps too narrow for the robot's paths, given "
                        "explorer.safety_margin_m and mapper.voxel_size_m: (5.00, 6.00, 0.50), (6.00, 6.00, "
                        "0.50), (7.00, 6.00, 0.50), "
                        "2 more; does"));
  plan.ending->tight_ways.push_back({{9.0, 9.0, 0.5}, 0.6});
  EXPECT_THAT(PlanText(plan, 1.0), Not(HasSubstr("does the sensor's range"))) << "that is not why";
}

TEST(PlanText, OfAStrategyThatDoesNotApplySaysWhatShowsIt) {
  Plan plan;
  plan.ending = Ending{.outcome = Outcome::kDoesNotApply, .misfit_W = Eigen::Vector3d(1.0, 2.0, 0.35)};
  EXPECT_EQ(PlanText(plan, 5.0),
            "done: the strategy does not apply; one can go around what stands at (1.00, 2.00, 0.35)");
}

TEST(PlanText, OfAStrategyThatCannotGoOnSaysWhyAndWhatWasLeftOut) {
  Plan plan;
  plan.ending = Ending{.outcome = Outcome::kCannotGoOn, .why = "no pose is possible", .left_out = 4};
  EXPECT_EQ(
      PlanText(plan, 5.0),
      "done: the strategy cannot go on: no pose is possible; 4 poses were left out, where the map did not "
      "let the robot look from");
  plan.ending = Ending{.outcome = Outcome::kTooMuchUnknown,
                       .missed_area = 3.0,
                       .missed_share = 0.5,
                       .why = "no rift is left",
                       .left_out = 1};
  EXPECT_THAT(PlanText(plan, 5.0),
              AllOf(HasSubstr("unknown, no rift is left; 1 pose was left out"),
                    HasSubstr("3.00 m2 of frontier stayed unknown, 50.0 % of the border of free space")));
}

TEST(PlanText, OfAViewOfTheSurfaceSaysWhereItIs) {
  Plan plan;
  plan.kind = Plan::Kind::kGo;
  plan.purpose = Purpose::kTakeView;
  plan.target_W = {3.05, 1.0, 0.5};
  plan.length = 1.25;
  EXPECT_EQ(PlanText(plan, 5.0), "going 1.2 m to look at the surface at (3.05, 1.00, 0.50)");
  plan.length = 0.0;
  EXPECT_EQ(PlanText(plan, 5.0), "turning to look at the surface at (3.05, 1.00, 0.50)");
}

TEST(PlanText, OfAWayThatIsShutSaysWhereItIs) {
  Plan plan;
  plan.kind = Plan::Kind::kGo;
  plan.purpose = Purpose::kWatchShutWay;
  plan.target_W = {3.05, 1.0, 0.5};
  plan.length = 1.25;
  EXPECT_EQ(PlanText(plan, 5.0), "going 1.2 m to a way that was open and is shut at (3.05, 1.00, 0.50)");
  plan.length = 0.0;
  EXPECT_EQ(PlanText(plan, 5.0), "watching a way that was open and is shut at (3.05, 1.00, 0.50)");
}

TEST(PlanText, OfARobotThatGoesBackSaysWhy) {
  Plan plan;
  plan.kind = Plan::Kind::kGo;
  plan.purpose = Purpose::kGoBack;
  plan.length = 1.25;
  EXPECT_EQ(PlanText(plan, 5.0), "going back 1.2 m the way it came, since the map shows no other way out");
}

TEST(PlanText, OfAnInspectionSaysHowMuch) {
  Plan plan;
  plan.kind = Plan::Kind::kGo;
  plan.purpose = Purpose::kInspect;
  plan.length = 1.25;
  plan.inspects = 3.04;
  EXPECT_EQ(PlanText(plan, 5.0), "going 1.2 m to inspect 3.0 m2 of surface");
  plan.ending = Ending{.surface = InspectedSurface::Area{.all = 50.0, .inspected = 45.5}};
  EXPECT_EQ(PlanText(plan, 5.0),
            "done: complete; 45.5 m2 of 50.0 m2 of surface were inspected, as voxels count it");
}

TEST(AnswerText, SaysHowTheExplorationHasEnded) {
  EXPECT_EQ(AnswerText({true, "exploring"}), "exploring");
  EXPECT_EQ(AnswerText({false, "the exploration has ended", Ending{.outcome = Outcome::kOperator}}),
            "the exploration has ended: ended by the operator");
}

TEST(PauseText, HasWordsOfItsOwnForEveryReason) {
  EXPECT_EQ(PauseText({PauseReason::kOperator}), "by the operator");
  EXPECT_EQ(PauseText({PauseReason::kErrandImpossible, "no known path leads there"}),
            "what was commanded is no longer possible: no known path leads there");
  std::set<std::string> texts;
  const int last = static_cast<int>(PauseReason::kRestarted);
  for (int reason = 0; reason <= last; ++reason) texts.insert(PauseText({static_cast<PauseReason>(reason)}));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(last) + 1);
}

TEST(ActivityText, OfAPausedRobotSaysWhyItWaits) {
  ExplorationLoop loop(test::GoingOptions());
  EXPECT_TRUE(loop.Obey(command::Pause{}, Time{}).accepted);
  EXPECT_EQ(ActivityText(loop, 5.0), "paused: by the operator");
}

TEST(ActivityText, SaysWhatIsAwaitedBeforeTheFirstPlan) {
  ExplorationLoop loop(test::GoingOptions());
  EXPECT_EQ(ActivityText(loop, 5.0), "waiting for a map");
  MapNews news{.replaced = true, .voxel_size = 0.1};
  EXPECT_FALSE(loop.OnMap(news, Time{}));
  EXPECT_EQ(ActivityText(loop, 5.0), "waiting for odometry");
  loop.OnPose(RigidTransform::Identity());
  EXPECT_EQ(ActivityText(loop, 5.0), "waiting for a scan");
}

TEST(DetailsText, OfARobotThatIsShutInSaysWhatWouldLetItOut) {
  Ending ending{.outcome = Outcome::kNothingReachable,
                .shut_in = ShutIn{.radius = 0.12, .needed = 0.22, .here = 0.22, .fitting = 0.15}};
  EXPECT_EQ(DetailsText(ending, 5.0),
            "the robot keeps 0.22 m (robot.radius_m 0.12 + explorer.safety_margin_m 0.10); with 0.15 m it "
            "could go on");
  ending.shut_in = ShutIn{.radius = 0.12, .needed = 0.22, .here = 0.05, .side = ShutIn::Side::kBelow};
  EXPECT_EQ(
      DetailsText(ending, 5.0),
      "the robot keeps 0.22 m (robot.radius_m 0.12 + explorer.safety_margin_m 0.10), and an obstacle below "
      "it "
      "leaves 0.05 m where it stands: does it start too near to the floor? The body of one that drives must "
      "float a voxel above it; nor could a smaller one go on: what it has seen around it is closed");
  ending.shut_in->side = ShutIn::Side::kBeside;
  EXPECT_THAT(DetailsText(ending, 5.0), HasSubstr("does the camera see the robot itself"));
  ending.shut_in.reset();
  EXPECT_THAT(DetailsText(ending, 5.0), HasSubstr("no-go boxes"));
}

TEST(InterruptionText, IsAnotherForEachInterruption) {
  std::set<std::string_view> texts;
  int count = 0;
  for (const Interruption why :
       {Interruption::kPathBlocked, Interruption::kNotFacingPassage, Interruption::kTimeForHome,
        Interruption::kDistanceForHome, Interruption::kTargetSeen, Interruption::kClockReset,
        Interruption::kLost, Interruption::kControllerStopped, Interruption::kMapReplaced,
        Interruption::kOperator, Interruption::kMapSilent}) {
    texts.insert(InterruptionText(why));
    ++count;
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(count));
}

}  // namespace
}  // namespace thalweg::explorer
