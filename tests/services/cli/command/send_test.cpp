// `thalweg send` as typed by a user.
#include <gmock/gmock.h>

#include <string>

#include "common/dds/convert.h"
#include "tests/support/outcome.h"
#include "tests/support/places.h"
#include "tests/support/test_bus.h"
#include "tests/system/processes.h"

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

TEST(Send, ASeekBeyondTheEndOfAReplayIsRefusedHoweverFar) {
  using std::chrono_literals::operator""s;
  const test::OwnPlace place;
  dds::Bus replay(place.BusOptions());
  int commands = 0;
  replay.Subscribe<dds::topics::ReplayCommands>([&](const auto&) { ++commands; });
  const auto publisher = replay.Advertise<dds::topics::ReplayStatus>();
  thalweg_msgs::msg::ReplayStatus status;
  status.header(dds::MakeHeader(Time(), dds::kMapFrame));
  status.begin(dds::ToIdl(Time{1'790'000'000s}));  // a time of today, which leaves less than 1e9 s
  status.end(dds::ToIdl(Time{1'790'000'010s}));
  ASSERT_TRUE(publisher.Write(status));
  for (const char* const seconds : {"11", "1e9"}) {
    const test::Outcome outcome = test::OutcomeOf(test::BinFolder() + "/thalweg send replay seek " + seconds);
    EXPECT_EQ(outcome.exit_code, 1) << seconds;
    EXPECT_THAT(outcome.text, HasSubstr("the replay cannot seek to ")) << seconds;
    EXPECT_THAT(outcome.text, HasSubstr("it ends after 10.000 s")) << seconds;
  }
  replay.SpinUntil([] { return false; }, 0s);
  EXPECT_EQ(commands, 0);
}

}  // namespace
}  // namespace thalweg::cli
