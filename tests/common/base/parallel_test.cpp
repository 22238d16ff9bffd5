#include "common/base/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace thalweg {
namespace {

TEST(ParallelFor, CallsEachOnce) {
  for (const std::size_t count : {0, 1, 7, 1000}) {
    for (const std::size_t threads : {1, 4}) {
      std::vector<int> calls(count, 0);
      ParallelFor(
          count, 3, [&](std::size_t i) { ++calls[i]; }, threads);
      EXPECT_EQ(calls, std::vector<int>(count, 1));
    }
  }
}

TEST(ParallelFor, ThrowsWhatACallThrowsWhicheverThreadMadeIt) {
  for (const std::size_t bad : {0, 500, 999}) {
    const auto work = [&](std::size_t i) {
      if (i == bad) throw std::runtime_error("call " + std::to_string(i));
    };
    try {
      ParallelFor(1000, 1, work, 4);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), "call " + std::to_string(bad));
    }
  }
}

TEST(ParallelFor, LeavesOutWhatHasNotBegunWhenACallThrows) {
  int calls = 0;
  const auto work = [&](std::size_t i) {
    ++calls;
    if (i == 2) throw std::runtime_error("enough");
  };
  EXPECT_THROW(ParallelFor(1000, 5, work, 1), std::runtime_error);
  EXPECT_EQ(calls, 3);
}

}  // namespace
}  // namespace thalweg
