#include "common/dds/second_copy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thalweg::dds {
namespace {

thalweg_msgs::msg::ServiceHealth Of(const std::string& service, std::uint64_t instance, double uptime_s) {
  thalweg_msgs::msg::ServiceHealth health;
  health.service(service);
  health.host("rover");
  health.process_id(77);
  health.instance(instance);
  health.uptime_s(uptime_s);
  return health;
}

using std::chrono_literals::operator""s;

/// What `mine` finds after it has been at work for as long as it exists.
std::optional<std::string> Found(const thalweg_msgs::msg::ServiceHealth& mine,
                                 const thalweg_msgs::msg::ServiceHealth& other) {
  return FindSecondCopy(mine, other, FromSeconds(mine.uptime_s()));
}

TEST(SecondCopy, TheYoungerEndsAndNamesTheOlder) {
  EXPECT_EQ(Found(Of("mapper", 1, 2.0), Of("mapper", 2, 100.0)),
            "another mapper runs in this domain already: process 77 on rover");
  EXPECT_FALSE(Found(Of("mapper", 2, 100.0), Of("mapper", 1, 2.0)));
}

TEST(SecondCopy, OfTwoThatStartTogetherExactlyOneEnds) {
  for (const double lag : {-0.4, 0.0, 0.4}) {
    const bool first = Found(Of("mapper", 1, 2.0), Of("mapper", 2, 2.0 + lag)).has_value();
    const bool second = Found(Of("mapper", 2, 2.0), Of("mapper", 1, 2.0 + lag)).has_value();
    EXPECT_NE(first, second) << lag;
  }
}

TEST(SecondCopy, ItselfAndOtherServicesAreNoCopies) {
  EXPECT_FALSE(Found(Of("mapper", 1, 2.0), Of("mapper", 1, 3.0)));
  EXPECT_FALSE(Found(Of("mapper", 1, 2.0), Of("explorer", 2, 100.0)));
}

TEST(SecondCopy, AServiceAtWorkDoesNotEndForAStrangersWord) {
  EXPECT_FALSE(Found(Of("mapper", 1, 10.1), Of("mapper", 2, 1e9)));
  EXPECT_FALSE(Found(Of("mapper", 1, 2.0), Of("mapper", 2, std::nan(""))));
}

TEST(SecondCopy, AServiceThatNeedsLongToStartIsFoundAsWell) {
  EXPECT_TRUE(FindSecondCopy(Of("simulator", 1, 60.0), Of("simulator", 2, 1e3), 1s));
}

TEST(SecondCopy, TheNameOfTheOthersMachineIsSafeToPrint) {
  auto other = Of("mapper", 2, 100.0);
  other.host("rover\x1b[2J");
  EXPECT_EQ(Found(Of("mapper", 1, 2.0), other)->find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace thalweg::dds
