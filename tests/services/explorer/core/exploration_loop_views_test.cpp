#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/geometry/depth_image.h"
#include "services/explorer/core/exploration_loop.h"
#include "tests/services/explorer/support/rooms.h"

// The loop with a strategy that goes by views.

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using testing::HasSubstr;

const PinholeCamera kLoopCamera = PinholeCamera::FromFieldOfView(40, 30, 1.2);

/// Asks for views, and chooses a place in the room after each.
class Viewer final : public Strategy {
 public:
  explicit Viewer(bool completes) : completes_(completes) {}
  bool goes_by_views() const override { return true; }
  bool lacks_view() const override { return seen_ == 0; }
  void See(const CameraView& /*seen*/) override { ++seen_; }
  std::optional<std::vector<Candidate>> FindCandidates(const Surroundings& surroundings) override {
    if (seen_ == 3) {
      end_ = {.completes = completes_, .why = "it has seen enough"};
      return std::vector<Candidate>();
    }
    notes_ = {"after " + std::to_string(seen_) + " views"};
    path_W_ = {surroundings.robot_W, Eigen::Vector3d(1.0 + seen_, 0.65, 0.65)};
    std::vector<Candidate> only(1);
    only[0].cluster.center_W = path_W_.back();
    only[0].goals = {surroundings.map.IndexOf(path_W_.back())};
    return only;
  }
  Choice Choose(const Situation& /*situation*/) override {
    return {.path_W = path_W_, .R_WB = RotationFromYawPitch(0.0, 0.5)};
  }
  const std::optional<StrategyEnd>& end() const override { return end_; }
  std::size_t left_out() const override { return 7; }
  std::vector<std::string> TakeNotes() override { return std::exchange(notes_, {}); }

 private:
  bool completes_;
  int seen_ = 0;
  std::vector<Eigen::Vector3d> path_W_;
  std::vector<std::string> notes_;
  std::optional<StrategyEnd> end_;
};

/// An explorer's options that leave all rules of the loop on.
Explorer::Options ViewingOptions(bool completes = false) {
  Explorer::Options options;
  options.strategy = {"viewer", [completes] { return std::make_unique<Viewer>(completes); }};
  return options;
}

class ViewsTest : public testing::Test {
 protected:
  explicit ViewsTest(bool completes = false) : loop_(ViewingOptions(completes)) {
    MapNews news{.replaced = true, .voxel_size = 0.1, .changes = test::LongRoom()};
    EXPECT_FALSE(loop_.OnMap(news, now_));
    loop_.OnPose(T_WB_);
  }
  ViewNews ViewAt(Time stamp, const PinholeCamera& camera = kLoopCamera) const {
    const DepthImage depth{
        camera.width_px, camera.height_px,
        std::vector<float>(static_cast<std::size_t>(camera.width_px * camera.height_px), 2.0F)};
    return {.view = {CloudFrom(depth, camera), camera, T_WB_, RobotModel{}.T_BC}, .stamp = stamp};
  }
  void Scan() {
    MapNews news{.voxel_size = 0.1, .scans = {{.T_WC = T_WB_ * RobotModel{}.T_BC}}, .stamp = now_};
    EXPECT_FALSE(loop_.OnMap(news, now_));
  }
  /// Follows the path to its end. A second passes.
  void Arrive() {
    now_ += 1s;
    T_WB_ = loop_.order()->T_WBs.back();
    loop_.OnPose(T_WB_);
    loop_.OnMotion({.path_id = loop_.order()->id, .done = true, .standing = true, .stamp = now_}, now_);
    Scan();
  }

  /// Shows the strategy as many views as it wants. @return Whether the loop is done then, and not before.
  bool ViewsUntilDone() {
    for (int n = 0; n < 3; ++n) {
      EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
      if (!loop_.Think(now_)) return false;
      if (n < 2) Arrive();
    }
    return loop_.state() == LoopState::kDone;
  }

  Time now_ = test::kStart;
  RigidTransform T_WB_ = test::kHere;
  ExplorationLoop loop_;
};

class CompletingViewsTest : public ViewsTest {
 protected:
  CompletingViewsTest() : ViewsTest(/*completes=*/true) {}
};

TEST_F(ViewsTest, NoPlanIsMadeBeforeTheFirstView) {
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(loop_.awaited(), Awaited::kView);
  EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.awaited(), Awaited::kNothing);
  EXPECT_EQ(loop_.plan().purpose, Purpose::kTakeView) << "it does not look around first";
  EXPECT_THAT(loop_.plan().notes, testing::ElementsAre("after 1 views"));
  EXPECT_TRUE(loop_.plan().T_WBs.back().translation().isApprox(Eigen::Vector3d(2.0, 0.65, 0.65)));
  EXPECT_TRUE(loop_.plan().T_WBs.back().linear().isApprox(RotationFromYawPitch(0.0, 0.5)));
}

TEST_F(ViewsTest, AfterAnArrivalTheNextPlanWaitsForAViewFromThere) {
  EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_FALSE(loop_.OnView(ViewAt(now_ + 1s - Duration(1)))) << "on the way";
  Arrive();
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(loop_.awaited(), Awaited::kView);
  EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
  EXPECT_TRUE(loop_.Think(now_));
  EXPECT_THAT(loop_.plan().notes, testing::ElementsAre("after 2 views"))
      << "what was seen on the way is not for the strategy";
}

TEST_F(ViewsTest, EndsForTheReasonThatTheStrategyGives) {
  ASSERT_TRUE(ViewsUntilDone());
  EXPECT_EQ(loop_.plan().ending->outcome, Outcome::kCannotGoOn);
  EXPECT_EQ(loop_.plan().ending->why, "it has seen enough");
  EXPECT_EQ(loop_.plan().ending->left_out, 7U);
  EXPECT_EQ(loop_.explorer().status().left_out, 7U);
}

TEST_F(CompletingViewsTest, WhereTheStrategyIsDoneTheLoopsOwnRuleSaysWhetherThatIsComplete) {
  ASSERT_TRUE(ViewsUntilDone());
  EXPECT_NE(loop_.plan().ending->outcome, Outcome::kCannotGoOn);
  EXPECT_EQ(loop_.plan().ending->why, "it has seen enough");
  EXPECT_TRUE(loop_.plan().ending->missed.empty()) << "nobody looked for it";
}

TEST_F(ViewsTest, WhatIsNoViewOfTheCameraIsRefused) {
  ViewNews unorganized = ViewAt(now_);
  unorganized.view.cloud.width_px = 1200;
  unorganized.view.cloud.height_px = 1;
  EXPECT_THAT(loop_.OnView(unorganized)->text, HasSubstr("1200 x 1 for a camera of 40 x 30"));
  ViewNews short_of_points = ViewAt(now_);
  short_of_points.view.cloud.points_C.pop_back();
  EXPECT_TRUE(loop_.OnView(short_of_points));
  ViewNews nowhere = ViewAt(now_);
  nowhere.view.T_WB.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(loop_.OnView(nowhere)->text, HasSubstr("pose"));
  EXPECT_FALSE(loop_.Think(now_)) << "it still has no view";
  ViewNews far_away = ViewAt(now_);
  far_away.view.T_WB.translation().x() = 1e300;
  EXPECT_THAT(loop_.OnView(far_away)->text, HasSubstr("pose"));
  ViewNews without_focus = ViewAt(now_);
  without_focus.view.camera.fx = std::numeric_limits<double>::infinity();
  EXPECT_THAT(loop_.OnView(without_focus)->text, HasSubstr("focal length"));
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_FALSE(loop_.OnView(ViewAt(now_, PinholeCamera::FromFieldOfView(80, 60, 1.0))));
  EXPECT_TRUE(loop_.Think(now_));
}

TEST_F(ViewsTest, TakesAViewAsTheStrategyWantsItAlsoWhereTheLoopFacesTravel) {
  Explorer::Options options = ViewingOptions();
  options.loop = LoopRules::Of(LoopRules::Set::kPrinted);
  ExplorationLoop loop(options);
  MapNews news{.replaced = true, .voxel_size = 0.1, .changes = test::LongRoom()};
  EXPECT_FALSE(loop.OnMap(news, now_));
  loop.OnPose(T_WB_);
  EXPECT_FALSE(loop.OnView(ViewAt(now_)));
  ASSERT_TRUE(loop.Think(now_));
  EXPECT_TRUE(loop.plan().T_WBs.back().linear().isApprox(RotationFromYawPitch(0.0, 0.5)));
}

TEST_F(ViewsTest, WhatAStrategyLeftOutStaysCountedWhenAnotherTakesOver) {
  Explorer::Options options = ViewingOptions();
  options.configure = [](std::string_view name) { return Configure(name); };
  Explorer explorer(options);
  EXPECT_EQ(explorer.status().left_out, 7U);
  EXPECT_FALSE(explorer.UseStrategy("closest"));
  EXPECT_EQ(explorer.status().left_out, 7U);
}

TEST_F(ViewsTest, AClockThatJumpsBackDoesNotKeepItWaiting) {
  EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
  ASSERT_TRUE(loop_.Think(now_));
  Arrive();
  now_ -= 100s;
  Scan();
  loop_.OnMotion({.path_id = loop_.order()->id, .standing = true, .stamp = now_}, now_);
  EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
  loop_.Think(now_);
  EXPECT_EQ(loop_.awaited(), Awaited::kNothing);
  EXPECT_EQ(loop_.plan().purpose, Purpose::kTakeView);
}

TEST_F(ViewsTest, AViewFromBeforeAClockJumpedBackIsNotThatOfTheFirstPlan) {
  EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
  now_ -= 100s;
  loop_.OnTracking(false, now_);
  EXPECT_FALSE(loop_.Think(now_));
  EXPECT_EQ(loop_.awaited(), Awaited::kView);
  EXPECT_FALSE(loop_.OnView(ViewAt(now_)));
  EXPECT_TRUE(loop_.Think(now_));
}

TEST_F(ViewsTest, AnErrandNeedsNoView) {
  const Errand errand{.kind = Errand::Kind::kGoTo, .p_W = {2.05, 0.65, 0.65}};
  ASSERT_TRUE(loop_.Obey(command::Run{errand}, now_).accepted);
  ASSERT_TRUE(loop_.Think(now_));
  EXPECT_EQ(loop_.plan().purpose, Purpose::kGoTo);
}

TEST(Views, AreIgnoredByStrategiesThatGoByTheMap) {
  ExplorationLoop loop(test::GoingOptions());
  EXPECT_FALSE(loop.explorer().AwaitsView());
  EXPECT_FALSE(loop.OnView({}));
}

}  // namespace
}  // namespace thalweg::explorer
