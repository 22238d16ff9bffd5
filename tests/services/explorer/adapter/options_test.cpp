#include "services/explorer/adapter/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "services/explorer/core/strategy/rift.h"

namespace thalweg::explorer {
namespace {

using testing::HasSubstr;

TEST(OptionsFrom, ConfiguresTheStrategyThatTheScenarioNames) {
  Scenario scenario;
  EXPECT_EQ(OptionsFrom(scenario).strategy.name, "cover");
  scenario.mutable_explorer()->set_strategy("potential");
  scenario.mutable_explorer()->mutable_potential()->set_cluster(thalweg::Potential::FLUX);
  const ConfiguredStrategy strategy = OptionsFrom(scenario).strategy;
  EXPECT_EQ(strategy.name, "potential");
  EXPECT_THROW(strategy.make(), std::invalid_argument) << "no streamline leads to that cluster";
  scenario.mutable_explorer()->set_strategy("flow");
  EXPECT_NO_THROW(OptionsFrom(scenario).strategy.make()) << "which has nothing to do with it";
}

TEST(OptionsFrom, ThePrintedLoopHasNoRulesButThoseThatAreSet) {
  Scenario scenario;
  scenario.mutable_explorer()->mutable_loop()->set_drop_small(false);
  EXPECT_FALSE(OptionsFrom(scenario).loop.drop_small);
  EXPECT_TRUE(OptionsFrom(scenario).loop.set_aside);
  scenario.mutable_explorer()->mutable_loop()->set_drop_small(true);
  scenario.mutable_explorer()->mutable_loop()->set_rules(Loop::PRINTED);
  EXPECT_TRUE(OptionsFrom(scenario).loop.drop_small);
  EXPECT_FALSE(OptionsFrom(scenario).loop.set_aside);
  EXPECT_FALSE(OptionsFrom(scenario).loop.look_around);
}

TEST(OptionsFrom, LooksNoFurtherThanWhatIsMappedUnlessToldTo) {
  Scenario scenario;
  const double standard = Explorer::Options().look_range;
  EXPECT_EQ(OptionsFrom(scenario).look_range, standard);
  scenario.mutable_depth_sensor()->set_max_range_m(0.5 * standard);
  EXPECT_EQ(OptionsFrom(scenario).look_range, 0.5 * standard);
  scenario.mutable_mapper()->mutable_filter()->set_type(Mapper::Filter::DISTANCE);
  EXPECT_EQ(OptionsFrom(scenario).look_range, 0.5 * standard) << "the filter drops what is beyond 10 m";
  scenario.mutable_mapper()->mutable_filter()->set_max_distance_m(0.25 * standard);
  EXPECT_EQ(OptionsFrom(scenario).look_range, 0.25 * standard);
  EXPECT_EQ(OptionsFrom(scenario).sensor_range, 0.25 * standard);
  scenario.mutable_explorer()->set_look_range_m(2.0 * standard);
  EXPECT_EQ(OptionsFrom(scenario).look_range, 2.0 * standard);
}

TEST(MistakesIn, NamesAnUnknownStrategyTheOnesThereAreAndTheNearest) {
  Scenario scenario;
  EXPECT_TRUE(explorer::MistakesIn(scenario).empty());
  for (const StrategyInfo& strategy : Strategies()) {
    scenario.mutable_explorer()->set_strategy(std::string(strategy.name));
    scenario.mutable_robot()->set_drives(strategy.robots == ForRobots::kDriving);
    EXPECT_TRUE(explorer::MistakesIn(scenario).empty()) << strategy.name;
  }
  scenario.mutable_explorer()->set_strategy("clossest");
  const std::vector<Mistake> mistakes = explorer::MistakesIn(scenario);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].field), "explorer.strategy");
  EXPECT_THAT(mistakes[0].text, HasSubstr("is \"clossest\", must be one of closest, random, "));
  EXPECT_THAT(mistakes[0].text, testing::EndsWith("; did you mean closest?"));
}

TEST(MistakesIn, NamesAStrategyThatIsForRobotsThatDrive) {
  Scenario scenario;
  scenario.mutable_explorer()->set_strategy("gaps");
  const std::vector<Mistake> mistakes = explorer::MistakesIn(scenario);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].field), "explorer.strategy");
  EXPECT_EQ(ToString(mistakes[0].other), "robot.drives");
  EXPECT_EQ(mistakes[0].text, "is \"gaps\", which is for a robot that drives, and robot.drives is false");
}

TEST(MistakesIn, NamesAStrategyThatIsForRobotsThatLookInAnyDirection) {
  Scenario scenario;
  scenario.mutable_explorer()->set_strategy("rift");
  EXPECT_TRUE(explorer::MistakesIn(scenario).empty());
  scenario.mutable_robot()->set_attitude(thalweg::Robot::LEVEL);
  std::vector<Mistake> mistakes = explorer::MistakesIn(scenario);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].other), "robot.attitude");
  EXPECT_EQ(
      mistakes[0].text,
      "is \"rift\", which is for a robot that flies and can look in any direction, and robot.attitude is "
      "LEVEL");
  scenario.mutable_robot()->set_drives(true);
  mistakes = explorer::MistakesIn(scenario);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].other), "robot.drives");
}

TEST(OptionsFrom, BindsWhatStrategyRiftIsGiven) {
  Scenario scenario;
  scenario.mutable_explorer()->set_strategy("rift");
  scenario.mutable_explorer()->mutable_rift()->set_most_views(1);
  scenario.mutable_explorer()->mutable_rift()->set_height_m(0.5);
  const std::unique_ptr<Strategy> strategy = OptionsFrom(scenario).strategy.make();
  const auto* const rift = dynamic_cast<const Rift*>(strategy.get());
  ASSERT_NE(rift, nullptr);
  EXPECT_EQ(rift->surface().options().height, 0.5);
  EXPECT_EQ(rift->surface().options().rift_edge, 0.1);
  EXPECT_EQ(rift->surface().options().merge_distance, 0.01);
  EXPECT_EQ(rift->surface().options().seen_through, 0.75);
}

}  // namespace
}  // namespace thalweg::explorer
