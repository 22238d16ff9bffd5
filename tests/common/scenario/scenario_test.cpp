#include "common/scenario/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "common/scenario/mistakes.h"

namespace thalweg {
namespace {

namespace fs = std::filesystem;
using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A temporary folder for each test.
class ScenarioFile : public testing::Test {
 protected:
  ScenarioFile()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("scenario_") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~ScenarioFile() override { fs::remove_all(folder_); }

  std::string Write(const std::string& text, const std::string& name = "run.txtpb") const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// The error that LoadScenario reports for this text.
  std::string ErrorOf(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    try {
      LoadScenario(Write(text), overrides);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  std::string At(int line, int column) const {
    return (folder_ / "run.txtpb").string() + ':' + std::to_string(line) + ':' + std::to_string(column) +
           ": ";
  }
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

using LoadScenarioTest = ScenarioFile;

TEST_F(LoadScenarioTest, ReadsWhatStandsThereAndLeavesTheRestAbsent) {
  const Scenario scenario =
      LoadScenario(Write("title: 'one room'\nmapper { voxel_size_m: 0.05 protect: true }\n"));
  EXPECT_EQ(scenario.title(), "one room");
  EXPECT_EQ(scenario.mapper().voxel_size_m(), 0.05);
  EXPECT_TRUE(scenario.mapper().protect());
  EXPECT_FALSE(scenario.mapper().has_max_range_m());
  EXPECT_FALSE(scenario.has_robot());
}

TEST_F(LoadScenarioTest, AnUnknownFieldIsNamedWithItsPlaceAndWhatThereIs) {
  EXPECT_THAT(ErrorOf("title: 'x'\nmapper {\n  voxel_sze_m: 0.1\n}\n"),
              AllOf(HasSubstr(At(3, 3) + "voxel_sze_m: no such field in Mapper"), HasSubstr("voxel_size_m")));
  EXPECT_THAT(ErrorOf("maper { }\n"), AllOf(HasSubstr(At(1, 1) + "maper: no such field in Scenario"),
                                            HasSubstr("did you mean mapper?")));
  EXPECT_THAT(ErrorOf("explorer { potential { way: SHORTEST } }"),
              AllOf(HasSubstr("way: no such field in Potential"), HasSubstr("path")))
      << "a name that the field had before";
}

TEST_F(LoadScenarioTest, AWrongTypeIsNamedWithItsPlace) {
  EXPECT_THAT(ErrorOf("mapper {\n  voxel_size_m: \"small\"\n}\n"),
              HasSubstr(At(2, 17) + "voxel_size_m: is \"small\", must be a number"));
  EXPECT_THAT(ErrorOf("mapper { protect: 0.5 }"), HasSubstr("protect: "));
  EXPECT_THAT(ErrorOf("mapper { protect: maybe }"),
              HasSubstr("protect: is \"maybe\", must be true or false"));
  EXPECT_THAT(ErrorOf("world { up_axis: X }"), HasSubstr("up_axis: is \"X\", must be one of Z, Y"));
  EXPECT_THAT(ErrorOf("visual_odometry { topic_type: \"pose\" }"),
              HasSubstr("topic_type: is \"pose\", must be one of ODOMETRY, POSE"))
      << "text, as it was before";
  EXPECT_THAT(ErrorOf("depth_sensor { width_px: 3000000000 }"), HasSubstr("width_px: "));
}

TEST_F(LoadScenarioTest, AFieldGivenTwiceIsRefused) {
  EXPECT_THAT(ErrorOf("mapper {\n  max_range_m: 3\n  max_range_m: 4\n}\n"),
              AllOf(HasSubstr("run.txtpb:3:"), HasSubstr("max_range_m")));
}

TEST_F(LoadScenarioTest, AnUnfinishedFileIsRefused) {
  EXPECT_THAT(ErrorOf("mapper {\n  max_range_m: 3\n"), HasSubstr("run.txtpb:"));
}

TEST_F(LoadScenarioTest, AValueOutOfRangeIsNamedWithItsPlaceAndWhatIsAllowed) {
  EXPECT_EQ(ErrorOf("robot {\n  radius_m: -0.1\n}\n"),
            At(2, 3) + "robot.radius_m: is -0.1, must be in (0, 10] m");
  EXPECT_EQ(ErrorOf("stereo { engine: 'fast' }\ndepth_source: DEPTH_SENSOR"),
            At(1, 10) +
                "stereo.engine: is \"fast\", must be one of sad5-dog, sad5-log, sad5-bilateral, "
                "sad5-none, sad5-thesis, opencv-bm, opencv-sgbm, best");
}

TEST_F(LoadScenarioTest, ARangeHasItsUnit) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"robot { max_speed_mps: -1 }", "(0, 20] m/s"},
      {"robot { max_acceleration_mps2: -1 }", "(0, 100] m/s^2"},
      {"robot { max_turn_rate_dps: -1 }", "(0, 3600] deg/s"},
      {"robot { camera_position_m { z: 1e7 } }", "[-1e6, 1e6] m"},
      {"depth_sensor { width_px: 1 }", "[2, 4096] px"},
      {"depth_sensor { rate_hz: 0 }", "(0, 1000] Hz"},
      {"depth_sensor { horizontal_fov_deg: 200 }", "(0, 180) deg"},
      {"explorer { min_cluster_area_m2: -1 }", "[0, 1000] m^2"},
      {"explorer { looks_before_set_aside: 0 }", "[1, 1000]"},
      {"controller { silence_s: 0 }", "(0, 60] s"},
      {"network { segment_mb: 0 }", "[1, 2000] MB"},
      {"explorer { gain { decay_per_m: -1 } }", "[0, 100] 1/m"},
      {"mapper { depth_error_per_m: -1 }", "[0, 10] 1/m"},
      {"explorer { flow { sight_worth_m_per_m2: -1 } }", "[0, 1000] m/m^2"},
  };
  for (const auto& [text, range] : cases) {
    EXPECT_THAT(ErrorOf(text), testing::EndsWith(", must be in " + range)) << text;
  }
}

TEST_F(LoadScenarioTest, EveryMistakeIsListed) {
  EXPECT_THAT(
      ErrorOf("robot { radius_m: nan }\nmapper { log_odds_miss: 0.4 }\ncontroller { rate_hz: inf }\n"),
      AllOf(HasSubstr(At(1, 9) + "robot.radius_m: is nan"), HasSubstr(At(2, 10) + "mapper.log_odds_miss"),
            HasSubstr(At(3, 14) + "controller.rate_hz: is inf")));
}

TEST_F(LoadScenarioTest, APartThatMovesNeedsABoxAndATimetableThatCanBeFollowed) {
  const std::string box = "min_m { x: 1 y: 1 z: 1 } max_m { x: 2 y: 2 z: 2 } ";
  const auto error_of = [&](const std::string& part) {
    return ErrorOf("world { moving { " + box + "places { time_s: 0 } }\nmoving { " + part + " } }");
  };
  EXPECT_EQ(error_of(box + "places { time_s: 0 yaw_deg: 90 } places { time_s: 60 yaw_deg: 90 } period_s: 60"),
            "");
  EXPECT_EQ(error_of(box + "places { time_s: 4 } places { time_s: 60 yaw_deg: 9 } period_s: 60"), "");
  EXPECT_THAT(
      error_of("places { time_s: 0 }"),
      HasSubstr(At(2, 1) + "world.moving: part 2 from (0, 0, 0) to (0, 0, 0) needs min_m and a max_m"));
  EXPECT_THAT(error_of("min_m { x: 1 } max_m { x: 1 y: 1 z: 1 } places { time_s: 0 }"),
              HasSubstr("part 2 from (1, 0, 0) to (1, 1, 1) needs"));
  EXPECT_THAT(error_of(box), HasSubstr(At(2, 1) + "world.moving: part 2 needs a place"));
  EXPECT_THAT(
      error_of(box + "places { time_s: 0 }\nplaces { time_s: 5 }\nplaces { time_s: 5 }"),
      HasSubstr(At(4, 10) + "world.moving.places.time_s: of part 2 is 5 in place 3, must be later than in "
                            "the place before, 5 s"));
  EXPECT_THAT(
      error_of(box + "places { time_s: 0 }\nplaces { time_s: 5\nyaw_deg: 1e9 }"),
      HasSubstr(At(4, 1) + "world.moving.places.yaw_deg: is 1000000000, must be in [-3600, 3600] deg"));
  EXPECT_THAT(
      error_of(box + "places { time_s: 0 } places { time_s: 50 }\nperiod_s: 49"),
      HasSubstr(At(3, 1) + "world.moving.period_s: of part 2 is 49, must be at least the time of its last "
                           "place, 50 s, or 0"));
  EXPECT_THAT(error_of(box + "places { time_s: 0 } places { time_s: 50 yaw_deg: 1 } period_s: 50"),
              HasSubstr("of part 2 is 50, which leaves no time to go back from its last place to its first"));
}

TEST_F(LoadScenarioTest, FieldsThatContradictEachOtherAreNamed) {
  EXPECT_THAT(ErrorOf("mapper { min_range_m: 3 max_range_m: 2 }"), HasSubstr("mapper.min_range_m"));
  EXPECT_THAT(ErrorOf("world { bounds_min_m { x: 1 } bounds_max_m { x: 0 y: 1 z: 1 } }"),
              HasSubstr(At(1, 31) + "world.bounds_max_m"));
  EXPECT_THAT(ErrorOf("world { bounds_min_m { x: 1 } }"), HasSubstr("needs both"));
  EXPECT_THAT(ErrorOf("world { no_go { min_m { x: 1 } max_m { x: 2 y: 1 z: 1 } }\n"
                      "no_go { min_m { x: 1 } max_m { x: 0 y: 1 z: 1 } } }"),
              AllOf(HasSubstr(At(2, 1) + "world.no_go"), HasSubstr("box 2 from")));
  EXPECT_THAT(ErrorOf("world { no_go { min_m { x: 1 } max_m { x: 2 y: 1 z: 1 } }\n"
                      "no_go { min_m { x: nan } max_m { x: 2 y: 1 z: 1 } } }"),
              HasSubstr(At(2, 17) + "world.no_go.min_m.x: is nan"));
  EXPECT_THAT(ErrorOf("world { no_go { min_m { x: nan } max_m { x: 2 y: 1 z: 1 } } }"),
              HasSubstr("x: is nan"));
  EXPECT_THAT(ErrorOf("network { network_interface: 'eth0' }"), HasSubstr("must be an IPv4 address"));
  for (const char* const list : {"host", "a:1;b", "a:1;", "a:1,b:2"}) {
    EXPECT_THAT(ErrorOf("network { discovery_server: '" + std::string(list) + "' }"),
                HasSubstr("must be HOST:PORT"))
        << list;
  }
  EXPECT_EQ(ErrorOf("network { discovery_server: 'a:1;;base.local:11811' }"), "");
  for (const char* const list : {"a,", "a b", "a,,b", "a:1"}) {
    EXPECT_THAT(ErrorOf("network { peers: '" + std::string(list) + "' }"), HasSubstr("must be HOST,HOST,..."))
        << list;
  }
  EXPECT_THAT(ErrorOf("network { peers: 'a' discovery_server: 'b:1' }"), HasSubstr("one or the other"));
}

TEST_F(LoadScenarioTest, OverridesWinOverTheFile) {
  const Scenario scenario = LoadScenario(
      Write("mapper { voxel_size_m: 0.1 fill: true } explorer { strategy: 'closest' }"),
      {"mapper.voxel_size_m=0.05", "mapper.fill=false", "explorer.strategy=potential", "world.up_axis=Y",
       "explorer.potential.screening_length_m=3", "simulator.start_position_m={x: 1 y: 2 z: 3}",
       "robot.camera_position_m.z=0.25", "title=two words", "mapper.voxel_size_m=0.06"});
  EXPECT_EQ(scenario.mapper().voxel_size_m(), 0.06);
  EXPECT_FALSE(scenario.mapper().fill());
  EXPECT_EQ(scenario.explorer().strategy(), "potential");
  EXPECT_EQ(scenario.world().up_axis(), World::Y);
  EXPECT_EQ(scenario.explorer().potential().screening_length_m(), 3.0);
  EXPECT_EQ(scenario.simulator().start_position_m().y(), 2.0);
  EXPECT_EQ(scenario.robot().camera_position_m().z(), 0.25);
  EXPECT_EQ(scenario.title(), "two words");
}

TEST_F(LoadScenarioTest, AnOverridesMistakeIsNamedWithTheOverride) {
  EXPECT_THAT(
      ErrorOf("", {"mapper.voxel=1"}),
      AllOf(HasSubstr("--set mapper.voxel=1: voxel: no such field in mapper"), HasSubstr("voxel_size_m")));
  EXPECT_THAT(ErrorOf("", {"title.x=1"}), HasSubstr("title is a value and has no field x"));
  EXPECT_THAT(ErrorOf("", {"explorer.stratgey=flow"}), HasSubstr("did you mean strategy?"));
  EXPECT_THAT(ErrorOf("", {"explorer.flow=5"}),
              AllOf(HasSubstr("explorer.flow is a group; set one of its fields"), HasSubstr("hysteresis")));
  EXPECT_THAT(ErrorOf("", {"mapper.fill"}), HasSubstr("must be FIELD=VALUE"));
  EXPECT_THAT(ErrorOf("", {"=1"}), HasSubstr("names no field"));
  EXPECT_EQ(ErrorOf("", {"mapper.fill=maybe"}),
            "--set mapper.fill=maybe: mapper.fill: is \"maybe\", must be true or false");
  EXPECT_EQ(ErrorOf("", {"robot.radius_m=abc"}),
            "--set robot.radius_m=abc: robot.radius_m: is \"abc\", must be a number in (0, 10] m");
  EXPECT_EQ(ErrorOf("", {"mapper.voxel_size_m=0.1cm"}),
            "--set mapper.voxel_size_m=0.1cm: mapper.voxel_size_m: is \"0.1cm\", must be a number in [0.005, "
            "10] m");
  EXPECT_THAT(ErrorOf("", {"mapper.voxel_size_m="}),
              HasSubstr("mapper.voxel_size_m: is \"\", must be a number"));
  EXPECT_THAT(ErrorOf("", {"mapper.voxel_size_m=0.1 max_range_m: 3"}), HasSubstr("must be a number"));
  EXPECT_THAT(ErrorOf("", {"depth_sensor.width_px=1.5"}),
              HasSubstr("must be a whole number in [2, 4096] px"));
  EXPECT_THAT(ErrorOf("", {"world.up_axis=X"}), HasSubstr("world.up_axis: is \"X\", must be one of Z, Y"));
  EXPECT_EQ(ErrorOf("", {"mapper={voxel_size_m: a}"}),
            "--set mapper={voxel_size_m: a}: voxel_size_m: is a, must be a number");
  EXPECT_EQ(ErrorOf("robot { radius_m: 0.1 }", {"robot.radius_m=-1"}),
            "--set robot.radius_m=-1: robot.radius_m: is -1, must be in (0, 10] m");
}

TEST_F(LoadScenarioTest, TheStartMustBeInsideTheBounds) {
  const std::string world = "world { bounds_min_m { x: 0 } bounds_max_m { x: 4 y: 3 z: 2 } }\n";
  EXPECT_EQ(ErrorOf(world + "simulator {\n  start_position_m { x: 5 y: 1 z: 1 }\n}"),
            At(3, 3) +
                "simulator.start_position_m: is (5, 1, 1), must be inside the world's bounds, (0, 0, 0) to "
                "(4, 3, 2) m");
  EXPECT_EQ(ErrorOf(world + "simulator { start_position_m { x: 4 y: 1 z: 1 } }"), "");
  EXPECT_EQ(ErrorOf("simulator { start_position_m { x: 5 y: 1 z: 1 } }"), "");
  EXPECT_THAT(
      ErrorOf(world + "simulator { start_position_m { x: 3 y: 1 z: 1 } }", {"world.bounds_max_m.x=2"}),
      HasSubstr(At(2, 13) + "simulator.start_position_m"));
}

TEST_F(LoadScenarioTest, RangesMustBeMoreThanNothing) {
  EXPECT_EQ(ErrorOf("mapper {\n  min_range_m: 3\n  max_range_m: 2\n}"),
            At(2, 3) + "mapper.min_range_m: is 3, must be less than mapper.max_range_m, 2 m");
  EXPECT_EQ(ErrorOf("mapper { min_range_m: 3 }\ndepth_sensor { max_range_m: 2 }"),
            At(1, 10) + "mapper.min_range_m: is 3, must be less than depth_sensor.max_range_m, 2 m");
  EXPECT_EQ(ErrorOf("mapper { min_range_m: 1 max_range_m: 2 }"), "");
}

TEST_F(LoadScenarioTest, WhatASourceNeedsMustBeThere) {
  const std::string camera = "stereo_camera { enabled: true }\n";
  EXPECT_EQ(ErrorOf("depth_source: STEREO"),
            At(1, 1) + "depth_source: is STEREO, which needs stereo_camera.enabled: true");
  EXPECT_EQ(ErrorOf("depth_source: STEREO\nstereo_camera { enabled: false }"),
            At(1, 1) + "depth_source: is STEREO, which needs stereo_camera.enabled: true");
  EXPECT_EQ(ErrorOf(camera + "depth_source: STEREO"), "");
  EXPECT_EQ(ErrorOf("odometry_source: VISUAL_ODOMETRY"),
            At(1, 1) +
                "odometry_source: is VISUAL_ODOMETRY with visual_odometry.source STEREO, which needs "
                "stereo_camera.enabled: true");
  EXPECT_EQ(ErrorOf(camera + "odometry_source: VISUAL_ODOMETRY"), "");
  EXPECT_EQ(ErrorOf("odometry_source: VISUAL_ODOMETRY visual_odometry { source: TRUTH }"), "");
  EXPECT_EQ(ErrorOf("depth_source: EXTERNAL odometry_source: EXTERNAL"), "");
  EXPECT_EQ(ErrorOf(camera + "depth_source: STEREO\ndepth_sensor { no_return_is_free: true }"),
            At(3, 16) +
                "depth_sensor.no_return_is_free: is true, but depth comes from stereo images, where a pixel "
                "without depth does not mean free space");
  EXPECT_EQ(ErrorOf("depth_sensor { no_return_is_free: true }"), "");
  EXPECT_THAT(ErrorOf("depth_source: LIDAR"),
              HasSubstr("depth_source: is \"LIDAR\", must be one of DEPTH_SENSOR, STEREO, EXTERNAL"));
}

TEST_F(LoadScenarioTest, ABlockThatStandsThereSwitchesNothingOnByItself) {
  EXPECT_THAT(ErrorOf("\nstereo {}"),
              HasSubstr(At(2, 1) + "stereo: is configured, but depth_source is not set"));
  EXPECT_EQ(ErrorOf("stereo {} depth_source: DEPTH_SENSOR"), "") << "configured, and left out on purpose";
  EXPECT_THAT(ErrorOf("visual_odometry { source: TRUTH }"),
              HasSubstr(At(1, 1) + "visual_odometry: is configured, but odometry_source is not set"));
  EXPECT_EQ(ErrorOf("visual_odometry {} odometry_source: SIMULATOR"), "");
}

TEST_F(LoadScenarioTest, AFieldOfEarlierVersionsIsRefusedWithItsSuccessor) {
  EXPECT_THAT(
      ErrorOf("depth_sensor { enabled: false }"),
      AllOf(
          HasSubstr(At(1, 16) + "enabled: no such field in DepthSensor"),
          HasSubstr("; use depth_source (DEPTH_SENSOR, STEREO or EXTERNAL) outside of this block instead")));
  EXPECT_THAT(ErrorOf("", {"explorer.flow.sight_worth=1"}), HasSubstr("; use sight_worth_m_per_m2 instead"));
}

TEST_F(LoadScenarioTest, MistakesThatOnlyAServiceKnowsAreNamedWithTheirPlaceToo) {
  const auto no_luck = [](const Scenario& scenario) {
    std::vector<Mistake> mistakes;
    const auto* const explorer = Scenario::descriptor()->FindFieldByName("explorer");
    const auto* const strategy = explorer->message_type()->FindFieldByName("strategy");
    if (scenario.explorer().strategy() == "luck")
      mistakes.push_back({.field = {explorer, strategy}, .text = "is luck"});
    return mistakes;
  };
  const auto error_of = [&](const std::string& text, const std::vector<std::string>& overrides) {
    try {
      LoadScenario(Write(text), overrides, {.mistakes = no_luck});
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(error_of("explorer {\n  strategy: 'luck' }", {}), At(2, 3) + "explorer.strategy: is luck");
  EXPECT_EQ(error_of("", {"explorer.strategy=luck"}),
            "--set explorer.strategy=luck: explorer.strategy: is luck");
  EXPECT_EQ(error_of("explorer { strategy: 'skill' }", {}), "");
}

TEST(NotOneOf, NamesTheNearestWhenItIsNear) {
  const std::vector<std::string> names = {"closest", "potential", "flow"};
  EXPECT_EQ(NotOneOf(names, "clsest"),
            "is \"clsest\", must be one of closest, potential, flow; did you mean closest?");
  EXPECT_EQ(NotOneOf(names, "flo"),
            "is \"flo\", must be one of closest, potential, flow; did you mean flow?");
  EXPECT_EQ(NotOneOf(names, "luck"), "is \"luck\", must be one of closest, potential, flow");
  EXPECT_EQ(NotOneOf(names, ""), "is \"\", must be one of closest, potential, flow");
}

TEST_F(LoadScenarioTest, TheRangeMustNotBeTooManyVoxels) {
  EXPECT_EQ(ErrorOf("mapper {\n  voxel_size_m: 0.01\n  max_range_m: 5\n}"),
            At(3, 3) +
                "mapper.max_range_m: is 5 m, 500 voxels of mapper.voxel_size_m 0.01 m, must be at most 399 "
                "voxels");
  EXPECT_EQ(ErrorOf("mapper { voxel_size_m: 0.01 max_range_m: 3.99 }"), "");
  EXPECT_THAT(ErrorOf("mapper { voxel_size_m: 0.1 max_range_m: 5 }", {"mapper.voxel_size_m=0.01"}),
              HasSubstr(At(1, 28) + "mapper.max_range_m: is 5 m, 500 voxels"));
}

TEST_F(LoadScenarioTest, VoxelsMustSuitTheRobot) {
  EXPECT_EQ(
      ErrorOf("robot { radius_m: 0.1 }\nmapper { voxel_size_m: 0.25 }"),
      At(2, 10) +
          "mapper.voxel_size_m: is 0.25, must be at most the robot's width, 2 * robot.radius_m = 0.2 m: "
          "larger voxels cannot show where the robot fits");
  EXPECT_EQ(ErrorOf("robot { radius_m: 0.1 } mapper { voxel_size_m: 0.2 }"), "");
  EXPECT_THAT(ErrorOf("mapper { voxel_size_m: 9 }"), HasSubstr("must be at most the robot's width"));
  EXPECT_EQ(
      ErrorOf("robot { radius_m: 0.9 }\nmapper { voxel_size_m: 0.05 }\nexplorer { safety_margin_m: 0.2 }"),
      At(1, 9) +
          "robot.radius_m: with explorer.safety_margin_m is 1.1 m, 22 voxels of mapper.voxel_size_m "
          "0.05 m, must be at most 20 voxels");
  EXPECT_EQ(
      ErrorOf("robot { radius_m: 0.9 } mapper { voxel_size_m: 0.05 } explorer { safety_margin_m: 0.1 }"), "");
}

TEST_F(LoadScenarioTest, WhatContradictsAWrongValueIsNoSecondMistake) {
  EXPECT_THAT(ErrorOf("robot { radius_m: -1 }\nmapper { voxel_size_m: 0.1 }"),
              AllOf(HasSubstr("robot.radius_m: is -1"), Not(HasSubstr("robot's width"))));
  EXPECT_THAT(ErrorOf("world { no_go { min_m { x: nan } max_m { x: 2 y: 1 z: 1 } }\n"
                      "no_go { min_m { x: 1 } max_m { x: 0 y: 1 z: 1 } } }"),
              AllOf(HasSubstr("min_m.x: is nan"), Not(HasSubstr("box 1"))));
  EXPECT_THAT(ErrorOf("world { bounds_min_m { x: 1e8 } bounds_max_m { x: 1 y: 1 z: 1 } }"),
              AllOf(HasSubstr("bounds_min_m.x: is"), Not(HasSubstr("must be greater"))));
  EXPECT_THAT(ErrorOf("mapper { voxel_size_m: 0.1 } explorer { safety_margin_m: 100 }"),
              AllOf(HasSubstr("safety_margin_m: is 100"), Not(HasSubstr("voxels of"))));
  EXPECT_THAT(ErrorOf("mapper { voxel_size_m: 0 max_range_m: 50 }"),
              AllOf(HasSubstr("voxel_size_m: is 0"), Not(HasSubstr("max_range_m"))));
}

TEST_F(LoadScenarioTest, ARobotThatDrivesHasAHeight) {
  const std::string mistake =
      "robot.drives: is true, which needs robot.height_m > 0: a driving robot is an upright cylinder and "
      "explores the heights that it sweeps";
  EXPECT_EQ(ErrorOf("robot { drives: true }"), At(1, 9) + mistake);
  EXPECT_EQ(ErrorOf("robot {\n  height_m: 0\n  drives: true\n}"), At(3, 3) + mistake);
  EXPECT_EQ(ErrorOf("robot { drives: true height_m: 0.4 }"), "");
  EXPECT_EQ(ErrorOf("robot { drives: false }"), "");
  EXPECT_EQ(ErrorOf("robot { drives: true height_m: 0.4 drive: DIFFERENTIAL }"), "");
  EXPECT_EQ(ErrorOf("robot { drive: DIFFERENTIAL }"),
            At(1, 9) + "robot.drive: is DIFFERENTIAL, which needs robot.drives: true");
  EXPECT_EQ(ErrorOf("robot { height_m: 0.4 }"), "") << "one that flies may be a cylinder, too";
}

TEST_F(LoadScenarioTest, ARobotThatTurnsOnlyInCurvesNeedsTheirRadiusAndAFittingController) {
  EXPECT_EQ(ErrorOf("robot { drives: true height_m: 0.4 drive: ACKERMANN min_turning_radius_m: 0.5 }"), "");
  EXPECT_EQ(ErrorOf("robot { drives: true height_m: 0.4\n drive: ACKERMANN }"),
            At(2, 2) + "robot.drive: is ACKERMANN, which needs robot.min_turning_radius_m > 0");
  EXPECT_EQ(
      ErrorOf("robot { drives: true height_m: 0.4\n min_turning_radius_m: 0.5 }"),
      At(2, 2) +
          "robot.min_turning_radius_m: is 0.5, must be 0 for a robot whose robot.drive is OMNI: it turns "
          "on the spot");
  EXPECT_THAT(ErrorOf("robot { drive: ACKERMANN min_turning_radius_m: 0.5 }"),
              HasSubstr("robot.drive: is ACKERMANN, which needs robot.drives: true"));
  EXPECT_THAT(
      ErrorOf("robot { drives: true height_m: 0.4 drive: ACKERMANN min_turning_radius_m: 0.5 }\n"
              "controller { type: STOP_AND_TURN }"),
      HasSubstr("controller.type: is STOP_AND_TURN, but a robot whose robot.drive is ACKERMANN cannot "
                "turn on the spot"));
}

TEST_F(LoadScenarioTest, AGimbalHasLimitsInOrderAndCarriesTheBodysFrame) {
  EXPECT_EQ(ErrorOf("robot { attitude: GIMBAL gimbal_min_pitch_deg: -60 gimbal_max_pitch_deg: 20 }"), "");
  EXPECT_EQ(ErrorOf("robot { attitude: GIMBAL\n gimbal_min_pitch_deg: 40 }"),
            At(2, 2) + "robot.gimbal_min_pitch_deg: is 40, must be at most robot.gimbal_max_pitch_deg, 30");
  EXPECT_EQ(ErrorOf("robot { attitude: GIMBAL\n camera_position_m { x: 0.1 } }"),
            At(2, 2) +
                "robot.camera_position_m: must be 0 for a robot whose robot.attitude is GIMBAL: base_link is "
                "at the gimbal's axis");
  EXPECT_EQ(ErrorOf("robot { gimbal_min_pitch_deg: 40 camera_position_m { x: 0.1 } }"), "") << "it has none";
}

TEST_F(LoadScenarioTest, LimitedJerkKeepsTheRobotOnItsPath) {
  // a^3 / (6 j^2) <= 1 cm
  EXPECT_EQ(ErrorOf("robot { max_acceleration_mps2: 3 max_jerk_mps3: 30 }"), "");
  EXPECT_EQ(ErrorOf("robot { max_acceleration_mps2: 3 max_jerk_mps3: 0 }"), "");
  EXPECT_EQ(ErrorOf("robot {\n  max_acceleration_mps2: 3\n  max_jerk_mps3: 21\n}"),
            At(3, 3) +
                "robot.max_jerk_mps3: is 21, must be 0 or at least 21.3 for robot.max_acceleration_mps2, "
                "3: else curves are cut by more than 1 cm");
  EXPECT_EQ(ErrorOf("robot { max_jerk_mps3: 4.1 }"), "");
  EXPECT_THAT(ErrorOf("robot { max_jerk_mps3: 4 }"), HasSubstr("must be 0 or at least 4.1 for"));
  EXPECT_THAT(
      ErrorOf("robot { drives: true height_m: 0.4 drive: DIFFERENTIAL max_jerk_mps3: 50 }"),
      HasSubstr("robot.max_jerk_mps3: is 50, must be 0 for a robot whose robot.drive is DIFFERENTIAL"));
}

TEST_F(LoadScenarioTest, AFieldMayContradictADefaultThatTheCallerKnows) {
  const auto with_range = [](const Scenario& given) {
    Scenario scenario = given;
    if (!given.mapper().has_max_range_m()) scenario.mutable_mapper()->set_max_range_m(5.0);
    return scenario;
  };
  const std::string file = Write("mapper {\n  voxel_size_m: 0.01\n}");
  EXPECT_NO_THROW(LoadScenario(file));
  try {
    LoadScenario(file, {}, {.with_defaults = with_range});
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(At(2, 3) + "mapper.max_range_m: is 5 m, 500 voxels"));
  }
  EXPECT_FALSE(LoadScenario(file, {"mapper.voxel_size_m=0.1"}, {.with_defaults = with_range})
                   .mapper()
                   .has_max_range_m());
}

TEST_F(LoadScenarioTest, AWorldFileIsFoundBesideTheScenario) {
  Write("", "room.obj");
  const Scenario scenario = LoadScenario(Write("world { file: 'room.obj' }"));
  EXPECT_EQ(scenario.world().file(), (folder() / "room.obj").string());
}

TEST_F(LoadScenarioTest, AWorldFileIsFoundAmongTheData) {
  Write("", "house.obj");
  const char* const before = std::getenv("THALWEG_DATA");
  const std::string kept = before == nullptr ? "" : before;
  setenv("THALWEG_DATA", folder().c_str(), 1);
  const std::string text = "world { file: '${THALWEG_DATA}/house.obj' }";
  EXPECT_EQ(LoadScenario(Write(text)).world().file(), (folder() / "house.obj").string());
  unsetenv("THALWEG_DATA");
  EXPECT_THAT(ErrorOf(text), HasSubstr(At(1, 9) + "world.file: needs the environment variable THALWEG_DATA"));
  if (before != nullptr) setenv("THALWEG_DATA", kept.c_str(), 1);
}

TEST_F(LoadScenarioTest, AMissingWorldFileIsNamedWithItsPlace) {
  EXPECT_THAT(ErrorOf("\nworld { file: 'nowhere.obj' }"),
              AllOf(HasSubstr(At(2, 9) + "world.file: is "), HasSubstr("nowhere.obj, which is not a file")));
}

TEST_F(LoadScenarioTest, AScenarioIsFoundByItsNameAndOthersAreListed) {
  Write("title: 'shipped'", "kitchen.txtpb");
  setenv("THALWEG_SCENARIOS", folder().c_str(), 1);
  EXPECT_EQ(LoadScenario("kitchen").title(), "shipped");
  try {
    LoadScenario("kichten");
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("kichten"), HasSubstr(" kitchen")));
  }
  unsetenv("THALWEG_SCENARIOS");
}

TEST_F(LoadScenarioTest, WhatIsSavedIsLoadedAgain) {
  Write("", "room.obj");
  const Scenario scenario = LoadScenario(
      Write("world { file: 'room.obj' scale: 0.1 } mapper { voxel_size_m: 0.07 } title: 'a \"b\"'"));
  fs::create_directories(folder() / "elsewhere");
  const fs::path copy = folder() / "elsewhere" / "scenario.txtpb";
  SaveScenario(scenario, copy);
  EXPECT_EQ(LoadScenario(copy.string()).SerializeAsString(), scenario.SerializeAsString());
  EXPECT_THROW(SaveScenario(scenario, folder() / "room.obj" / "x"), std::runtime_error);
}

TEST(CheckScenario, NamesFieldValueAndWhatIsAllowed) {
  Scenario scenario;
  EXPECT_NO_THROW(CheckScenario(scenario));
  scenario.mutable_mapper()->set_max_range_m(-3.0);
  try {
    CheckScenario(scenario);
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "mapper.max_range_m: is -3, must be in (0, 1000] m");
  }
}

TEST_F(LoadScenarioTest, AServiceIsNotItsOwnSource) {
  EXPECT_THAT(
      ErrorOf("odometry_source: VISUAL_ODOMETRY\nvisual_odometry {\n  source: TOPIC\n  topic: 'odometry'\n}"),
      HasSubstr(At(4, 3) + "visual_odometry.topic: is \"odometry\", which this service itself publishes: "
                           "it would read its own output"));
  EXPECT_EQ(
      ErrorOf("odometry_source: VISUAL_ODOMETRY visual_odometry { source: TOPIC topic: 'vehicle/odometry' }"),
      "");
}

/// Calls visit(message, field) for each numeric field, where `message` is the part of `scenario` to set it
/// in.
void ForEachNumber(Message& message, const std::function<void(Message&, const FieldDescriptor*)>& visit) {
  const Descriptor* const type = message.GetDescriptor();
  for (int k = 0; k < type->field_count(); ++k) {
    const FieldDescriptor* const field = type->field(k);
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      const auto* const reflection = message.GetReflection();
      ForEachNumber(*(field->is_repeated() ? reflection->AddMessage(&message, field)
                                           : reflection->MutableMessage(&message, field)),
                    visit);
      message.GetReflection()->ClearField(&message, field);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE ||
               field->cpp_type() == FieldDescriptor::CPPTYPE_INT32) {
      visit(message, field);
      message.GetReflection()->ClearField(&message, field);
    }
  }
}

TEST(CheckScenario, EveryNumberHasARangeAndWhatLiesOutsideIsRefused) {
  Scenario scenario;
  int numbers = 0;
  ForEachNumber(scenario, [&](Message& message, const FieldDescriptor* field) {
    ++numbers;
    const std::string& interval = field->options().GetExtension(allowed);
    ASSERT_FALSE(interval.empty()) << field->full_name();
    double low = 0.0;
    double high = 0.0;
    ASSERT_EQ(std::sscanf(interval.c_str(), "%*c%lf, %lf", &low, &high), 2) << field->full_name();
    ASSERT_LT(low, high) << field->full_name();
    const bool whole = field->cpp_type() == FieldDescriptor::CPPTYPE_INT32;
    for (const double value : {low - 1.0, high * 1.01 + 1.0, std::nan("")}) {
      if (whole && (std::isnan(value) || std::abs(value) > 2e9)) continue;
      if (whole) {
        message.GetReflection()->SetInt32(&message, field, static_cast<std::int32_t>(value));
      } else {
        message.GetReflection()->SetDouble(&message, field, value);
      }
      EXPECT_THROW(CheckScenario(scenario), std::invalid_argument) << field->full_name() << ' ' << value;
    }
  });
  EXPECT_GT(numbers, 50);
}

TEST_F(LoadScenarioTest, NamesMustBeThoseOfRos2) {
  for (const char* bad : {"", "1st", "a//b", "a/", "a b", "a__b", "points!", "a/2"}) {
    EXPECT_THAT(ErrorOf("topics { depth_points: \"" + std::string(bad) + "\" }"),
                HasSubstr("must be a name of ROS 2"))
        << bad;
  }
  EXPECT_EQ(ErrorOf("topics { depth_points: \"camera/depth/points\" odometry: \"/wheel_odometry\" }"), "");
  EXPECT_EQ(ErrorOf("robot { name: \"scout\" } frames { camera: \"lens\" }"), "");
  EXPECT_THAT(ErrorOf("robot { name: \"/scout\" }"), HasSubstr("robot.name: is \"/scout\""));
  EXPECT_THAT(ErrorOf("frames { camera: \"/lens\" }"), HasSubstr("frames.camera: is \"/lens\""));
}

TEST_F(LoadScenarioTest, TwoTopicsOrTwoFramesOfOneNameAreRefused) {
  EXPECT_THAT(ErrorOf("topics { depth_points: \"a\" map_updates: \"a\" }"),
              HasSubstr("is \"a\", which is the name of topics.depth_points already"));
  EXPECT_THAT(ErrorOf("frames { map: \"a\" camera: \"a\" }"), HasSubstr("frames.map already"));
}

TEST(Interval, HoldsItsClosedEndsOnly) {
  EXPECT_TRUE(IsInInterval(1.0, "[1, 2)"));
  EXPECT_FALSE(IsInInterval(2.0, "[1, 2)"));
  EXPECT_FALSE(IsInInterval(1.0, "(1, 2]"));
  EXPECT_TRUE(IsInInterval(2.0, "(1, 2]"));
  EXPECT_FALSE(IsInInterval(std::nan(""), "[-1e300, 1e300]"));
}

}  // namespace
}  // namespace thalweg
