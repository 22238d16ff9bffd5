#include "common/dds/sole_writer.h"

#include <gtest/gtest.h>

#include <set>

namespace thalweg::dds {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

using Verdict = SoleWriter<int>::Verdict;

class SoleWriterTest : public testing::Test {
 protected:
  /// A sample of `writer`, read after the reader has watched the topic until `at`.
  Verdict Hear(SoleWriter<int>& reader, int writer, Duration at) {
    for (; seen_ < at; seen_ = std::min(seen_ + 100ms, at)) Look(reader, seen_);
    Look(reader, at);
    return Take(reader, writer);
  }
  Verdict Take(SoleWriter<int>& reader, int writer) {
    return reader.Judge(writer, [&](int id) { return matched_.contains(id); });
  }
  static void Look(SoleWriter<int>& reader, Duration at) {
    reader.SawNothing(SoleWriter<int>::SteadyTime{} + at);
  }

  SoleWriter<int> state_{1s, false};
  SoleWriter<int> command_{500ms, true};
  Duration seen_{};
  std::set<int> matched_ = {1, 2, 3};
};

TEST_F(SoleWriterTest, TheFirstIsFollowedAndASecondRefused) {
  EXPECT_EQ(Hear(state_, 1, 0ms), Verdict::kFollow);
  EXPECT_EQ(Hear(state_, 2, 100ms), Verdict::kRefuse);
  EXPECT_EQ(state_.rival(), 1);
  EXPECT_EQ(Hear(state_, 1, 900ms), Verdict::kFollow);
  EXPECT_EQ(Hear(state_, 2, 1900ms), Verdict::kRefuse) << "silent for no more than 1 s";
}

TEST_F(SoleWriterTest, AnotherTakesOverWhenTheFirstIsSilentUntilItSpeaksAgain) {
  EXPECT_EQ(Hear(state_, 1, 0ms), Verdict::kFollow);
  EXPECT_EQ(Hear(state_, 2, 1001ms), Verdict::kFollow);
  EXPECT_EQ(Hear(state_, 2, 1050ms), Verdict::kFollow);
  EXPECT_EQ(Hear(state_, 1, 1100ms), Verdict::kFollow) << "it was there first";
  EXPECT_EQ(Hear(state_, 2, 1150ms), Verdict::kRefuse);
}

TEST_F(SoleWriterTest, AnotherTakesOverAtOnceWhenTheFirstIsGone) {
  EXPECT_EQ(Hear(state_, 1, 0ms), Verdict::kFollow);
  matched_.erase(1);
  EXPECT_EQ(Hear(state_, 2, 1ms), Verdict::kFollow);
}

TEST_F(SoleWriterTest, AStallOfTheReaderIsNotTheWritersSilence) {
  EXPECT_EQ(Hear(command_, 1, 0ms), Verdict::kFollow);
  EXPECT_EQ(Hear(command_, 1, 4s), Verdict::kFollow);
  // The process stands for 5 s; then a sample of the other is the first of those that waited.
  Look(command_, 9s);
  EXPECT_EQ(Take(command_, 2), Verdict::kRefuse);
  EXPECT_EQ(Take(command_, 1), Verdict::kFollow);
}

TEST_F(SoleWriterTest, OfTwoStrangersNobodyCommandsWhileBothSpeak) {
  EXPECT_EQ(Hear(command_, 1, 0ms), Verdict::kFollow) << "alone so far";
  for (Duration at = 100ms; at < 10s; at += 200ms) {
    EXPECT_EQ(Hear(command_, 2, at), Verdict::kContested);
    EXPECT_EQ(Hear(command_, 1, at + 100ms), Verdict::kContested);
  }
  EXPECT_EQ(Hear(command_, 2, 11s), Verdict::kFollow) << "the other has been silent for half a second";
}

TEST_F(SoleWriterTest, ACommanderThatWasHeardAloneKeepsTheTopic) {
  for (Duration at{}; at <= 3s; at += 100ms) EXPECT_EQ(Hear(command_, 1, at), Verdict::kFollow);
  EXPECT_EQ(Hear(command_, 2, 3050ms), Verdict::kRefuse);
  EXPECT_EQ(Hear(command_, 1, 3100ms), Verdict::kFollow);
  // It pauses, and another comes who is then heard alone, too.
  for (Duration at = 4s; at <= 8s; at += 100ms) EXPECT_EQ(Hear(command_, 2, at), Verdict::kFollow);
  EXPECT_EQ(Hear(command_, 1, 8050ms), Verdict::kFollow) << "the first of the two again";
  EXPECT_EQ(Hear(command_, 2, 8100ms), Verdict::kRefuse);
}

TEST_F(SoleWriterTest, OneThatIsKnownGoesBeforeOneThatWasOnlyFirst) {
  EXPECT_EQ(Hear(command_, 1, 0ms), Verdict::kFollow);
  for (Duration at = 1s; at <= 5s; at += 100ms) EXPECT_EQ(Hear(command_, 2, at), Verdict::kFollow);
  EXPECT_EQ(Hear(command_, 1, 5050ms), Verdict::kRefuse);
  EXPECT_EQ(Hear(command_, 2, 5100ms), Verdict::kFollow);
}

TEST_F(SoleWriterTest, AServiceThatIsRestartedEarlyIsFollowedAfterTheSilence) {
  EXPECT_EQ(Hear(command_, 1, 0ms), Verdict::kFollow);
  EXPECT_EQ(Hear(command_, 1, 1000ms), Verdict::kFollow);  // and is killed, which nobody notices for 10 s
  EXPECT_EQ(Hear(command_, 2, 1200ms), Verdict::kContested);
  EXPECT_EQ(Hear(command_, 2, 1501ms), Verdict::kFollow);
}

}  // namespace
}  // namespace thalweg::dds
