#include "services/explorer/core/strategy/cover_stops.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "common/base/angles.h"
#include "tests/services/explorer/support/situations.h"

namespace thalweg::explorer {
namespace {

using test::kLookRange;
using test::kSize;

class CoverStops : public test::RoomWithSpecks {
 protected:
  CoverStops() { PutSpecks({{60, 4, 6}, {62, 26, 6}, {50, 4, 6}, {30, 20, 3}, {2, 28, 6}}); }
  const std::vector<std::vector<RayStep>> rays_ = SpreadRays(100, kLookRange, kSize);
};

TEST_F(CoverStops, EachSampleStandsForAnEqualPartOfItsCluster) {
  for (int n = 0; n < 50; ++n) candidates_[0].cluster.unknowns.push_back({60, 4, 7 + n});
  const std::vector<CoverItem> items = SampleItems(situation());
  std::map<std::size_t, double> share;
  std::map<std::size_t, int> count;
  for (const CoverItem& item : items) {
    EXPECT_THAT(candidates_[item.candidate].cluster.unknowns, testing::Contains(item.voxel));
    share[item.candidate] += item.share;
    ++count[item.candidate];
  }
  EXPECT_EQ(share.size(), candidates_.size());
  for (const auto& [candidate, sum] : share) EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_EQ(count[0], 4);
  EXPECT_EQ(count[1], 1);
}

TEST_F(CoverStops, AreReachedOneInACellAndCrossedByRaysFromTheirItems) {
  const std::vector<CoverItem> items = SampleItems(situation());
  const std::vector<CoverStop> stops = StopsSeeing(situation(), items, rays_);
  std::map<std::vector<int>, int> in_cell;
  std::vector<int> seers(items.size(), 0);
  for (const CoverStop& stop : stops) {
    EXPECT_TRUE(search_.Reached(stop.place));
    EXPECT_EQ((++in_cell[{stop.place.x / 4, stop.place.y / 4, stop.place.z / 4}]), 1);
    EXPECT_FALSE(stop.R_WB || stop.is_here);
    EXPECT_TRUE(std::ranges::is_sorted(stop.items));
    for (const std::size_t item : stop.items) {
      ++seers[item];
      // The item may be seen from another voxel of the cell, which is 0.7 m from corner to corner.
      EXPECT_LT((map_.CenterOf(items[item].voxel) - map_.CenterOf(stop.place)).norm(), kLookRange + 0.7);
    }
  }
  EXPECT_THAT(seers, testing::Each(testing::Gt(10)));
}

TEST_F(CoverStops, ViewsShowAllThatAnyViewShowsAndNoneIsIdle) {
  const std::vector<CoverItem> items = SampleItems(situation());
  for (const bool level : {false, true}) {
    RobotModel robot;
    robot.attitude = level ? Attitude::kLevel : Attitude::kFree;
    const ViewPlanner planner(DepthSensorModel{}.camera, robot);
    const Situation whole = situation();
    const Situation its{map_,        search_, whole.robot_W,      whole.clearance,
                        candidates_, planner, whole.sensor_range, whole.look_range};
    const CoverStop stop{.place = {31, 15, 6}, .items = {0, 1, 2, 3, 4}};
    const std::vector<CoverStop> views = ViewsFrom(stop, its, items);
    ASSERT_FALSE(views.empty());
    const Eigen::Vector3d eye_W = map_.CenterOf(stop.place);
    std::vector<bool> shown(items.size(), false);
    for (const CoverStop& view : views) {
      EXPECT_EQ(view.place, stop.place);
      std::vector<std::size_t> expected;
      for (const std::size_t item : stop.items) {
        const VoxelIndex& i = items[item].voxel;
        if (planner.Shows(*view.R_WB, {i, map_.CenterOf(i) - eye_W})) expected.push_back(item);
      }
      EXPECT_EQ(view.items, expected);
      for (const std::size_t item : expected) shown[item] = true;
      for (const CoverStop& other : views) {
        EXPECT_TRUE(&other == &view || !std::ranges::includes(other.items, view.items));
      }
    }
    for (const std::size_t item : stop.items)
      EXPECT_EQ(shown[item], planner.CanShow(map_.CenterOf(items[item].voxel) - eye_W)) << item;
    // Two of the specks at the far end are 9 degrees apart from there.
    const auto most = std::ranges::max(views, {}, [](const CoverStop& view) { return view.items.size(); });
    EXPECT_GE(most.items.size(), 2U);
  }
}

TEST_F(CoverStops, FarClustersThatLieTogetherShareOneStop) {
  PutSpecks({{64, 14, 6}});  // 1.1 m from the first one
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{5}}) candidates_[n].length = 20.5;
  candidates_[5].length = 20.2;
  for (int n = 0; n < 50; ++n) candidates_[0].cluster.unknowns.push_back({60, 4, 7 + n});
  RobotModel robot;
  for (const bool timed : {false, true}) {
    Situation its = situation();
    if (timed) its.time.emplace(robot, Eigen::Matrix3d::Identity());
    const std::vector<CoverItem> items = SampleItems(its);
    ASSERT_EQ(items.size(), candidates_.size()) << "one of each that is far";
    for (const CoverStop& stop : StopsSeeing(its, items, rays_)) {
      for (const std::size_t item : stop.items) EXPECT_FALSE(items[item].is_far);
    }
    const std::vector<CoverStop> stops = ZoneStops(its, items);
    ASSERT_EQ(stops.size(), 2U);
    std::vector<std::size_t> seen;
    for (const CoverStop& stop : stops) {
      EXPECT_TRUE(stop.is_zone);
      EXPECT_EQ(stop.R_WB.has_value(), timed);
      seen.insert(seen.end(), stop.items.begin(), stop.items.end());
      if (stop.items.size() < 2) continue;
      const Candidate& nearest = candidates_[5];
      EXPECT_EQ(stop.place, nearest.goals.front());
      const VoxelIndex& unknown = nearest.cluster.unknowns.front();
      const Eigen::Vector3d offset_W = map_.CenterOf(unknown) - map_.EyeAt(map_.CenterOf(stop.place));
      EXPECT_TRUE(!timed || its.views.Shows(*stop.R_WB, {unknown, offset_W}));
    }
    EXPECT_THAT(seen, testing::UnorderedElementsAre(0, 1, 5));
  }
}

TEST_F(CoverStops, AViewFromWhereTheRobotIsStartsAtTheRobotItself) {
  const CoverStop here{.place = {9, 9, 9}, .is_here = true};
  EXPECT_EQ(PositionOf(here, situation()), map_.CenterOf(kStart));
  EXPECT_EQ(PositionOf({.place = {9, 9, 9}}, situation()), map_.CenterOf({9, 9, 9}));
}

TEST_F(CoverStops, AFewAreKeptForEachItem) {
  const std::vector<CoverItem> items = SampleItems(situation());
  const std::vector<CoverStop> all = StopsSeeing(situation(), items, rays_);
  std::vector<CoverStop> few = all;
  KeepFew(situation(), items.size(), few);
  EXPECT_LT(few.size(), all.size() / 2);
  std::vector<int> seers(items.size(), 0);
  for (const CoverStop& stop : few) {
    for (const std::size_t item : stop.items) ++seers[item];
  }
  EXPECT_THAT(seers, testing::Each(testing::Ge(4)));
  // The stop that sees most, and the nearest one that sees anything, are among them.
  const auto sees = [](const CoverStop& stop) { return stop.items.size(); };
  const auto cost = [&](const CoverStop& stop) { return search_.Cost(stop.place); };
  EXPECT_EQ(sees(std::ranges::max(few, {}, sees)), sees(std::ranges::max(all, {}, sees)));
  EXPECT_EQ(cost(std::ranges::min(few, {}, cost)), cost(std::ranges::min(all, {}, cost)));
}

}  // namespace
}  // namespace thalweg::explorer
