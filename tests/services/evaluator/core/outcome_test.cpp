#include "services/evaluator/core/outcome.h"

#include <gtest/gtest.h>

namespace thalweg::evaluator {
namespace {

TEST(CoverageAt, IsThatOfTheLastPointReached) {
  Outcome outcome;
  EXPECT_EQ(CoverageAt(outcome, &Outcome::Progress::time, 1.0), 0.0);
  outcome.progress = {{.time = 1.0, .distance = 0.5, .coverage = 0.2},
                      {.time = 2.0, .distance = 0.5, .coverage = 0.3},
                      {.time = 4.0, .distance = 3.0, .coverage = 0.9}};
  EXPECT_EQ(CoverageAt(outcome, &Outcome::Progress::time, 0.9), 0.0);
  EXPECT_EQ(CoverageAt(outcome, &Outcome::Progress::time, 1.0), 0.2);
  EXPECT_EQ(CoverageAt(outcome, &Outcome::Progress::time, 9.0), 0.9);
  EXPECT_EQ(CoverageAt(outcome, &Outcome::Progress::distance, 0.5), 0.3);
}

}  // namespace
}  // namespace thalweg::evaluator
