#include "services/cli/report/live_display.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

namespace thalweg::cli {
namespace {

using Style = LiveDisplay::Style;
using Tone = LiveDisplay::Tone;
using testing::HasSubstr;
using testing::Not;

LiveState AState() {
  LiveState state;
  state.time = 83.0;
  state.rate = 5.0;
  state.explored = 12.5;
  state.coverage = 0.75;
  state.frontiers = 7;
  state.left = 130.0;
  state.activity = "going 2 m";
  return state;
}

TEST(LiveDisplay, PlainLinesHaveNeitherColorNorCursorMovements) {
  std::ostringstream out;
  {
    LiveDisplay display(out, Style::kPlain, true);
    display.ShowHeading();
    display.Show(AState());
    display.PrintLine("warning: something", Tone::kWarning);
    display.PrintEvent("end", {{"exit_code", 0}});
  }
  EXPECT_EQ(out.str().find_first_of("\033\r"), std::string::npos);
  EXPECT_THAT(out.str(), HasSubstr("about 2 min left: going 2 m\n"));
  EXPECT_THAT(out.str(), HasSubstr("warning: something\n"));
  EXPECT_THAT(out.str(), Not(HasSubstr("exit_code")));
}

TEST(LiveDisplay, ATerminalIsColoredOnlyWhereColorIsWanted) {
  const auto output = [](bool color) {
    std::ostringstream out;
    LiveDisplay display(out, Style::kTerminal, color);
    display.ShowHeading();
    display.Show(AState());
    display.PrintLine("failed: it", Tone::kError);
    return out.str();
  };
  EXPECT_THAT(output(true), HasSubstr("\033[1;31mfailed: it\033[0m\n"));
  EXPECT_THAT(output(false), HasSubstr("failed: it\n"));
  EXPECT_THAT(output(false), Not(HasSubstr("\033[1;31m")));
  EXPECT_THAT(output(false), HasSubstr("\r\033[K")) << "the live line is rewritten all the same";
}

TEST(LiveDisplay, NoColorIsObeyed) {
  ASSERT_EQ(unsetenv("NO_COLOR"), 0);
  EXPECT_TRUE(LiveDisplay::WantsColor(Style::kTerminal));
  EXPECT_FALSE(LiveDisplay::WantsColor(Style::kPlain));
  ASSERT_EQ(setenv("NO_COLOR", "1", 1), 0);
  EXPECT_FALSE(LiveDisplay::WantsColor(Style::kTerminal));
  unsetenv("NO_COLOR");
}

TEST(LiveDisplay, JsonIsOneObjectALineAndNothingElse) {
  std::ostringstream out;
  LiveState state = AState();
  state.coverage.reset();
  state.activity = "a \"quoted\"\nline \xFF";
  {
    LiveDisplay display(out, Style::kJson, true);
    display.PrintEvent("start", {{"scenario", "kitchen"}});
    display.ShowHeading();
    display.Show(state);
    display.PrintLine("warning: something", Tone::kWarning);
  }
  std::istringstream lines(out.str());
  std::vector<nlohmann::json> objects;
  for (std::string line; std::getline(lines, line);) objects.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[0], nlohmann::json({{"event", "start"}, {"scenario", "kitchen"}}));
  EXPECT_EQ(objects[1]["event"], "progress");
  EXPECT_EQ(objects[1]["t_s"], 83.0);
  EXPECT_EQ(objects[1]["frontiers"], 7);
  EXPECT_EQ(objects[1]["left_s"], 130.0);
  EXPECT_TRUE(objects[1]["coverage"].is_null());
  EXPECT_EQ(objects[2]["level"], "warning");
}

}  // namespace
}  // namespace thalweg::cli
