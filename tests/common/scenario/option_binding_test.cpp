#include "common/scenario/option_binding.h"

#include <gtest/gtest.h>

#include "common/scenario/models.h"

namespace thalweg {
namespace {

/// One option of each kind that a scenario has.
struct Options {
  float hit = 0.85F;
  double yaw = 1.0;
  int threads = 3;
  bool fill = true;
  std::string engine = "best";
  int axis = 0;
  std::array<double, 3> camera = {0.1, 0.2, 0.3};
};

void Visit(OptionVisitor& visitor, Options& options) {
  visitor.Block("mapper", [&](OptionVisitor& mapper) {
    mapper.Number("log_odds_hit", options.hit);
    mapper.Switch("fill", options.fill);
  });
  visitor.Block("simulator", [&](OptionVisitor& block) { block.Degrees("start_yaw_deg", options.yaw); });
  visitor.Block("stereo", [&](OptionVisitor& stereo) {
    stereo.Whole("threads", options.threads);
    stereo.Text("engine", options.engine);
  });
  visitor.Block("world", [&](OptionVisitor& world) {
    world.Choice("up_axis", options.axis, {{"Z", 0}, {"Y", 1}});
  });
  visitor.Block("robot", [&](OptionVisitor& robot) { robot.Vector("camera_position_m", options.camera); });
}

TEST(OptionReader, SetsWhatIsPresentAndLeavesTheRest) {
  Scenario scenario;
  scenario.mutable_mapper()->set_fill(false);
  scenario.mutable_simulator()->set_start_yaw_deg(180.0);
  scenario.mutable_world()->set_up_axis(World::Y);
  scenario.mutable_robot()->mutable_camera_position_m()->set_z(0.5);
  Options options;
  ReadOptions(scenario, options);
  EXPECT_FALSE(options.fill);
  EXPECT_DOUBLE_EQ(options.yaw, std::numbers::pi);
  EXPECT_EQ(options.axis, 1);
  EXPECT_EQ(options.camera, (std::array{0.0, 0.0, 0.5})) << "a vector is given as a whole";
  EXPECT_EQ(options.hit, Options().hit);
  EXPECT_EQ(options.threads, Options().threads);
  EXPECT_EQ(options.engine, Options().engine);
}

TEST(OptionWriter, FillsWhatIsAbsentWithTheDecimalsThatWereMeantAndLeavesTheRest) {
  Scenario scenario;
  scenario.mutable_stereo()->set_threads(1);
  Options options;
  OptionWriter writer(scenario);
  Visit(writer, options);
  EXPECT_EQ(scenario.mapper().log_odds_hit(), 0.85) << "not the float next to it";
  EXPECT_EQ(scenario.simulator().start_yaw_deg(), 57.29578);
  EXPECT_EQ(scenario.stereo().threads(), 1);
  EXPECT_EQ(scenario.stereo().engine(), "best");
  EXPECT_TRUE(scenario.world().has_up_axis());
  EXPECT_EQ(scenario.robot().camera_position_m().y(), 0.2);
  EXPECT_EQ(options.hit, Options().hit);
}

TEST(OptionBinding, WhatIsWrittenIsReadAgain) {
  Options written{.hit = 0.25F, .yaw = 0.5, .threads = 2, .fill = false, .engine = "opencv-bm", .axis = 1};
  Scenario scenario;
  OptionWriter writer(scenario);
  Visit(writer, written);
  Options read;
  ReadOptions(scenario, read);
  EXPECT_EQ(read.hit, written.hit);
  EXPECT_NEAR(read.yaw, written.yaw, 1e-7) << "of seven digits in degrees";
  EXPECT_EQ(read.threads, written.threads);
  EXPECT_EQ(read.fill, written.fill);
  EXPECT_EQ(read.engine, written.engine);
  EXPECT_EQ(read.axis, written.axis);
  EXPECT_EQ(read.camera, written.camera);
}

TEST(OptionBindingDeathTest, AFieldThatTheSchemaLacksOrHasAsAnotherTypeAborts) {
  Scenario scenario;
  OptionReader reader(scenario.mapper());
  OptionWriter writer(*scenario.mutable_mapper());
  double number = 0.0;
  bool flag = false;
  EXPECT_DEATH(reader.Number("voxel_sze_m", number),
               "voxel_sze_m: no such field of that type in thalweg.Mapper");
  EXPECT_DEATH(writer.Number("voxel_sze_m", number), "voxel_sze_m: no such field");
  EXPECT_DEATH(reader.Switch("voxel_size_m", flag), "voxel_size_m: no such field of that type");
}

}  // namespace
}  // namespace thalweg
