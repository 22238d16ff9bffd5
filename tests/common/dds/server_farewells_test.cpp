#include "common/dds/server_farewells.h"

#include <gtest/gtest.h>

namespace thalweg::dds {
namespace {

using GuidPrefix = ServerFarewells::GuidPrefix;
using std::chrono_literals::operator""ms;

constexpr GuidPrefix kServer = {1};
constexpr GuidPrefix kOtherServer = {2};
constexpr GuidPrefix kPeer = {3};

class ServerFarewellsTest : public testing::Test {
 protected:
  std::size_t Heard(const GuidPrefix& sender, std::chrono::milliseconds at,
                    std::optional<std::size_t> farewell = {}) {
    return farewells_.Heard(sender, 100, farewell, ServerFarewells::SteadyTime{} + at);
  }
  ServerFarewells farewells_{{kServer, kOtherServer}};
};

TEST_F(ServerFarewellsTest, NothingIsHeardOfAServerBehindItsFarewell) {
  EXPECT_EQ(Heard(kServer, 0ms), 100U);
  EXPECT_EQ(Heard(kServer, 10ms, 60), 60U);
  EXPECT_EQ(Heard(kServer, 10ms, 80), 0U) << "the same again";
  EXPECT_EQ(Heard(kServer, 11ms), 0U);
  EXPECT_EQ(Heard(kOtherServer, 11ms), 100U);
}

TEST_F(ServerFarewellsTest, ASuccessorIsHeardAfterTheSilence) {
  EXPECT_EQ(Heard(kServer, 0ms, 60), 60U);
  EXPECT_EQ(Heard(kServer, ServerFarewells::kSilence - 1ms), 0U);
  EXPECT_EQ(Heard(kServer, ServerFarewells::kSilence), 100U);
  EXPECT_EQ(Heard(kServer, 2 * ServerFarewells::kSilence, 60), 60U) << "it ends, too";
}

TEST_F(ServerFarewellsTest, OthersAreHeardToTheEnd) {
  EXPECT_EQ(Heard(kPeer, 0ms, 60), 100U);
  EXPECT_EQ(Heard(kPeer, 0ms), 100U);
}

}  // namespace
}  // namespace thalweg::dds
