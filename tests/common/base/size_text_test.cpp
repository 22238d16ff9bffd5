#include "common/base/size_text.h"

#include <gtest/gtest.h>

namespace thalweg {
namespace {

TEST(SizeText, NamesTheWidthFirst) {
  EXPECT_EQ(SizeText(640, 480), "640 x 480");
}

}  // namespace
}  // namespace thalweg
