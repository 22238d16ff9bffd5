#include "services/explorer/adapter/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

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
  scenario.mutable_explorer()->set_look_range_m(2.0 * standard);
  EXPECT_EQ(OptionsFrom(scenario).look_range, 2.0 * standard);
}

TEST(MistakesIn, NamesAnUnknownStrategyTheOnesThereAreAndTheNearest) {
  Scenario scenario;
  EXPECT_TRUE(explorer::MistakesIn(scenario).empty());
  for (const StrategyInfo& strategy : Strategies()) {
    scenario.mutable_explorer()->set_strategy(std::string(strategy.name));
    scenario.mutable_robot()->set_drives(strategy.drives_only);
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

}  // namespace
}  // namespace thalweg::explorer
