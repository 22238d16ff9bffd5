#include <gtest/gtest.h>

#include <iostream>

#include "services/simulator/adapter/load_mesh.h"
#include "tests/services/visual_odometry/support/follow_flight.h"

namespace thalweg::visual_odometry {
namespace {

simulator::World Load(const std::string& scenario) {
  return simulator::LoadWorld(LoadScenario(scenario));
}

struct Round {
  const char* scenario;
  test::Motion motion;
};

class LongRound : public testing::TestWithParam<Round> {};

TEST_P(LongRound, DriftsLessThanHalfAPercentAndKnowsHowMuch) {
  const simulator::World world = Load(GetParam().scenario);
  const test::Outcome outcome = test::Follow(world, test::FlyRounds(world, GetParam().motion, 20.0));
  test::Print(outcome);
  EXPECT_LT(outcome.error.drift_max, 0.005 * outcome.error.path_length);
  EXPECT_EQ(outcome.not_tracking, 0);
  EXPECT_GE(outcome.inside_position, 0.90);
  EXPECT_LE(outcome.inside_position, 0.99);
  EXPECT_GE(outcome.inside_rotation, 0.90);
  EXPECT_LE(outcome.inside_rotation, 0.99);
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, LongRound,
    testing::Values(Round{"kitchen", test::Motion::kSmooth}, Round{"kitchen", test::Motion::kJerky},
                    Round{"flat", test::Motion::kSmooth}, Round{"flat", test::Motion::kJerky},
                    Round{"hall", test::Motion::kSmooth}, Round{"hall", test::Motion::kJerky}),
    [](const testing::TestParamInfo<Round>& round) {
      return std::string(round.param.scenario) +
             (round.param.motion == test::Motion::kJerky ? "Jerky" : "Smooth");
    });

TEST(NearlyBlankWalls, AreSaidToBeDoubtfulBeforeTheErrorExceeds5Percent) {
  const simulator::World world = Load("flat");
  const test::Outcome outcome = test::Follow(world, test::FlyRounds(world, test::Motion::kSmooth, 10.0), 0.2);
  test::Print(outcome);
  std::cout << "worst error before the first doubt: " << 100.0 * outcome.worst_while_tracking << " %\n";
  EXPECT_LT(outcome.worst_while_tracking, 0.05);
  EXPECT_GT(outcome.not_tracking, 0) << "it was too easy to say anything";
}

}  // namespace
}  // namespace thalweg::visual_odometry
