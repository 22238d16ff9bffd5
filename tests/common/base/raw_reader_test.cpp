#include "common/base/raw_reader.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "common/base/append_raw.h"

namespace thalweg {
namespace {

TEST(RawReader, GivesWhatAppendRawWroteAndNothingBeyondIt) {
  std::string bytes;
  AppendRaw(bytes, std::uint32_t{7});
  AppendRaw(bytes, -1.5);
  bytes += "abc";
  RawReader reader(bytes);
  std::uint32_t whole = 0;
  double number = 0.0;
  ASSERT_TRUE(reader.Get(whole) && reader.Get(number));
  EXPECT_EQ(whole, 7U);
  EXPECT_EQ(number, -1.5);
  EXPECT_EQ(reader.rest(), "abc");
  EXPECT_FALSE(reader.Get(whole));
  EXPECT_EQ(whole, 7U);
  EXPECT_FALSE(reader.Take(4));
  const auto taken = reader.Take(2);
  ASSERT_TRUE(taken);
  EXPECT_EQ(std::string(taken->begin(), taken->end()), "ab");
  EXPECT_EQ(reader.rest(), "c");
}

}  // namespace
}  // namespace thalweg
