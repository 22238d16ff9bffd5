#include "services/stereo/core/kernels.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace thalweg::stereo {
namespace {

template <class T>
std::vector<T> RandomNumbers(std::size_t count, unsigned seed, T below) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<unsigned> any(0, static_cast<unsigned>(below) - 1U);
  std::vector<T> numbers(count);
  for (T& number : numbers) number = static_cast<T>(any(random));
  return numbers;
}

TEST(Kernels, BitsOfTheCensusAreThoseOfTheDefinition) {
  constexpr int kWidth = 45;
  std::vector<std::vector<std::uint8_t>> rows;
  for (unsigned i = 0; i < 7; ++i) rows.push_back(RandomNumbers<std::uint8_t>(kWidth + 8 + kLanes, i, 255));
  const std::uint8_t* pointers[7];
  for (std::size_t i = 0; i < 7; ++i) pointers[i] = rows[i].data() + 4;
  for (const Kernels* kernels : {&BestKernels(), &BaselineKernels()}) {
    std::vector<std::uint64_t> bits(kWidth);
    kernels->census(pointers, kWidth, bits.data());
    for (int c = 0; c < kWidth; ++c) {
      std::uint64_t expected = 0;
      int bit = 0;
      for (int j = 0; j < 7; ++j) {
        for (int i = -4; i <= 4; ++i) {
          if (j == 3 && i == 0) continue;
          if (pointers[j][c + i] < pointers[3][c]) expected |= std::uint64_t{1} << bit;
          ++bit;
        }
      }
      EXPECT_EQ(bits[static_cast<std::size_t>(c)], expected) << c;
    }
  }
}

TEST(Kernels, EveryInstructionSetGivesTheSame) {
  constexpr int kWidth = 53;
  for (int stride = kLanes; stride <= kMaxStride; stride += kLanes) {
    const auto count = static_cast<std::size_t>(kWidth * stride);
    const auto left = RandomNumbers<std::uint8_t>(kWidth, 1, 255);
    const auto right = RandomNumbers<std::uint8_t>(static_cast<std::size_t>(kWidth + stride), 2, 255);
    const auto left_bits = RandomNumbers<std::uint64_t>(kWidth, 3, 1U << 31U);
    const auto right_bits =
        RandomNumbers<std::uint64_t>(static_cast<std::size_t>(kWidth + stride), 4, 1U << 31U);
    const auto jumps = RandomNumbers<std::uint8_t>(kWidth, 5, 60);
    const auto path_count = static_cast<std::size_t>((kWidth + 2) * (stride + 2 * kLanes));
    auto before = RandomNumbers<std::uint8_t>(path_count, 6, 100);
    std::vector<std::vector<std::uint16_t>> sums;
    std::vector<std::vector<std::uint8_t>> costs;
    for (const Kernels* kernels : {&BestKernels(), &BaselineKernels()}) {
      std::vector<std::uint8_t> cost(count);
      kernels->match_cost(left_bits.data(), right_bits.data() + kWidth - 1, left.data(),
                          right.data() + kWidth - 1, kWidth, stride, 3, 20, cost.data());
      std::vector<std::uint16_t> sum(count, 7);
      std::vector<std::uint8_t> here(path_count);
      std::vector<std::uint8_t> along(static_cast<std::size_t>(2 * (stride + 2 * kLanes)), 60);
      const PathRow row{kWidth,
                        stride,
                        1,
                        cost.data(),
                        {jumps.data(), jumps.data(), jumps.data(), jumps.data()},
                        20,
                        {before.data(), before.data(), before.data()},
                        {here.data(), here.data(), here.data()},
                        along.data(),
                        sum.data(),
                        true};
      kernels->aggregate(row);
      costs.push_back(cost);
      sums.push_back(sum);
    }
    EXPECT_EQ(costs[0], costs[1]) << stride;
    EXPECT_EQ(sums[0], sums[1]) << stride;
  }
}

}  // namespace
}  // namespace thalweg::stereo
