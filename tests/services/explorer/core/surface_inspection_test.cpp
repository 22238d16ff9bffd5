#include <gtest/gtest.h>

#include "services/explorer/core/explorer.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;

/// An explorer by strategy surface in a room that is all known, but not inspected.
class SurfaceInspectionTest : public testing::Test {
 protected:
  SurfaceInspectionTest() { explorer_.Update(test::ClosedRoom(test::kLongRoom), {}, now_); }
  static Explorer::Options Options() {
    Explorer::Options options = test::GoingOptions();
    options.strategy = Configure("surface");
    return options;
  }
  /// Moves to a plan's end and takes a scan there.
  void Execute(const Plan& plan) {
    now_ += 1s;
    T_WB_ = plan.T_WBs.back();
    explorer_.Move(T_WB_);
    explorer_.Update({}, std::vector<ScanView>{{.T_WC = T_WB_ * RobotModel{}.T_BC}}, now_);
    explorer_.Arrived(now_);
  }

  Explorer explorer_{Options()};
  Time now_{1000s};
  RigidTransform T_WB_ = test::At(0.55, 0.65, 0.65);
};

TEST_F(SurfaceInspectionTest, OfAKnownRoomEndsWhenHardlyAnythingIsLeft) {
  Plan plan = explorer_.MakePlan(T_WB_, now_);
  int views = 0;
  for (; !plan.ending && views < 100; ++views) {
    ASSERT_EQ(plan.purpose, Purpose::kInspect);
    EXPECT_GT(plan.inspects, 0.0);
    ASSERT_TRUE(plan.target_W);
    Execute(plan);
    plan = explorer_.MakePlan(T_WB_, now_);
  }
  ASSERT_TRUE(plan.ending);
  EXPECT_EQ(plan.ending->outcome, Outcome::kComplete);
  ASSERT_TRUE(plan.ending->surface);
  EXPECT_NEAR(plan.ending->surface->all, 4 * 6.0 * 1.2 + 2 * 1.2 * 1.2, 1e-9);
  EXPECT_GE(plan.ending->surface->inspected, 0.9 * plan.ending->surface->all);
  EXPECT_GT(views, 5);
  EXPECT_GT(explorer_.status().distance, 1.0) << "the far end cannot be inspected from here";
}

TEST_F(SurfaceInspectionTest, IsDroppedWhenAnotherStrategyTakesOver) {
  Plan plan = explorer_.MakePlan(T_WB_, now_);
  while (plan.kind != Plan::Kind::kGo) {
    ASSERT_EQ(plan.purpose, Purpose::kInspect);
    Execute(plan);
    plan = explorer_.MakePlan(T_WB_, now_);
  }
  EXPECT_FALSE(explorer_.CheckPlan(T_WB_));
  ASSERT_FALSE(explorer_.UseStrategy("closest"));
  EXPECT_EQ(explorer_.CheckPlan(T_WB_), Interruption::kTargetSeen);
  EXPECT_EQ(test::EndOf(explorer_.MakePlan(T_WB_, now_)), Outcome::kComplete);
  ASSERT_FALSE(explorer_.UseStrategy("surface"));
  EXPECT_EQ(explorer_.MakePlan(T_WB_, now_).purpose, Purpose::kInspect)
      << "from now on, and from the beginning";
}

TEST_F(SurfaceInspectionTest, BeginsAgainWithANewMap) {
  for (int n = 0; n < 4; ++n) Execute(explorer_.MakePlan(T_WB_, now_));
  explorer_.Reset();
  explorer_.Update(test::ClosedRoom(test::kLongRoom), {}, now_);
  T_WB_ = test::At(0.55, 0.65, 0.65);
  Explorer fresh(Options());
  fresh.Update(test::ClosedRoom(test::kLongRoom), {}, now_);
  const Plan plan = explorer_.MakePlan(T_WB_, now_);
  EXPECT_EQ(plan.purpose, Purpose::kInspect);
  EXPECT_EQ(plan.inspects, fresh.MakePlan(T_WB_, now_).inspects);
}

TEST_F(SurfaceInspectionTest, StaysWithinItsBudget) {
  Explorer::Options options = Options();
  options.distance_budget = 0.05;
  options.return_home = true;
  Explorer explorer(options);
  explorer.Update(test::ClosedRoom(test::kLongRoom), {}, now_);
  explorer.Move(T_WB_);
  Plan plan = explorer.MakePlan(T_WB_, now_);
  for (int n = 0; !plan.ending && n < 100; ++n) {
    EXPECT_EQ(plan.kind, Plan::Kind::kLook) << "a turn costs no path";
    now_ += 1s;
    explorer.Update({}, std::vector<ScanView>{{.T_WC = plan.T_WBs.back() * options.robot.T_BC}}, now_);
    explorer.Arrived(now_);
    plan = explorer.MakePlan(plan.T_WBs.back(), now_);
  }
  EXPECT_EQ(test::EndOf(plan), Outcome::kDistanceBudget);
}

TEST(Surface, WithLimitsThatCannotBeMetIsRefused) {
  class Impossible final : public Strategy {
   public:
    Choice Choose(const Situation& /*situation*/) override { return {}; }
    const InspectionOptions* inspection() const override { return &options_; }

   private:
    InspectionOptions options_{.criterion = {.distance = -1.0}};
  };
  Explorer::Options options = test::GoingOptions();
  options.strategy = {"impossible", [] { return std::make_unique<Impossible>(); }};
  EXPECT_THROW(Explorer{options}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
