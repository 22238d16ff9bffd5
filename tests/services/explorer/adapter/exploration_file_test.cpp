#include "services/explorer/adapter/exploration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/explorer/core/exploration_loop.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer {
namespace {

using std::chrono_literals::operator""s;
using testing::HasSubstr;

SavedExploration Example() {
  return {
      .place = "Kitchen, 8 x 8 x 3 m",
      .home_W = Eigen::Vector3d(1.0, -2.0, 0.1),
      .distance = 12.25,
      .elapsed = 90s,
      .homeward = Outcome::kTimeBudget,
      .paused = PauseCause{PauseReason::kErrandImpossible, "no \"path\"\n"},
      .gone_tight_way = true,
      .strategy = "flow",
      .drawn = {Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, 3))},
      .aside = {{{0.05, 0.15, 0.25}, AsideReason::kVisited}, {{6.05, 0.65, 0.65}, AsideReason::kIgnored}}};
}

TEST(ExplorationFile, IsReadAsItWasWritten) {
  const SavedExploration saved = Example();
  const Result<SavedExploration> read = DecodeExploration(EncodeExploration(saved));
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->place, saved.place);
  EXPECT_EQ(read->home_W, saved.home_W);
  EXPECT_EQ(read->distance, saved.distance);
  EXPECT_EQ(read->elapsed, saved.elapsed);
  EXPECT_EQ(read->homeward, saved.homeward);
  EXPECT_EQ(read->paused, saved.paused);
  EXPECT_EQ(read->gone_tight_way, saved.gone_tight_way);
  EXPECT_EQ(read->strategy, saved.strategy);
  ASSERT_EQ(read->drawn.size(), 1U);
  EXPECT_TRUE(read->drawn[0].isApprox(saved.drawn[0]));
  EXPECT_EQ(read->aside, saved.aside);
}

TEST(ExplorationFile, KeepsThatTheRobotWasNotPaused) {
  SavedExploration saved = Example();
  saved.paused.reset();
  const Result<SavedExploration> read = DecodeExploration(EncodeExploration(saved));
  ASSERT_TRUE(read) << read.error();
  EXPECT_FALSE(read->paused);
}

TEST(ExplorationFile, RefusesWhatItDidNotWrite) {
  const std::string good = EncodeExploration(Example());
  const auto with = [&](const std::string& old, const std::string& other) {
    std::string text = good;
    text.replace(text.find(old), old.size(), other);
    const Result<SavedExploration> read = DecodeExploration(text);
    return read ? "read" : read.error();
  };
  EXPECT_THAT(with("\"version\":4", "\"version\":2"), HasSubstr("another version"));
  EXPECT_THAT(with("\"version\":4", "\"version\":5"), HasSubstr("another version"));
  EXPECT_THAT(with("12.25", "-1.0"), HasSubstr("negative"));
  EXPECT_THAT(with("12.25", "1e300"), HasSubstr("absurd"));
  EXPECT_THAT(with("visited", "bored"), HasSubstr("unknown name"));
  EXPECT_THAT(with("errand_impossible", "by the operator"), HasSubstr("unknown name \"by the operator\""));
  EXPECT_THAT(with("[1.0,2.0,3.0]", "[1.0,-2.0,3.0]"), HasSubstr("box is empty"));
  EXPECT_THAT(with("[1.0,2.0,3.0]", "[1.0,2.0]"), HasSubstr("three numbers"));
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(DecodeExploration(good.substr(0, size)));
}

TEST(ExplorationFile, OfTheVersionBeforeIsReadWithoutWhatItLacks) {
  std::string text = EncodeExploration(Example());
  for (const auto& [old, other] : {std::pair<std::string, std::string>("\"version\":4", "\"version\":3"),
                                   {"\"gone_tight_way\":true,", ""}})
    text.replace(text.find(old), old.size(), other);
  const Result<SavedExploration> read = DecodeExploration(text);
  ASSERT_TRUE(read) << read.error();
  EXPECT_FALSE(read->gone_tight_way);
  EXPECT_EQ(read->strategy, "flow");
}

/// A loop that has been given commands, and one that continues in its place.
class Continued : public testing::Test {
 protected:
  void Begin(ExplorationLoop& loop) {
    MapNews news;
    news.replaced = true;
    news.voxel_size = 0.1;
    news.changes = test::LongRoom();
    ASSERT_FALSE(loop.OnMap(news, now_));
    loop.OnPose(test::At(0.55, 0.65, 0.65));
    loop.Think(now_);
  }
  ExplorationLoop Next() {
    ExplorationLoop next(test::GoingOptions());
    const auto saved = DecodeExploration(EncodeExploration(loop_.Save(now_)));
    EXPECT_TRUE(saved);
    next.Restore(*saved);
    return next;
  }

  Time now_{100s};
  ExplorationLoop loop_{test::GoingOptions()};
};

TEST_F(Continued, APausedRobotStaysPausedWithItsBoxesAndItsStrategy) {
  Begin(loop_);
  loop_.Obey(command::UseStrategy{"potential_flux"}, now_);
  loop_.Obey(command::DrawNoGo{{Eigen::Vector3d(2.0, 0.0, 0.0), Eigen::Vector3d(2.5, 0.6, 1.2)}}, now_);
  loop_.Obey(command::Pause{}, now_);
  ExplorationLoop next = Next();
  Begin(next);
  EXPECT_EQ(next.state(), LoopState::kPaused);
  EXPECT_EQ(next.pause_cause().reason, PauseReason::kOperator);
  EXPECT_EQ(next.explorer().standing().drawn_no_go.size(), 1U);
  EXPECT_EQ(next.explorer().standing().strategy, "potential_flux");
  EXPECT_FALSE(next.order()) << "it does not move";
}

TEST_F(Continued, HomeIsWhereTheFirstProcessSetOut) {
  Begin(loop_);
  loop_.OnPose(test::At(4.05, 0.65, 0.65));
  ExplorationLoop next = Next();
  MapNews news;
  news.replaced = true;
  news.voxel_size = 0.1;
  news.changes = test::LongRoom();
  ASSERT_FALSE(next.OnMap(news, now_));
  next.OnPose(test::At(4.05, 0.65, 0.65));
  EXPECT_NEAR(next.explorer().status().distance, 3.5, 1e-9);
  EXPECT_TRUE(next.Obey(command::GoHome{}, now_).accepted);
  next.Think(now_);
  ASSERT_TRUE(next.order());
  EXPECT_NEAR(next.order()->T_WBs.back().translation().x(), 0.55, 0.15);
}

TEST_F(Continued, WhatWasIgnoredStaysSo) {
  Begin(loop_);
  while (loop_.Obey(command::Ignore{{6.05, 0.65, 0.65}}, now_).accepted) {
  }
  ExplorationLoop next = Next();
  Begin(next);
  EXPECT_EQ(test::EndOf(next.plan()), Outcome::kComplete) << "nothing else is left to see";
}

TEST_F(Continued, ARobotBeyondATightWayStaysSoWhateverTheMapsVoxels) {
  SavedExploration saved = loop_.Save(now_);
  saved.gone_tight_way = true;
  for (const double voxel_size : {0.1, 0.2}) {
    ExplorationLoop next(test::GoingOptions());
    next.Restore(saved);
    MapNews news;
    news.replaced = true;
    news.voxel_size = voxel_size;
    news.changes = test::LongRoom();
    ASSERT_FALSE(next.OnMap(news, now_));
    EXPECT_TRUE(next.Save(now_).gone_tight_way);
    EXPECT_TRUE(next.explorer().standing().gone_tight_way);
  }
}

TEST_F(Continued, AnExplorationThatHasEndedDoesNotBeginAgain) {
  Begin(loop_);
  loop_.Obey(command::Stop{}, now_);
  ExplorationLoop next = Next();
  Begin(next);
  EXPECT_EQ(next.state(), LoopState::kPaused);
  EXPECT_EQ(next.pause_cause().reason, PauseReason::kEnded);
}

TEST_F(Continued, ARobotInTheMiddleOfACommandWaits) {
  Begin(loop_);
  loop_.Obey(command::Step{}, now_);
  ExplorationLoop next = Next();
  Begin(next);
  EXPECT_EQ(next.state(), LoopState::kPaused);
  EXPECT_EQ(next.pause_cause().reason, PauseReason::kRestarted);
}

}  // namespace
}  // namespace thalweg::explorer
