#include "services/explorer/core/strategy/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/explorer/core/strategy/flow.h"
#include "tests/support/recording_visitor.h"

namespace thalweg::explorer {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAreArray;

TEST(Strategies, EachHasANameOfItsOwnAndALineForPeople) {
  std::vector<std::string_view> names;
  for (const StrategyInfo& strategy : Strategies()) {
    EXPECT_EQ(std::ranges::count(names, strategy.name), 0) << strategy.name;
    EXPECT_FALSE(strategy.summary.empty()) << strategy.name;
    EXPECT_LT(strategy.summary.size(), 80U) << strategy.name;
    names.push_back(strategy.name);
  }
  EXPECT_THAT(names, testing::Contains("closest"));
}

TEST(Configure, MakesEveryStrategyAsOftenAsAsked) {
  for (const StrategyInfo& strategy : Strategies()) {
    const ConfiguredStrategy configured = Configure(strategy.name);
    EXPECT_EQ(configured.name, strategy.name);
    const auto first = configured.make();
    const auto second = configured.make();
    ASSERT_TRUE(first && second) << strategy.name;
    EXPECT_NE(first, second) << "each explorer owns its strategy, which may remember";
  }
}

TEST(Configure, RefusesAnUnknownNameWithTheNamesThereAre) {
  try {
    Configure("furthest");
    FAIL() << "was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("furthest"));
    for (const StrategyInfo& strategy : Strategies()) {
      EXPECT_THAT(error.what(), HasSubstr(std::string(strategy.name)));
    }
  }
}

TEST(MisfitOf, RefusesRobotsThatFlyForStrategiesThatAreForOthersOnly) {
  RobotModel robot;
  for (const bool drives : {false, true}) {
    robot.drives = drives;
    EXPECT_EQ(MisfitOf(robot, "gaps").has_value(), !drives);
    EXPECT_FALSE(MisfitOf(robot, "closest"));
    EXPECT_FALSE(MisfitOf(robot, "one of somebody's own"));
  }
}

TEST(MisfitOf, RefusesRobotsThatTurnOnlyInCurvesWhereOneMustGoAnExactPath) {
  const RobotModel robot{.drives = true, .drive = Drive::kAckermann, .min_turning_radius = 0.5};
  ASSERT_TRUE(MisfitOf(robot, "gaps"));
  EXPECT_STREQ(MisfitOf(robot, "gaps")->field, "drive");
  EXPECT_STREQ(MisfitOf(robot, "gaps")->value, "ACKERMANN");
  EXPECT_FALSE(MisfitOf(robot, "cover"));
}

TEST(MisfitOf, RefusesRobotsThatCannotLookUpAndDownWhereOneMust) {
  RobotModel robot;
  EXPECT_FALSE(MisfitOf(robot, "rift"));
  robot.attitude = Attitude::kLevel;
  ASSERT_TRUE(MisfitOf(robot, "rift"));
  EXPECT_STREQ(MisfitOf(robot, "rift")->field, "attitude");
  EXPECT_STREQ(MisfitOf(robot, "rift")->value, "LEVEL");
  robot.attitude = Attitude::kGimbal;
  ASSERT_TRUE(MisfitOf(robot, "rift"));
  EXPECT_STREQ(MisfitOf(robot, "rift")->value, "GIMBAL");
  robot.drives = true;
  ASSERT_TRUE(MisfitOf(robot, "rift"));
  EXPECT_STREQ(MisfitOf(robot, "rift")->field, "drives");
  EXPECT_STREQ(MisfitOf(robot, "rift")->robots, "a robot that flies and can look in any direction");
}

TEST(VisitStrategy, VisitsTheOptionsOfAllStrategiesOnceWhicheverIsChosen) {
  std::vector<std::string> before;
  for (const StrategyInfo& info : Strategies()) {
    ConfiguredStrategy strategy = Configure(info.name);
    thalweg::test::RecordingVisitor visitor;
    Visit(visitor, strategy);
    std::vector<std::string> fields = visitor.fields();
    EXPECT_EQ(strategy.name, info.name);
    std::ranges::sort(fields);
    EXPECT_EQ(std::ranges::adjacent_find(fields), fields.end()) << info.name << " has a field twice";
    EXPECT_THAT(fields, testing::IsSupersetOf({"strategy", "random_seed", "flow.eagerness"}));
    if (!before.empty()) {
      EXPECT_EQ(fields, before) << info.name;
    }
    before = fields;
  }
}

TEST(VisitStrategy, TheStrategyThatTheVisitorNamesGetsTheOptionsItGives) {
  struct Case {
    std::string strategy;
    std::string field;
    double invalid;
    std::string option;
  };
  const std::vector<Case> cases = {
      {"information_gain", "gain.sample_share", 2.0, "sample_share"},
      {"potential_flux", "potential.screening_length_m", -1.0, "screening_length"},
      {"cover", "cover.least_yield_m2_per_m", -1.0, "least_yield"},
  };
  for (const Case& its : cases) {
    ConfiguredStrategy strategy = Configure("closest");
    thalweg::test::RecordingVisitor visitor;
    visitor.Give("strategy", its.strategy);
    visitor.Give(its.field, its.invalid);
    Visit(visitor, strategy);
    EXPECT_EQ(strategy.name, its.strategy);
    try {
      strategy.make();
      FAIL() << "the option did not arrive: " << its.field;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(its.option));
    }
  }
}

TEST(VisitStrategy, PotentialFluxKeepsTheClusterAndThePathThatItsNameStandsFor) {
  for (const char* name : {"potential", "potential_flux"}) {
    ConfiguredStrategy strategy = Configure(name);
    thalweg::test::RecordingVisitor visitor;
    visitor.Give("potential.cluster", std::string("FLUX"));
    Visit(visitor, strategy);
    if (strategy.name == "potential") {
      EXPECT_THROW(strategy.make(), std::invalid_argument) << "no streamline leads to that cluster";
    } else {
      EXPECT_NO_THROW(strategy.make());
    }
  }
}

TEST(VisitStrategy, AnUnknownNameIsRefusedWhenTheStrategyIsMade) {
  ConfiguredStrategy strategy = Configure("closest");
  thalweg::test::RecordingVisitor visitor;
  visitor.Give("strategy", std::string("luck"));
  Visit(visitor, strategy);
  EXPECT_EQ(strategy.name, "luck");
  EXPECT_THROW(strategy.make(), std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
