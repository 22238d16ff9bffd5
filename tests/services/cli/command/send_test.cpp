// `thalweg send` as typed by a user.
#include <gmock/gmock.h>

#include <string>

#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

TEST(Send, ANumberThatIsNoPlaceIsRefusedBeforeAnybodyIsAsked) {
  for (const char* const arguments :
       {"goto nan 1 1", "goto 1 inf 1", "goto 1 1 1e300", "goto 1 1 1 --yaw nan", "look-at 1 1 nan",
        "ignore inf 0 0", "no-go 0 0 0 1 1 nan"}) {
    const test::Outcome outcome =
        test::OutcomeOf(test::BinFolder() + "/thalweg send --timeout 5 " + arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_THAT(outcome.text, HasSubstr("is not a number from")) << arguments;
  }
}

}  // namespace
}  // namespace thalweg::cli
