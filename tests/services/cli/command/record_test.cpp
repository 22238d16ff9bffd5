// `thalweg record` as typed by a user; `thalweg bag` and `thalweg replay` on what it leaves.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>

#include "common/dds/convert.h"
#include "tests/support/outcome.h"
#include "tests/support/test_bus.h"
#include "tests/system/processes.h"

namespace thalweg::cli {
namespace {

using test::Outcome;
using testing::HasSubstr;

class RecordCommand : public testing::Test {
 protected:
  using Topic = dds::topics::CommandReplies;

  static Outcome Thalweg(const std::string& arguments) {
    return test::OutcomeOf(test::BinFolder() + "/thalweg " + arguments);
  }
  std::string Name(const char* file) const { return (place_.folder() / file).string(); }
  std::string Printed() const {
    std::ostringstream text;
    text << std::ifstream(Name("log.txt")).rdbuf();
    return text.str();
  }

  /// Starts to record and sends the messages, each of which is in the file when this returns.
  void BeginToRecord(const std::vector<std::string>& reasons) {
    recorder_.emplace(
        "thalweg",
        std::vector<std::string>{"record", Topic::kName, "-o", Name("a.mcap"), "--scenario", "tiny"},
        Name("log.txt"));
    ASSERT_TRUE(bus_.SpinUntil([&] { return publisher_.readers() > 0; }, test::kPatience)) << Printed();
    for (const std::string& reason : reasons) {
      const auto before = std::filesystem::file_size(Name("a.mcap"));
      thalweg_msgs::msg::CommandReply message;
      message.reason(reason);
      ASSERT_TRUE(publisher_.Write(message));
      const auto is_written = [&] { return std::filesystem::file_size(Name("a.mcap")) > before; };
      bus_.EveryWall(std::chrono::milliseconds(10), [] {});  // since a file that grows is no event of the bus
      ASSERT_TRUE(bus_.SpinUntil(is_written, test::kPatience)) << Printed();
    }
  }
  /// What a listener hears when a recording is played.
  std::vector<std::string> Played(const char* file) {
    dds::BusOptions options = place_.BusOptions();
    options.name = "listener";
    dds::Bus bus(options);
    std::vector<std::string> heard;
    bus.Subscribe<Topic>([&](const auto& message) { heard.push_back(message.reason()); });
    test::RunningProgram replay(
        "thalweg", {"replay", Name(file), "--topics", Topic::kName, "--rate", "10", "--wait", "60"},
        Name("replay.txt"));
    bus.EveryWall(std::chrono::milliseconds(10), [] {});
    bus.SpinUntil([&] { return replay.ended(); }, test::kPatience);
    EXPECT_EQ(replay.WaitForEnd(Duration(0)), 0);
    return heard;
  }

  test::OwnPlace place_;
  dds::Bus bus_{place_.BusOptions()};
  dds::Bus::Publisher<Topic> publisher_ = bus_.Advertise<Topic>();
  std::optional<test::RunningProgram> recorder_;
};

TEST_F(RecordCommand, WhatIsRecordedUntilCtrlCIsPlayedInOrder) {
  BeginToRecord({"one", "two", "three"});
  recorder_->Kill(SIGINT);
  ASSERT_EQ(recorder_->WaitForEnd(test::kPatience), 0) << Printed();
  EXPECT_THAT(Printed(), HasSubstr("3 messages"));
  const Outcome info = Thalweg("bag info --check " + Name("a.mcap"));
  EXPECT_EQ(info.exit_code, 0) << info.text;
  EXPECT_THAT(info.text, testing::AllOf(HasSubstr(Topic::kName), HasSubstr("name: tiny\n")));
  EXPECT_THAT(Played("a.mcap"), testing::ElementsAre("one", "two", "three"));
}

TEST_F(RecordCommand, ARecorderThatIsKilledLeavesWhatItHasWrittenAndCutRepairsTheFile) {
  BeginToRecord({"one", "two"});
  recorder_->Kill(SIGKILL);
  ASSERT_TRUE(recorder_->WaitForEnd(test::kPatience));
  EXPECT_EQ(Thalweg("bag info " + Name("a.mcap")).exit_code, 1) << "it has no end";
  Thalweg("bag cut " + Name("a.mcap") + " -o " + Name("b.mcap"));
  const Outcome repaired = Thalweg("bag info --check " + Name("b.mcap"));
  EXPECT_EQ(repaired.exit_code, 0) << repaired.text;
  EXPECT_THAT(Played("b.mcap"), testing::ElementsAre("one", "two"));
}

TEST_F(RecordCommand, APartIsSplitByTimeAndItsFilesMergedAgain) {
  BeginToRecord({"one", "two", "three"});
  recorder_->Kill(SIGINT);
  ASSERT_EQ(recorder_->WaitForEnd(test::kPatience), 0) << Printed();
  const Outcome cut = Thalweg("bag cut --split-seconds 0.001 " + Name("a.mcap") + " -o " + Name("part.mcap"));
  EXPECT_EQ(cut.exit_code, 0) << cut.text;
  std::string parts;
  for (const char* const part : {"part_0.mcap", "part_1.mcap", "part_2.mcap"}) {
    const Outcome info = Thalweg("bag info --check " + Name(part));
    EXPECT_THAT(info.text, testing::AllOf(HasSubstr("messages     1\n"), HasSubstr("name: tiny\n"))) << part;
    parts += " " + Name(part);
  }
  const Outcome merge = Thalweg("bag merge" + parts + " -o " + Name("merged.mcap"));
  EXPECT_EQ(merge.exit_code, 0) << merge.text;
  const std::string info = Thalweg("bag info " + Name("merged.mcap")).text;
  EXPECT_EQ(info.find("name: tiny\n"), info.rfind("name: tiny\n")) << "said once: " << info;
  EXPECT_THAT(Played("merged.mcap"), testing::ElementsAre("one", "two", "three"));
}

TEST_F(RecordCommand, AMergeNamesTheFileInWhichSomethingIsDamaged) {
  BeginToRecord({"one", "two"});
  recorder_->Kill(SIGINT);
  ASSERT_EQ(recorder_->WaitForEnd(test::kPatience), 0) << Printed();
  std::filesystem::copy(Name("a.mcap"), Name("cut_off.mcap"));
  std::filesystem::resize_file(Name("cut_off.mcap"), std::filesystem::file_size(Name("a.mcap")) - 20);
  const Outcome merge =
      Thalweg("bag merge " + Name("a.mcap") + " " + Name("cut_off.mcap") + " -o " + Name("merged.mcap"));
  EXPECT_EQ(merge.exit_code, 1) << merge.text;
  EXPECT_THAT(merge.text, HasSubstr("thalweg: " + Name("cut_off.mcap") + ": "));
  EXPECT_THAT(merge.text, testing::Not(HasSubstr("thalweg: " + Name("a.mcap"))));
  EXPECT_THAT(merge.text, HasSubstr("4 messages")) << "what can be read is merged";
}

/// The clock while a recording is played, as a listener hears it.
class ReplayedClock : public RecordCommand {
 protected:
  std::vector<Time> Heard(const std::vector<std::string>& more) {
    dds::BusOptions options = place_.BusOptions();
    options.name = "listener";
    dds::Bus bus(options);
    std::vector<Time> heard;
    bus.Subscribe<dds::topics::Clock>([&](const auto& message) {
      const Result<Time> time = dds::FromIdl(message.clock());
      ASSERT_TRUE(time) << time.error();
      heard.push_back(*time);
    });
    std::vector<std::string> arguments{"replay", Name("a.mcap"), "--topics", Topic::kName};
    arguments.insert(arguments.end(), more.begin(), more.end());
    test::RunningProgram replay("thalweg", arguments, Name("replay.txt"));
    bus.EveryWall(std::chrono::milliseconds(10), [] {});
    bus.SpinUntil([&] { return replay.ended(); }, test::kPatience);
    EXPECT_EQ(replay.WaitForEnd(Duration(0)), 0);
    return heard;
  }
};

TEST_F(ReplayedClock, IsTheRecordingsTimeIfAskedForAndElseThereIsNone) {
  const auto now = [] { return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now()); };
  const Time before = now();
  BeginToRecord({"one", "two"});
  recorder_->Kill(SIGINT);
  ASSERT_EQ(recorder_->WaitForEnd(test::kPatience), 0) << Printed();
  const Time after = now();
  EXPECT_TRUE(Heard({}).empty());
  const std::vector<Time> heard = Heard({"--clock", "--rate", "0.5"});
  ASSERT_FALSE(heard.empty());
  EXPECT_TRUE(std::ranges::is_sorted(heard));
  EXPECT_GE(heard.front(), before);
  EXPECT_LE(heard.back(), after);
}

TEST_F(RecordCommand, AFolderThatDoesNotExistIsNamedAndNotCreated) {
  const std::string file = Name("mistyped") + "/a.mcap";
  const Outcome outcome = Thalweg("record -o " + file);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.text,
            "thalweg: " + file + ": cannot be written: there is no folder " + Name("mistyped") + "\n");
  EXPECT_FALSE(std::filesystem::exists(Name("mistyped")));
}

TEST_F(RecordCommand, ASizeThatNoFileHasIsRefused) {
  for (const char* const option : {"--split-size 1e300", "--split-seconds 1e300", "--keep-free 1e300",
                                   "--split-size nan", "--split-seconds 0", "--keep-free=-1"}) {
    const Outcome outcome = Thalweg(std::string("record -o ") + Name("none.mcap") + " " + option);
    EXPECT_NE(outcome.exit_code, 0) << option;
    const std::string name(option, std::string_view(option).find_first_of(" ="));
    EXPECT_THAT(outcome.text, HasSubstr(name)) << option;
    EXPECT_FALSE(std::filesystem::exists(Name("none.mcap"))) << option;
  }
}

}  // namespace
}  // namespace thalweg::cli
