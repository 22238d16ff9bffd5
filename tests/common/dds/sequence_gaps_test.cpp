#include "common/dds/sequence_gaps.h"

#include <gtest/gtest.h>

namespace thalweg::dds {
namespace {

TEST(SequenceGaps, CountsWhatIsMissingBetweenTwoSamplesOfOneWriter) {
  SequenceGaps<int> gaps;
  EXPECT_EQ(gaps.Missed(1, 40), 0U) << "what came before the first is unknown";
  EXPECT_EQ(gaps.Missed(1, 41), 0U);
  EXPECT_EQ(gaps.Missed(2, 7), 0U) << "another writer has numbers of its own";
  EXPECT_EQ(gaps.Missed(1, 45), 3U);
  EXPECT_EQ(gaps.Missed(2, 9), 1U);
}

TEST(SequenceGaps, ASampleThatComesAgainIsNoGapAndCausesNone) {
  SequenceGaps<int> gaps;
  gaps.Missed(1, 10);
  gaps.Missed(1, 11);
  EXPECT_EQ(gaps.Missed(1, 11), 0U);
  EXPECT_EQ(gaps.Missed(1, 9), 0U);
  EXPECT_EQ(gaps.Missed(1, 12), 0U);
}

TEST(SequenceGaps, ForgetsTheWriterHeardLongestAgo) {
  using Gaps = SequenceGaps<std::size_t>;
  Gaps gaps;
  for (std::size_t writer = 0; writer < Gaps::kRemembered; ++writer) gaps.Missed(writer, 1);
  gaps.Missed(0, 2);  // so that writer 1 is the one heard longest ago
  gaps.Missed(Gaps::kRemembered, 1);
  EXPECT_EQ(gaps.Missed(0, 4), 1U);
  EXPECT_EQ(gaps.Missed(1, 4), 0U) << "forgotten";
}

}  // namespace
}  // namespace thalweg::dds
