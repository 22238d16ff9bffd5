#include "services/evaluator/core/lockstep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/base/angles.h"
#include "common/scenario/scenario.h"
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
  EXPECT_NEAR(result.explorer.distance, result.distance, 1e-6);
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

/// The tiny room, flown level within the accelerations.
class DynamicMotion : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  static LockstepResult Fly(const char* minimize, const char* strategy, int seed, const char* jerk = "0") {
    const Scene scene("tiny", {"robot.attitude=LEVEL", "robot.max_speed_mps=2",
                               "robot.max_acceleration_mps2=3", "robot.max_turn_rate_dps=90",
                               "depth_sensor.rate_hz=10", std::string("explorer.minimize=") + minimize,
                               std::string("robot.max_jerk_mps3=") + jerk, "controller.silence_s=1"});
    const LockstepOptions options = scene.Options(strategy, seed, PoseSource::kTruth, MotionModel::kDynamic);
    mapper::OccupancyMap map(options.mapper);
    return RunLockstep(scene.world(), scene.Start(seed), options, map);
  }
};
INSTANTIATE_TEST_SUITE_P(Minimize, DynamicMotion,
                         testing::Combine(testing::Values("PATH", "TIME"),
                                          testing::Values("closest", "cover")));

TEST_P(DynamicMotion, StaysWithinTheLimitsAndExploresAllWithoutACollision) {
  for (int seed = 1; seed <= 3; ++seed) {
    const LockstepResult result = Fly(std::get<0>(GetParam()), std::get<1>(GetParam()), seed);
    EXPECT_EQ(ToText(result.end), "complete") << seed;
    EXPECT_EQ(result.collisions, 0);
    EXPECT_LE(result.motion.most_speed, 2.0 + 1e-6);
    // Corners of the polyline are steps of up to 0.05 m/s, of which 0.1 s may have one more at either end.
    EXPECT_LE(result.motion.most_acceleration, 3.0 + 2.0 * 0.05 / 0.1);
    EXPECT_LE(result.motion.most_turn_rate, 90.0 * kDegree + 1e-3);
    EXPECT_LE(result.motion.most_turn_acceleration, RobotModel{}.max_turn_acceleration + 0.05);
    const MotionFigures& motion = result.motion;
    EXPECT_NEAR(motion.moving + motion.turning + motion.standing, result.duration, 1e-6);
  }
}

TEST_P(DynamicMotion, KeepsTheJerkIfItIsLimited) {
  for (int seed = 1; seed <= 2; ++seed) {
    const LockstepResult result = Fly(std::get<0>(GetParam()), std::get<1>(GetParam()), seed, "30");
    EXPECT_EQ(ToText(result.end), "complete") << seed;
    EXPECT_EQ(result.collisions, 0);
    EXPECT_LE(result.motion.most_speed, 2.0 + 1e-6);
    EXPECT_LE(result.motion.most_acceleration, 3.0 + 2.0 * 0.05 / 0.2);  // such a step takes 0.2 s
    EXPECT_LE(result.motion.most_jerk, 30.0);
  }
}

TEST(GimballedRobot, ExploresAllWithoutRollAndWithinItsLimits) {
  const Scene scene("tiny", {"robot.attitude=GIMBAL", "robot.gimbal_min_pitch_deg=-80",
                             "robot.gimbal_max_pitch_deg=25", "robot.max_gimbal_rate_dps=45"});
  for (const MotionModel motion : {MotionModel::kKinematic, MotionModel::kDynamic}) {
    for (const char* strategy : {"closest", "cover"}) {
      const LockstepOptions options = scene.Options(strategy, 1, PoseSource::kTruth, motion);
      mapper::OccupancyMap map(options.mapper);
      double lowest = 0.0;
      const LockstepResult result =
          RunLockstep(scene.world(), scene.Start(1), options, map, {}, nullptr, {},
                      [&](const auto&, const RigidTransform& T_WC, const auto&) {
                        const Eigen::Matrix3d R_WB = T_WC.linear() * options.robot.T_BC.linear().transpose();
                        EXPECT_NEAR(R_WB(2, 1), 0.0, 1e-6) << "no roll";
                        const double pitch = std::asin(std::clamp(R_WB(2, 0), -1.0, 1.0));
                        EXPECT_GE(pitch, -80.0 * kDegree - 1e-6);
                        EXPECT_LE(pitch, 25.0 * kDegree + 1e-6);
                        lowest = std::min(lowest, pitch);
                      });
      EXPECT_EQ(ToText(result.end), "complete") << strategy;
      EXPECT_EQ(result.collisions, 0);
      EXPECT_LT(lowest, -20.0 * kDegree) << "it makes use of the gimbal";
    }
  }
}

/// A robot with a differential drive in the flat.
class DifferentialDrive : public testing::TestWithParam<std::tuple<MotionModel, const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Motions, DifferentialDrive,
                         testing::Values(std::tuple(MotionModel::kKinematic, "PATH", "closest"),
                                         std::tuple(MotionModel::kDynamic, "PATH", "closest"),
                                         std::tuple(MotionModel::kDynamic, "TIME", "closest"),
                                         std::tuple(MotionModel::kDynamic, "TIME", "cover")));

TEST_P(DifferentialDrive, ExploresAllWithoutMovingAcrossWhereItFaces) {
  const auto& [motion, minimize, strategy] = GetParam();
  const Scene scene("flat_ground",
                    {"robot.drive=DIFFERENTIAL", std::string("explorer.minimize=") + minimize});
  const LockstepOptions options = scene.Options(strategy, 1, PoseSource::kTruth, motion);
  mapper::OccupancyMap map(options.mapper);
  const LockstepResult result = RunLockstep(scene.world(), scene.Start(1), options, map);
  EXPECT_EQ(ToText(result.end), "complete");
  EXPECT_EQ(result.collisions, 0);
  // Half of a corner that belongs to a curve, and as much by which the turn lags behind.
  const double most = motion == MotionModel::kKinematic ? 1e-6 : std::sin(0.2) * options.robot.max_speed;
  EXPECT_LE(result.motion.most_sideways_speed, most);
  EXPECT_GT(result.motion.turning, 1.0);
}

/// The gap navigation tree in a world that is simply connected.
class GapsInTheWarren : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Starts, GapsInTheWarren, testing::Range(1, 5));

TEST_P(GapsInTheWarren, CompleteWithoutACollision) {
  const Outcome outcome = Scene("warren", {"robot.drive=DIFFERENTIAL"}).Run("gaps", GetParam());
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GE(outcome.coverage, 0.97);
}

/// A shipped scenario in whose world boxes stand, as parts that move by timetables of one place.
/// @param boxes  World.moving's min_m and max_m
Scene SceneWithBoxes(const std::string& name, const std::vector<std::string>& boxes,
                     std::vector<std::string> overrides = {}) {
  const std::filesystem::path shipped = ScenarioFolder() / (name + ".txtpb");
  const std::string file = testing::TempDir() + "/" + name + "_with_boxes.txtpb";
  std::ostringstream read;
  read << std::ifstream(shipped).rdbuf();
  std::string text = read.str();
  const std::string begin = "world {";
  std::string world = begin;
  for (const std::string& box : boxes) world += " moving { " + box + " places { time_s: 0 } }";
  text.replace(text.find(begin), begin.size(), world);
  std::ofstream(file) << text;
  overrides.push_back("world.file=" +
                      (shipped.parent_path().parent_path() / ("worlds/" + name + ".obj")).string());
  return Scene(file, overrides);
}

TEST(GapsAroundAPillar, EndBecauseOfIt) {
  const Scene scene =
      SceneWithBoxes("warren", {"min_m { x: 10.1 y: 4.8 z: 0.03 } max_m { x: 10.5 y: 5.2 z: 1.9 }"});
  for (int seed = 1; seed <= 2; ++seed) {
    const Outcome outcome = scene.Run("gaps", seed);
    EXPECT_EQ(ToText(outcome.end), "the strategy does not apply");
    EXPECT_EQ(outcome.collisions, 0);
    ASSERT_TRUE(outcome.end.ending.misfit_W);
    EXPECT_LT((outcome.end.ending.misfit_W->head<2>() - Eigen::Vector2d(10.3, 5.0)).norm(), 0.15);
  }
}

/// The tiny room, divided by a wall with an opening as high as the room and 0.41 m wide. Between its voxels
/// are 0.4 m, in which no center of a voxel keeps 0.2 m from both sides.
Outcome RunInDividedRoom(double radius, bool goes) {
  return SceneWithBoxes("tiny",
                        {"min_m { x: 1.42 y: 0 z: 0 } max_m { x: 1.58 y: 1.095 z: 1.6 }",
                         "min_m { x: 1.42 y: 1.505 z: 0 } max_m { x: 1.58 y: 2.5 z: 1.6 }"},
                        {"robot.radius_m=" + std::to_string(radius),
                         std::string("explorer.loop.go_tight_ways=") + (goes ? "true" : "false")})
      .Run("closest", 0);
}
bool CrossedTheWall(const Outcome& outcome) {
  return std::ranges::any_of(outcome.progress, [](const Outcome::Progress& at) { return at.p_W.x() > 1.8; });
}

TEST(GapBetweenVoxels, IsGoneThroughBeforeTheEnd) {
  const Outcome outcome = RunInDividedRoom(0.15, true);
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_TRUE(CrossedTheWall(outcome));
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GT(outcome.least_clearance, 0.03);
}

TEST(GapBetweenVoxels, IsNamedWhereTheRobotDoesNotGoThrough) {
  for (const bool margin_fits : {true, false}) {
    const Outcome outcome = RunInDividedRoom(margin_fits ? 0.15 : 0.18, !margin_fits);
    EXPECT_EQ(ToText(outcome.end), "incomplete: too much stayed unknown");
    EXPECT_FALSE(CrossedTheWall(outcome));
    ASSERT_FALSE(outcome.end.ending.tight_ways.empty());
    const Eigen::Vector3d& place_W = outcome.end.ending.tight_ways.front().place_W;
    EXPECT_LT((place_W.head<2>() - Eigen::Vector2d(1.5, 1.3)).norm(), 0.5);
  }
}

TEST(GapsInTheFlat, EndWhereTheRobotHasFoundWhatItCanGoAround) {
  const Outcome outcome = Scene("flat_ground").Run("gaps", 1);
  EXPECT_EQ(ToText(outcome.end), "the strategy does not apply");
  ASSERT_TRUE(outcome.end.ending.misfit_W);
  const Eigen::Vector3d& place_W = *outcome.end.ending.misfit_W;
  EXPECT_LT(Scene("flat_ground").world().DistanceToSurface(place_W, 1.0), 0.5) << "something stands there";
}

Outcome RiftRunIn(const char* scenario, int views, MotionModel motion = MotionModel::kKinematic) {
  return Scene(scenario, {"explorer.rift.most_views=" + std::to_string(views)})
      .Run("rift", 1, PoseSource::kTruth, {}, false, motion);
}

TEST(RiftInTheKitchen, LooksFromWhereTheMapLetsItWithoutACollisionTwiceTheSame) {
  // From the depth sensor, and from matched pixels
  for (const auto& [scenario, views] : {std::pair("kitchen", 9), std::pair("kitchen_stereo", 3)}) {
    const Outcome outcome = RiftRunIn(scenario, views);
    EXPECT_EQ(NameOf(outcome.end), "strategy_cannot_go_on");
    EXPECT_EQ(outcome.end.ending.why,
              "it keeps " + std::to_string(views) + " views, as many as it may (rift.most_views)");
    EXPECT_EQ(outcome.collisions, 0);
    EXPECT_GT(outcome.distance, 1.0);
    EXPECT_GT(outcome.left_out, 0U);
    EXPECT_EQ(outcome.left_out, outcome.end.ending.left_out);
    const Outcome again = RiftRunIn(scenario, views);
    EXPECT_EQ(again.distance, outcome.distance);
    EXPECT_EQ(again.plans, outcome.plans);
    EXPECT_EQ(again.left_out, outcome.left_out);
    EXPECT_EQ(again.coverage, outcome.coverage);
  }
}

TEST(RiftInTheKitchen, GoesAsWellWhereTheControllerLeads) {
  const Outcome outcome = RiftRunIn("kitchen", 9, MotionModel::kDynamic);
  EXPECT_EQ(NameOf(outcome.end), "strategy_cannot_go_on");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GT(outcome.distance, 1.0);
}

TEST(RiftInTheTinyRoom, EndsAtOnceWhereTheFirstViewHasNoRift) {
  const Outcome outcome = RiftRunIn("tiny_stereo", 9);
  EXPECT_EQ(ToText(outcome.end), "incomplete: too much stayed unknown, no rift is left");
  EXPECT_EQ(outcome.plans, 1U);
}

TEST(DynamicMotionThatMinimizesTime, TakesLessOfIt) {
  double path = 0.0;
  double time = 0.0;
  for (int seed = 1; seed <= 4; ++seed) {
    for (const auto& [minimize, sum] : {std::pair("PATH", &path), std::pair("TIME", &time)}) {
      const Scene scene("tiny", {"robot.attitude=LEVEL", std::string("explorer.minimize=") + minimize});
      const LockstepOptions options =
          scene.Options("closest", seed, PoseSource::kTruth, MotionModel::kDynamic);
      mapper::OccupancyMap map(options.mapper);
      *sum += RunLockstep(scene.world(), scene.Start(seed), options, map).duration;
    }
  }
  EXPECT_LT(time, 0.9 * path);
}

TEST(DynamicMotionWithOdometry, IsRefused) {
  const Scene scene("tiny_odometry");
  const LockstepOptions options = scene.Options("closest", 1, PoseSource::kOdometry, MotionModel::kDynamic);
  mapper::OccupancyMap map(options.mapper);
  EXPECT_THROW(RunLockstep(scene.world(), scene.Start(1), options, map), std::invalid_argument);
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

/// The tiny room with a small camera, so that rendering is fast.
class OwnPoseTest : public testing::Test {
 protected:
  LockstepResult Run(double seconds, int lost_inliers) const {
    LockstepOptions options = scene_.Options("closest", 1, PoseSource::kOdometry);
    options.explorer.time_budget = FromSeconds(seconds);
    options.own_pose->estimator.lost_inliers = lost_inliers;
    int& recognized = options.own_pose->estimator.finder.least_inliers;
    recognized = std::max(recognized, lost_inliers);
    mapper::OccupancyMap map(options.mapper);
    return RunLockstep(scene_.world(), scene_.Start(0), options, map);
  }

  Scene scene_{"tiny",
               {"robot.max_turn_rate_dps=45", "stereo_camera.width_px=200", "stereo_camera.height_px=150",
                "stereo_camera.rate_hz=10", "stereo_camera.noise_sigma=1"}};
  const int usual_ = visual_odometry::VisualOdometry::Options{}.lost_inliers;
};

TEST_F(OwnPoseTest, ARobotThatFindsItsPoseFromImagesDriftsLittleAndEachTimeTheSame) {
  const LockstepResult first = Run(10.0, usual_);
  ASSERT_TRUE(first.own_pose);
  EXPECT_NEAR(static_cast<double>(first.own_pose->frames), 10.0 * first.duration, 2.0);
  EXPECT_EQ(first.own_pose->lost, 0U);
  EXPECT_GT(first.distance, 0.0);
  EXPECT_GT(first.own_pose->greatest_drift, 0.0);
  EXPECT_LT(first.own_pose->greatest_drift, 0.02);
  EXPECT_EQ(first.collisions, 0);
  const LockstepResult second = Run(10.0, usual_);
  EXPECT_EQ(second.own_pose, first.own_pose);
  EXPECT_EQ(second.distance, first.distance);
  EXPECT_EQ(second.scans, first.scans);
}

TEST_F(OwnPoseTest, OneThatGetsLostGoesBackAndExploresOnWithoutACollision) {
  LockstepResult result;
  // This many points cannot be seen everywhere; where depends on the path.
  for (int inliers = 130; inliers <= 170; inliers += 20) {
    result = Run(30.0, inliers);
    ASSERT_TRUE(result.own_pose);
    if (result.own_pose->losses > 0) break;
  }
  std::cout << result.own_pose->losses << " losses, " << result.own_pose->lost << " of "
            << result.own_pose->frames << " frames lost, " << result.distance << " m, "
            << result.own_pose->greatest_drift << " m off at worst, " << ToText(result.end) << '\n';
  EXPECT_GT(result.own_pose->losses, 0U) << "it was too easy to say anything";
  EXPECT_LT(result.own_pose->lost, result.own_pose->frames / 2);
  EXPECT_NE(result.end.kind, RunEnd::Kind::kLost);
  EXPECT_LT(result.own_pose->greatest_drift, 0.1);
  EXPECT_EQ(result.collisions, 0);
}

TEST(LockstepBody, ACylindersContactsAreCountedWhereASphereHasNone) {
  const Scene scene("tiny");
  const RigidTransform start = scene.Start(0);
  LockstepOptions options = scene.Options("closest", 1);
  const auto run = [&] {
    mapper::OccupancyMap map(options.mapper);
    return RunLockstep(scene.world(), start, options, map);
  };
  const LockstepResult sphere = run();
  options.robot.height = 1.5;  // the room is 1.6 m high, and the explorer still plans for a sphere
  const LockstepResult cylinder = run();
  EXPECT_EQ(cylinder.distance, sphere.distance);
  EXPECT_EQ(sphere.collisions, 0);
  EXPECT_LT(cylinder.least_clearance, sphere.least_clearance);
  double least = 1e9;
  for (const LockstepResult::Sample& sample : cylinder.samples) {
    least = std::min(least, scene.world().ClearanceOf(options.robot, sample.p_W, 1.0));
  }
  EXPECT_LE(cylinder.least_clearance, least);
  EXPECT_NEAR(cylinder.least_clearance, least, options.robot.max_speed / options.sensor.rate)
      << "of its scans";
  EXPECT_EQ(cylinder.collisions > 0, cylinder.least_clearance < 0.0);
}

TEST(DrivingScene, HasOneTruthForAllItsStartsWhichIsTheLayerOfItsBody) {
  const Scene scene("flat_ground");
  const Eigen::Vector3d start = scene.Start(0).translation();
  const auto truth = scene.Truth(start);
  EXPECT_EQ(truth->voxels().box().min.z, 1) << "0.15 m to 0.55 m";
  EXPECT_EQ(truth->voxels().box().max.z, 6);
  EXPECT_GT(truth->observable_count(), truth->voxels().size() / 2);
  for (int seed = 1; seed <= 5; ++seed) {
    const RigidTransform other = scene.Start(seed);
    EXPECT_EQ(other.translation().z(), start.z());
    EXPECT_EQ(scene.Truth(other.translation()), truth);
  }
}

TEST(DrivingScene, IsExploredFromAMast) {
  // With the camera half a meter above its body's center, it sees the lower end of its band 1.2 m ahead.
  const Outcome outcome = Scene("flat_ground", {"robot.camera_position_m.z=0.5"}).Run("closest", 1);
  EXPECT_EQ(ToText(outcome.end), "complete");
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GE(outcome.coverage, 0.97);
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
