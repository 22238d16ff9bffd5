#include "services/evaluator/core/lockstep.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "services/evaluator/adapter/scene.h"
#include "services/evaluator/text/run_end_text.h"

namespace thalweg::evaluator {
namespace {

using explorer::PlanningMap;

/// What an exploration left unexplored although it could still be seen: unknown voxels next to free ones, in
/// components of at least the smallest cluster's size, in sight of a position that the robot can reach.
struct LeftOver {
  std::size_t open = 0;          ///< Not set aside.
  std::size_t out_of_sight = 0;  ///< Set aside because no position that sees them was found.
};

class EndJudge {
 public:
  EndJudge(const explorer::Explorer& explorer, const explorer::Explorer::Options& options,
           const RigidTransform& T_WB)
      : explorer_(explorer), options_(options) {
    Reach(T_WB);
  }

  LeftOver Judge() const {
    std::vector<VoxelIndex> open;
    const DenseGrid<VoxelState>& states = map().states();
    for (std::size_t k = 0; k < states.size(); ++k) {
      const VoxelIndex i = states.IndexAt(k);
      if (explorer::IsTarget(map(), i) && explorer_.memory().set_aside()[i] == 0) open.push_back(i);
    }
    LeftOver left;
    left.open = CountInSight(open);
    const auto aside = explorer_.memory().SetAsideVoxels();
    const auto found = aside.find(explorer::AsideReason::kOutOfSight);
    if (found != aside.end()) left.out_of_sight = CountInSight(found->second);
    return left;
  }

 private:
  const PlanningMap& map() const { return explorer_.map(); }

  /// Flood-fills all traversable voxels connected to the robot's.
  void Reach(const RigidTransform& T_WB) {
    DenseGrid<std::uint8_t> seen(map().box(), 0);
    const auto visit = [&](const VoxelIndex& i) {
      if (!map().Traversable(i) || seen[i]) return;
      seen[i] = 1;
      reached_.push_back(i);
    };
    for (const auto& entry : explorer::PathSearch::StartAt(map(), T_WB.translation(), options_.robot.radius,
                                                           {options_.exemption})) {
      visit(entry.voxel);
    }
    for (std::size_t n = 0; n < reached_.size(); ++n) {
      for (const VoxelIndex& step : kFaceNeighbors) visit(reached_[n] + step);
    }
  }

  std::size_t CountInSight(const std::vector<VoxelIndex>& voxels) const {
    std::size_t count = 0;
    for (const auto& component : explorer::ConnectedComponents(voxels)) {
      if (component.size() < explorer::VoxelsOfArea(options_.frontier.min_area, options_.voxel_size))
        continue;
      for (const VoxelIndex& i : component) count += InSight(map().CenterOf(i)) ? 1U : 0U;
    }
    return count;
  }
  bool InSight(const Eigen::Vector3d& p_W) const {
    return std::any_of(reached_.begin(), reached_.end(), [&](const VoxelIndex& place) {
      const Eigen::Vector3d from_W = map().CenterOf(place);
      return (from_W - p_W).norm() <= options_.look_range && map().InSight(from_W, p_W);
    });
  }

  const explorer::Explorer& explorer_;
  const explorer::Explorer::Options& options_;
  std::vector<VoxelIndex> reached_;
};

class TinyRoom : public testing::TestWithParam<std::string> {
 protected:
  LockstepResult Run(const RigidTransform& start, const PlanObserver& observe = {}) {
    mapper::OccupancyMap map(options_.mapper);
    return RunLockstep(scene_.world(), start, options_, map, observe);
  }

  Scene scene_{"tiny"};
  LockstepOptions options_ = scene_.Options(GetParam(), 1);
};

std::vector<std::string> NamesOfStrategies() {
  std::vector<std::string> names;
  for (const explorer::StrategyInfo& strategy : explorer::Strategies()) {
    // As printed it keeps no distance from the unknown, and so may touch what it has not seen. This robot
    // flies. Strategy rift goes by surfaces, not by the map.
    if (strategy.name != "potential_thesis" && strategy.robots == explorer::ForRobots::kAll)
      names.emplace_back(strategy.name);
  }
  return names;
}
INSTANTIATE_TEST_SUITE_P(Strategies, TinyRoom, testing::ValuesIn(NamesOfStrategies()));

TEST_P(TinyRoom, IsExploredCompletelyWithoutACollision) {
  mapper::OccupancyMap map(options_.mapper);
  const RigidTransform start = scene_.Start(0);
  const LockstepResult result = RunLockstep(scene_.world(), start, options_, map);
  EXPECT_EQ(ToText(result.end), "complete");
  EXPECT_EQ(result.collisions, 0);
  EXPECT_GE(result.least_clearance, 0.0);
  EXPECT_GE(scene_.Truth(start.translation())->Compare(map.grid()).coverage(), 0.97);
  EXPECT_EQ(result.samples.size(), result.scans);
  EXPECT_NEAR(result.explorer.distance, result.distance, 0.01 * result.distance);
}

TEST_P(TinyRoom, IsExploredWithCoarseAndFineVoxelsToo) {
  for (const char* size : {"0.05", "0.2"}) {
    const Outcome outcome = Scene("tiny", {std::string("mapper.voxel_size_m=") + size}).Run(GetParam(), 1);
    EXPECT_EQ(ToText(outcome.end), "complete") << size;
    EXPECT_EQ(outcome.collisions, 0) << size;
    // Where a robot fits depends on its size; what can be seen from there must be nearly everything.
    EXPECT_GE(outcome.coverage, 0.9) << size;
  }
}

TEST_P(TinyRoom, WithASensorOfShortRangeEndsIncompleteUnlessItReportsWhereNothingIs) {
  const std::vector<std::string> short_range = {"depth_sensor.max_range_m=1.0"};
  const Outcome silent = Scene("tiny", short_range).Run(GetParam(), 1);
  EXPECT_EQ(silent.end.ending.outcome, explorer::Outcome::kTooMuchUnknown);
  EXPECT_LT(silent.coverage, 0.6) << "else there is nothing to tell";

  const Scene scene("tiny", {short_range[0], "depth_sensor.no_return_is_free=true"});
  const Outcome reporting = scene.Run(GetParam(), 1);
  EXPECT_EQ(ToText(reporting.end), "complete");
  EXPECT_EQ(reporting.collisions, 0);
  EXPECT_GE(reporting.coverage, 0.97);
  EXPECT_GE(reporting.agreement, 0.95) << "what it cleared was free";
}

TEST_P(TinyRoom, IsExploredByALargerRobotWithItsCameraAtItsFront) {
  // It never sees the space that its own body occupies.
  const Outcome outcome = Scene("tiny", {"robot.radius_m=0.2", "robot.camera_position_m.x=0.15",
                                         "robot.camera_position_m.z=-0.1", "robot.camera_pitch_deg=-15"})
                              .Run(GetParam(), 1);
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GE(outcome.coverage, 0.95);
}

TEST_P(TinyRoom, IsExploredByALevelRobotThatOnlyTurnsAboutTheVertical) {
  for (const char* pitch : {"0", "-20"}) {
    const Scene scene("tiny", {"robot.attitude=LEVEL", std::string("robot.camera_pitch_deg=") + pitch});
    const LockstepOptions options = scene.Options(GetParam(), 1);
    const RigidTransform start = scene.Start(1);
    mapper::OccupancyMap map(options.mapper);
    double most_tilt = 0.0;
    const LockstepResult result =
        RunLockstep(scene.world(), start, options, map,
                    [&](const explorer::Plan& plan, const explorer::Explorer&, const RigidTransform& T_WB) {
                      most_tilt = std::max(most_tilt, 1.0 - T_WB.linear()(2, 2));
                      for (const RigidTransform& pose : plan.T_WBs)
                        most_tilt = std::max(most_tilt, 1.0 - pose.linear()(2, 2));
                    });
    EXPECT_LT(most_tilt, 1e-9);
    EXPECT_EQ(ToText(result.end), "complete") << pitch;
    EXPECT_EQ(result.collisions, 0);
    const auto truth = scene.Truth(start.translation());
    EXPECT_GE(truth->Compare(map.grid()).coverage(), 0.97) << pitch;
    EXPECT_LE(truth->observable_count(), Scene("tiny").Truth(start.translation())->observable_count());
  }
}

TEST_P(TinyRoom, AtTheEndNothingIsLeftThatCouldBeSeen) {
  int ends = 0;
  for (int seed = 0; seed < 3; ++seed) {
    Run(scene_.Start(seed),
        [&](const explorer::Plan& plan, const explorer::Explorer& explorer, const RigidTransform& T_WB) {
          if (plan.kind != explorer::Plan::Kind::kDone) return;
          ++ends;
          const LeftOver left = EndJudge(explorer, options_.explorer, T_WB).Judge();
          EXPECT_EQ(left.open, 0U) << "start " << seed;
          EXPECT_EQ(left.out_of_sight, 0U) << "start " << seed;
        });
  }
  EXPECT_EQ(ends, 3);
}

TEST_P(TinyRoom, PathsToACoverageAreThoseOfTheScansThemselves) {
  const RigidTransform start = scene_.Start(1);
  const auto truth = scene_.Truth(start.translation());
  mapper::OccupancyMap map(options_.mapper);
  const LockstepResult result = RunLockstep(scene_.world(), start, options_, map, {}, truth.get());
  const Outcome outcome = Judge(result, map.grid(), *truth);
  EXPECT_LT(outcome.progress.size(), result.samples.size());
  for (const int percent : kCoveragePercents) {
    const auto first = std::find_if(result.samples.begin(), result.samples.end(), [&](const auto& sample) {
      return static_cast<double>(sample.observed) >=
             0.01 * percent * static_cast<double>(truth->observable_count());
    });
    ASSERT_NE(first, result.samples.end());
    EXPECT_EQ(PathTo(outcome, 0.01 * percent), first->distance) << percent;
  }
}

TEST_P(TinyRoom, TheSameRunTwiceIsTheSame) {
  const RigidTransform start = scene_.Start(5);
  const LockstepResult first = Run(start);
  const LockstepResult second = Run(start);
  EXPECT_EQ(first.distance, second.distance);
  EXPECT_EQ(first.scans, second.scans);
  EXPECT_EQ(first.explorer.plans, second.explorer.plans);
  ASSERT_EQ(first.samples.size(), second.samples.size());
  for (std::size_t n = 0; n < first.samples.size(); ++n) {
    EXPECT_EQ(first.samples[n].p_W, second.samples[n].p_W);
    EXPECT_EQ(first.samples[n].known, second.samples[n].known);
  }
}

TEST(LockstepDoubt, VoxelsThatAreAskedForAgainAreDoubtfulLessOften) {
  // A single hit is not enough to be sure.
  std::vector<std::string> settings = {"mapper.log_odds_hit=0.5"};
  const Scene plain("tiny", settings);
  settings.emplace_back("explorer.doubt.max_log_odds=0.6");
  const Scene doubting("tiny", settings);
  ASSERT_EQ(kDoubtfulLogOdds[1], 0.6);
  for (const char* strategy : {"closest", "potential_flux", "weighted_information_gain", "flow"}) {
    double without = 0.0;
    double with = 0.0;
    for (int seed = 1; seed <= 3; ++seed) {
      without += plain.Run(strategy, seed).doubtful[1];
      const Outcome outcome = doubting.Run(strategy, seed);
      with += outcome.doubtful[1];
      EXPECT_EQ(ToText(outcome.end), "complete");
      EXPECT_EQ(outcome.collisions, 0);
    }
    EXPECT_LT(with, 0.7 * without) << strategy;
  }
}

TEST_P(TinyRoom, IsCutOffAtTheLongestDuration) {
  options_.max_duration = 1.0;
  const LockstepResult result = Run(scene_.Start(0));
  EXPECT_EQ(ToText(result.end), "cut off");
  EXPECT_GE(result.duration, 1.0);
}

TEST_P(TinyRoom, TheBudgetsEndTheRun) {
  // On the way, too, and not only at its end: a time step later at the latest, and what is gone in one.
  options_.explorer.time_budget = std::chrono::seconds(3);
  const LockstepResult timed = Run(scene_.Start(0));
  EXPECT_EQ(ToText(timed.end), "time budget");
  EXPECT_LE(timed.duration, 3.0 + 2.0 * options_.time_step);
  options_.explorer.time_budget = Duration::zero();
  options_.explorer.distance_budget = 0.3;
  const LockstepResult short_one = Run(scene_.Start(0));
  EXPECT_EQ(ToText(short_one.end), "distance budget");
  EXPECT_LE(short_one.distance, 0.3 + 2.0 * options_.time_step * options_.robot.max_speed);
}

TEST_P(TinyRoom, ComesHomeWithinItsBudget) {
  options_.explorer.return_home = true;
  int cut_short = 0;
  double traveled = 0.0;
  const auto check = [&](int seed) {
    const RigidTransform start = scene_.Start(seed);
    const LockstepResult result = Run(start);
    EXPECT_LE((result.samples.back().p_W - start.translation()).norm(), 0.2) << ToText(result.end);
    cut_short += !result.end.complete() ? 1 : 0;
    return result;
  };
  for (int seed = 1; seed <= 5; ++seed) {
    options_.explorer.distance_budget = 2.5;
    const LockstepResult result = check(seed);
    EXPECT_LE(result.distance, 2.5);
    if (!result.end.complete()) {
      EXPECT_EQ(ToText(result.end), "home within the distance budget");
    }
    traveled += result.distance;
  }
  EXPECT_GT(traveled, 2.0) << "it went out";
  options_.explorer.distance_budget = 0.0;
  for (int seed = 1; seed <= 5; ++seed) {
    options_.explorer.time_budget = std::chrono::seconds(15);
    const LockstepResult result = check(seed);
    EXPECT_LE(result.duration, 15.0);
    if (!result.end.complete()) {
      EXPECT_EQ(ToText(result.end), "home within the time budget");
    }
  }
  EXPECT_GT(cut_short, 5);
  options_.explorer.time_budget = Duration::zero();
  EXPECT_EQ(ToText(check(1).end), "complete") << "without a budget it comes home at the end";
}

}  // namespace
}  // namespace thalweg::evaluator
