// `thalweg replay` as typed by a user; what it plays is in record_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::cli {
namespace {

using test::Outcome;
using testing::HasSubstr;

Outcome Replay(const std::string& arguments) {
  return test::OutcomeOf(test::BinFolder() + "/thalweg replay " + arguments);
}

TEST(ReplayCommand, APauseThatNobodyCouldEndIsRefused) {
  const Outcome outcome = Replay("--pause none.mcap");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, HasSubstr("standard input is no terminal"));
}

TEST(ReplayCommand, MistakesAreNamed) {
  EXPECT_THAT(Replay("none.mcap").text, HasSubstr("none.mcap"));
  for (const char* const pair : {"odometry", ":=b", "a:="}) {
    const Outcome outcome = Replay(std::string("none.mcap --remap ") + pair);
    EXPECT_EQ(outcome.exit_code, 1) << pair;
    EXPECT_THAT(outcome.text, HasSubstr(std::string("--remap ") + pair + ": must be RECORDED:=PLAYED"));
  }
}

}  // namespace
}  // namespace thalweg::cli
