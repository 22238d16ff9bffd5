#include "common/base/nearest_name.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

const std::vector<std::string> kNames = {"closest", "potential", "flow"};

TEST(DidYouMean, ATypingMistakeGetsTheNearestName) {
  EXPECT_EQ(DidYouMean(kNames, "clsest"), "; did you mean closest?") << "left out";
  EXPECT_EQ(DidYouMean(kNames, "potentiall"), "; did you mean potential?") << "too much";
  EXPECT_EQ(DidYouMean(kNames, "flaw"), "; did you mean flow?") << "another letter";
  EXPECT_EQ(DidYouMean(kNames, "flwo"), "; did you mean flow?") << "swapped";
  EXPECT_EQ(DidYouMean(kNames, "lcosets"), "; did you mean closest?") << "swapped twice";
}

TEST(DidYouMean, AnotherWordGetsNothing) {
  EXPECT_EQ(DidYouMean(kNames, "luck"), "");
  EXPECT_EQ(DidYouMean(kNames, ""), "");
  EXPECT_EQ(DidYouMean({}, "flow"), "");
}

}  // namespace
}  // namespace thalweg
