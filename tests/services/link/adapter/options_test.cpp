#include "services/link/adapter/options.h"

#include <gtest/gtest.h>

namespace thalweg::link {
namespace {

TEST(LinkMistakes, ADomainThatIsNotTheLinksOwnIsOne) {
  Scenario scenario;
  const int standard = LinkOptions().domain;
  EXPECT_TRUE(link::MistakesIn(scenario, standard + 1).empty());
  EXPECT_EQ(link::MistakesIn(scenario, standard).size(), 1U);
  scenario.mutable_link()->set_domain(7);
  EXPECT_TRUE(link::MistakesIn(scenario, standard).empty());
  const std::vector<Mistake> mistakes = link::MistakesIn(scenario, 7);
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(ToString(mistakes[0].field), "link.domain");
}

}  // namespace
}  // namespace thalweg::link
