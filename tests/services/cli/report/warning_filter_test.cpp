#include "services/cli/report/warning_filter.h"

#include <gtest/gtest.h>

namespace thalweg::cli {
namespace {

TEST(WarningFilter, EachWarningIsShownOnce) {
  WarningFilter filter;
  EXPECT_TRUE(filter.AdmitReported("mapper rejects depth/points: empty"));
  EXPECT_FALSE(filter.AdmitReported("mapper rejects depth/points: empty"));
  EXPECT_TRUE(filter.AdmitOwn("the disk is full"));
  EXPECT_FALSE(filter.AdmitOwn("the disk is full"));
}

TEST(WarningFilter, WhoCausesANewTextEachTimeDoesNotSilenceOthers) {
  WarningFilter filter;
  std::size_t shown = 0;
  for (int n = 0; n < 1000; ++n) {
    shown += filter.AdmitReported("gateway rejects viewers: no such thing as " + std::to_string(n)) ? 1 : 0;
  }
  EXPECT_EQ(shown, WarningFilter::kMostOfAKind);
  EXPECT_TRUE(filter.AdmitReported("mapper rejects depth/points: empty"));
}

TEST(WarningFilter, WhatThisProcessFindsIsShownWhateverOthersReport) {
  WarningFilter filter;
  std::size_t shown = 0;
  for (int n = 0; n < 1000; ++n) {
    shown += filter.AdmitReported("service " + std::to_string(n) + " rejects: all") ? 1 : 0;
  }
  EXPECT_EQ(shown, WarningFilter::kMost);
  EXPECT_TRUE(filter.AdmitOwn("the disk is full"));
}

}  // namespace
}  // namespace thalweg::cli
