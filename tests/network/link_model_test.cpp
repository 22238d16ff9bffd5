#include "tests/network/link_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace thalweg::network {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""us;
using Fate = LinkModel::Fate;

constexpr std::uint64_t kSeed = 7;
constexpr std::size_t kPacket = 1500;

double Seconds(LinkTime time) {
  return std::chrono::duration<double>(time).count();
}

/// Sends `count` packets, one each `period`, from time 0.
std::vector<LinkModel::Passage> Send(const LinkOptions& options, int count, LinkTime period,
                                     std::uint64_t seed = kSeed) {
  LinkModel link(options, seed);
  std::vector<LinkModel::Passage> passages;
  for (int i = 0; i < count; ++i) passages.push_back(link.Send(i * period, kPacket));
  return passages;
}

int CountOf(const std::vector<LinkModel::Passage>& passages, Fate fate) {
  return static_cast<int>(std::ranges::count(passages, fate, &LinkModel::Passage::fate));
}

TEST(LinkModel, PerfectLinkDeliversEachPacketOnceAndAtOnce) {
  const auto passages = Send({}, 100, 1ms);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(passages[i].fate, Fate::kArrives);
    EXPECT_EQ(passages[i].copies, 1);
    EXPECT_EQ(passages[i].arrival, i * 1ms);
  }
}

// Binomial: the standard deviation of the count is sqrt(n p (1 - p)); four of them are exceeded once in 16
// 000.
TEST(LinkModel, LossHasTheStatedMean) {
  constexpr int kCount = 200'000;
  for (const double p : {0.005, 0.02, 0.2}) {
    const double sigma = std::sqrt(kCount * p * (1.0 - p));
    EXPECT_NEAR(CountOf(Send({.loss = p}, kCount, 1ms), Fate::kLost), kCount * p, 4.0 * sigma) << p;
  }
}

// Where losses are independent, a loss follows a loss as often as it follows an arrival.
TEST(LinkModel, LossesAreIndependent) {
  constexpr int kCount = 200'000;
  constexpr double kLoss = 0.2;
  const auto passages = Send({.loss = kLoss}, kCount, 1ms);
  int both = 0;
  for (int i = 1; i < kCount; ++i) {
    both += passages[i - 1].fate == Fate::kLost && passages[i].fate == Fate::kLost;
  }
  const double expected = kLoss * kLoss;
  EXPECT_NEAR(both, kCount * expected, 4.0 * std::sqrt(kCount * expected * (1.0 - expected)));
}

// Uniform on [d - j, d + j]: mean d, standard deviation j / sqrt(3).
TEST(LinkModel, DelayIsUniformAroundItsMean) {
  constexpr int kCount = 50'000;
  constexpr LinkTime kPeriod = 100ms;  // too far apart to wait for one another
  const auto passages = Send({.delay = 20ms, .jitter = 5ms}, kCount, kPeriod);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double delay = Seconds(passages[i].arrival - i * kPeriod);
    EXPECT_GE(delay, 0.015 - 1e-9);
    EXPECT_LE(delay, 0.025 + 1e-9);
    sum += delay;
    squares += (delay - 0.02) * (delay - 0.02);
  }
  const double sigma = 0.005 / std::sqrt(3.0);
  EXPECT_NEAR(sum / kCount, 0.02, 4.0 * sigma / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(squares / kCount), sigma, 0.02 * sigma);
}

TEST(LinkModel, JitterAloneReordersNothing) {
  const auto passages = Send({.delay = 100ms, .jitter = 30ms}, 10'000, 1ms);
  EXPECT_TRUE(std::ranges::is_sorted(passages, {}, &LinkModel::Passage::arrival));
}

// One packet of 1500 bytes takes 6 ms at 2 Mbit/s; a line that is offered twice as much passes half of it.
TEST(LinkModel, LineDeliversItsRateAndNoMore) {
  constexpr int kCount = 20'000;
  const auto passages = Send({.rate = 2e6, .queue_bytes = 64'000}, kCount, 3ms);
  const int arrived = CountOf(passages, Fate::kArrives);
  EXPECT_EQ(arrived + CountOf(passages, Fate::kQueueFull), kCount);
  const double duration = kCount * 0.003;
  EXPECT_NEAR(arrived * kPacket * 8.0 / duration, 2e6, 0.01 * 2e6);
  LinkTime previous{0};
  for (const auto& passage : passages) {
    if (passage.fate != Fate::kArrives) continue;
    EXPECT_GE(passage.arrival - previous, 6ms);
    previous = passage.arrival;
  }
}

TEST(LinkModel, QueueDelaysByItsLengthAtMost) {
  const auto passages = Send({.rate = 2e6, .queue_bytes = 64'000}, 20'000, 3ms);
  LinkTime longest{0};
  for (int i = 0; i < 20'000; ++i) {
    if (passages[i].fate == Fate::kArrives) longest = std::max(longest, passages[i].arrival - i * 3ms);
  }
  const double limit = 64'000 * 8.0 / 2e6;
  EXPECT_LE(Seconds(longest), limit + 1e-9);
  EXPECT_GT(Seconds(longest), limit - 0.006);  // less than one packet short of it
}

TEST(LinkModel, LineBelowItsRateDropsNothingAndAddsOnlyTheTimeOfSending) {
  const auto passages = Send({.rate = 10e6, .queue_bytes = 64'000}, 1000, 10ms);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(passages[i].arrival, i * 10ms + 1200us);
}

TEST(LinkModel, HeldBackPacketsAreOvertakenByThoseOfTheirDelay) {
  constexpr int kCount = 100'000;
  const auto passages = Send({.reorder = 0.1, .held_back = 10ms}, kCount, 3ms);
  int held = 0;
  for (int i = 0; i < kCount; ++i) {
    const LinkTime late = passages[i].arrival - i * 3ms;
    EXPECT_TRUE(late == 0ms || late == 10ms) << i;
    held += late == 10ms;
  }
  EXPECT_NEAR(held, 0.1 * kCount, 4.0 * std::sqrt(kCount * 0.1 * 0.9));
  EXPECT_EQ(CountOf(passages, Fate::kArrives), kCount);
}

TEST(LinkModel, DuplicatesHaveTheStatedMean) {
  constexpr int kCount = 100'000;
  const auto passages = Send({.duplicate = 0.05}, kCount, 1ms);
  EXPECT_NEAR(std::ranges::count(passages, 2, &LinkModel::Passage::copies), 0.05 * kCount,
              4.0 * std::sqrt(kCount * 0.05 * 0.95));
}

TEST(LinkModel, CutLosesEverythingWithinAndNothingOutside) {
  const auto passages = Send({.cuts = {{.from = 5s, .length = 30s}}}, 100, 1s);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(passages[i].fate, i >= 5 && i < 35 ? Fate::kCut : Fate::kArrives) << i;
  }
}

TEST(LinkModel, FlappingLinkIsUpForItsShareOfEachPeriod) {
  const auto passages = Send({.cuts = {{.from = 1s, .length = 2s, .every = 6s}}}, 601, 100ms);
  EXPECT_EQ(CountOf(passages, Fate::kCut), 10 * 20);  // ten periods in 60 s, two seconds each
  EXPECT_EQ(passages[9].fate, Fate::kArrives);
  EXPECT_EQ(passages[10].fate, Fate::kCut);
  EXPECT_EQ(passages[29].fate, Fate::kCut);
  EXPECT_EQ(passages[30].fate, Fate::kArrives);
  EXPECT_EQ(passages[70].fate, Fate::kCut);
}

TEST(LinkModel, SameSeedGivesTheSameFates) {
  const LinkOptions options{.delay = 20ms, .jitter = 5ms, .loss = 0.1, .duplicate = 0.1};
  const auto one = Send(options, 1000, 1ms);
  const auto same = Send(options, 1000, 1ms);
  const auto other = Send(options, 1000, 1ms, kSeed + 1);
  bool differs = false;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(one[i].fate, same[i].fate);
    EXPECT_EQ(one[i].arrival, same[i].arrival);
    differs = differs || one[i].fate != other[i].fate;
  }
  EXPECT_TRUE(differs);
}

TEST(LinkModel, RefusesWhatNoLinkDoesAndNamesIt) {
  const auto refusal = [](const LinkOptions& options) -> std::string {
    try {
      LinkModel(options, kSeed);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  using testing::HasSubstr;
  EXPECT_EQ(refusal({}), "accepted");
  EXPECT_THAT(refusal({.loss = 1.5}), HasSubstr("loss"));
  EXPECT_THAT(refusal({.loss = std::nan("")}), HasSubstr("loss"));
  EXPECT_THAT(refusal({.duplicate = -0.1}), HasSubstr("duplicate"));
  EXPECT_THAT(refusal({.reorder = 0.1}), HasSubstr("held_back"));
  EXPECT_THAT(refusal({.delay = 5ms, .jitter = 6ms}), HasSubstr("jitter"));
  EXPECT_THAT(refusal({.rate = 1e6}), HasSubstr("queue_bytes"));
  EXPECT_THAT(refusal({.cuts = {{.from = 1s, .length = 0s}}}), HasSubstr("cut"));
  EXPECT_THAT(refusal({.cuts = {{.from = 1s, .length = 3s, .every = 2s}}}), HasSubstr("period"));
}

}  // namespace
}  // namespace thalweg::network
