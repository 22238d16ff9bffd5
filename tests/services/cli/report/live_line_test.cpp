#include "services/cli/report/live_line.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace thalweg::cli {
namespace {

TEST(LiveLine, ReportsWhatMattersAndFitsTheTerminal) {
  LiveState state{.time = 83.0,
                  .rate = 4.9,
                  .explored = 61.25,
                  .coverage = 0.5,
                  .frontiers = 12,
                  .distance = 20.5,
                  .collisions = 0,
                  .unheard = {},
                  .stop = "",
                  .trouble = "",
                  .activity = "moving to a frontier",
                  .left = std::nullopt};
  const std::string line = LiveLine(state, 200);
  for (const char* part : {"1:23", "4.9x", "61.2 m3", "50.0 %", " 12 ", "20.5 m", "moving to"}) {
    EXPECT_NE(line.find(part), std::string::npos) << part << " in " << line;
  }
  EXPECT_EQ(line.find("COLLISION"), std::string::npos);
  state.collisions = 2;
  EXPECT_NE(LiveLine(state, 200).find("2 COLLISIONS"), std::string::npos);
  EXPECT_EQ(LiveLine(state, 200).find("silent"), std::string::npos);
  state.silence = 12.0;
  EXPECT_NE(LiveLine(state, 200).find("explorer silent for 12 s: moving"), std::string::npos);
  state.stop = "path silent";
  EXPECT_NE(LiveLine(state, 200).find("robot stopped: path silent; explorer silent for 12 s: moving"),
            std::string::npos);
  EXPECT_EQ(ClockText(3723.0), "1:02:03");
}

TEST(LiveLine, ALineThatIsTooLongEndsWithAWholeWord) {
  LiveState state;
  state.activity = "moving to a frontier, 3.0 m left";
  const std::string whole = LiveLine(state, 99);
  EXPECT_TRUE(whole.ends_with(state.activity));
  EXPECT_EQ(LiveLine(state, whole.size()), whole);
  const std::string ellipsis = "\u2026";
  for (std::size_t columns = whole.size() - state.activity.size(); columns < whole.size(); ++columns) {
    std::string line = LiveLine(state, columns);
    ASSERT_TRUE(line.ends_with(ellipsis)) << line;
    line.resize(line.size() - ellipsis.size());
    EXPECT_LT(line.size(), columns);
    EXPECT_TRUE(whole.starts_with(line)) << line;
    const char next = whole[line.size()];
    EXPECT_TRUE(next == ' ' || next == ',') << line;
  }
}

TEST(LiveLine, ColumnsStandUnderTheirHeading) {
  const LiveState full{.time = 3723.0,
                       .rate = 14.9,
                       .explored = 1061.25,
                       .coverage = 1.0,
                       .frontiers = 1234,
                       .distance = 1020.5,
                       .collisions = 0,
                       .unheard = {},
                       .stop = "",
                       .trouble = "",
                       .activity = "activity",
                       .left = std::nullopt};
  LiveState empty;
  empty.activity = full.activity;
  for (const std::size_t columns : {80U, 200U}) {
    const std::string heading = LiveHeading(columns);
    for (const LiveState& state : {full, empty}) {
      const std::string line = LiveLine(state, columns);
      EXPECT_EQ(line.find("activity"), heading.find("activity")) << line;
      for (const char* column :
           {"time", "speed", "explored", "known", columns < 100 ? "left" : "frontiers", "path"}) {
        const std::size_t end = heading.find(column) + std::string(column).size();
        EXPECT_NE(line[end - 1], ' ') << column << " in " << line;
        EXPECT_EQ(line[end], ' ') << column << " in " << line;
      }
    }
  }
}

TEST(LiveLine, SaysWhatIsMissing) {
  LiveState state;
  state.unheard = {"pose", "controller"};
  EXPECT_TRUE(LiveLine(state, 200).ends_with("  no pose, controller yet"));
  state.trouble = "nobody publishes rt/odometry";
  EXPECT_TRUE(LiveLine(state, 200).ends_with("  no pose, controller yet; nobody publishes rt/odometry"));
  state.trouble = "";
  state.unheard = {"controller"};
  state.activity = "going 3.0 m";
  EXPECT_TRUE(LiveLine(state, 200).ends_with("  no controller: going 3.0 m"));
  EXPECT_NE(LiveLine(state, 79).find("  no controller: going 3.0 m"), std::string::npos) << "80 columns";
}

}  // namespace
}  // namespace thalweg::cli
