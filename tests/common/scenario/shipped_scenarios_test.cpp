#include "common/scenario/shipped_scenarios.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "common/scenario/scenario.h"

namespace thalweg {
namespace {

TEST(ShippedScenarios, EachHasASentenceThatSaysWhatItIs) {
  const std::vector<ShippedScenario> scenarios = ShippedScenarios();
  EXPECT_GT(scenarios.size(), 15U);
  EXPECT_TRUE(std::ranges::is_sorted(scenarios, {}, &ShippedScenario::name));
  for (const ShippedScenario& scenario : scenarios) {
    EXPECT_GT(scenario.summary.size(), 15U) << scenario.name;
    EXPECT_LT(scenario.summary.size(), 160U) << scenario.name;
    EXPECT_EQ(scenario.summary.find('\n'), std::string::npos) << scenario.name;
  }
}

TEST(ShippedScenarios, AMistypedNameGetsTheNearest) {
  try {
    LoadScenario("kichen");
    FAIL() << "there is no such scenario";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean kitchen?"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace thalweg
