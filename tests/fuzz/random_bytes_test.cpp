#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

// Whatever bytes come, the target ends the process where something it requires does not hold.
TEST(FuzzTarget, TakesRandomBytesOfAnyLength) {
  std::mt19937 random(1);
  for (int input = 0; input < 100; ++input) {
    std::vector<std::uint8_t> bytes(random() % (input < 50 ? 32 : 2048));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(LLVMFuzzerTestOneInput(bytes.data(), bytes.size()), 0);
  }
}

}  // namespace
