#include "services/link/core/endpoint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <map>

namespace thalweg::link {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

enum Channel : std::size_t { kCloud, kPose, kPath, kLog, kStatus, kChannels };

std::vector<ChannelPolicy> Policies() {
  return {{.name = "cloud", .repeats_unacknowledged = true, .kept = true, .packed = false},
          {.name = "pose",
           .priority = Priority::kPose,
           .most_waiting = 50,
           .repeats_unacknowledged = true,
           .kept = true},
          {.name = "path", .priority = Priority::kCommand},
          {.name = "log", .priority = Priority::kCommand, .most_waiting = 50, .repeats_unacknowledged = true},
          {.name = "status", .priority = Priority::kState, .repeats_last = true}};
}

/// Two ends with a line between them: a rate, a delay, and cuts. As under DDS, frames are neither lost nor
/// reordered while both ends see each other; a cut delays them.
class Pair {
 public:
  explicit Pair(Endpoint::Options options = {})
      : ends_{End(Named(options, 1000)), End(Named(options, 2000))} {
    for (End& end : ends_) end.endpoint.SetWanted((1U << kChannels) - 1);
  }

  Endpoint& robot() { return ends_[0].endpoint; }
  Endpoint& base() { return ends_[1].endpoint; }
  /// Messages that have arrived at the base, by channel.
  std::map<std::size_t, std::vector<Endpoint::Received>>& at_base() { return ends_[1].arrived; }
  std::vector<std::string>& errors() { return errors_; }

  double bytes_per_s = 1e9;
  Duration delay = 5ms;
  bool cut = false;
  bool matched = true;
  Duration base_ahead{0};  ///< The base's system clock.
  Duration now = 100s;
  std::size_t bytes_to_base = 0;

  void Run(Duration duration, const std::function<void()>& each_10ms = {}) {
    for (const Duration end = now + duration; now < end; now += 1ms) {
      if (each_10ms && (now.count() / 1'000'000) % 10 == 0) each_10ms();
      for (std::size_t side = 0; side < 2; ++side) Step(side);
    }
  }

  /// The base station's process is restarted.
  void RestartBase() {
    ends_[1] = End(Named({}, 9000));
    ends_[1].endpoint.SetWanted((1U << kChannels) - 1);
  }

 private:
  struct End {
    explicit End(const Endpoint::Options& options) : endpoint(options, Policies()) {}
    Endpoint endpoint;
    std::deque<std::pair<Duration, Frame>> coming;  ///< Each with the time when it arrives.
    Duration line_free{0};
    std::map<std::size_t, std::vector<Endpoint::Received>> arrived;
  };

  static Endpoint::Options Named(Endpoint::Options options, std::uint64_t session) {
    options.session = session;
    return options;
  }
  Moment MomentAt(std::size_t side) const {
    return {now + (side == 1 ? 7000s : 0s), now + (side == 1 ? base_ahead : 0s)};
  }

  void Step(std::size_t side) {
    End& end = ends_[side];
    End& other = ends_[1 - side];
    end.endpoint.SetMatched(matched, MomentAt(side));
    for (int burst = 0; burst < 50; ++burst) {
      auto frame = end.endpoint.NextFrame(MomentAt(side));
      if (!frame) break;
      if (side == 0) bytes_to_base += frame->payload.size();
      end.line_free = std::max(end.line_free, now) +
                      FromSeconds(static_cast<double>(frame->payload.size() + 130) / bytes_per_s);
      other.coming.emplace_back(end.line_free + delay, *std::move(frame));
    }
    if (!matched) end.coming.clear();  // each end forgets what it had for the other
    if (cut) {
      for (auto& [at, frame] : end.coming) at = std::max(at, now + 20ms);
    }
    for (; !end.coming.empty() && end.coming.front().first <= now; end.coming.pop_front()) {
      Endpoint::Taken taken = end.endpoint.Take(end.coming.front().second, MomentAt(side));
      if (taken.error) errors_.push_back(*taken.error);
      for (auto& message : taken.messages) end.arrived[message.channel].push_back(std::move(message));
    }
  }

  std::array<End, 2> ends_;
  std::vector<std::string> errors_;
};

Message Numbered(std::uint32_t number, std::size_t size, Duration now) {
  Buffer bytes(size, static_cast<std::uint8_t>(number));
  for (std::size_t k = 0; k < bytes.size(); ++k)
    bytes[k] = static_cast<std::uint8_t>(k * 37 + number * 11 + k * k / 7);
  for (std::size_t k = 0; k < 4; ++k) bytes[k] = static_cast<std::uint8_t>(number >> (8 * k));
  return {.bytes = std::move(bytes), .offered = now};
}

std::uint32_t NumberOf(const Endpoint::Received& received) {
  ByteReader in(received.message.bytes);
  return in.U32();
}

std::vector<std::uint32_t> NumbersOf(const std::vector<Endpoint::Received>& messages) {
  std::vector<std::uint32_t> numbers;
  for (const auto& message : messages) numbers.push_back(NumberOf(message));
  return numbers;
}

std::vector<std::uint32_t> UpTo(std::uint32_t count) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t k = 0; k < count; ++k) numbers.push_back(k);
  return numbers;
}

TEST(Endpoint, CarriesWhatIsReadOnTheOtherSideAndNothingElse) {
  Pair pair;
  pair.base().SetWanted(1U << kPath);
  pair.Run(1s);
  EXPECT_TRUE(pair.robot().up(pair.now));
  EXPECT_TRUE(pair.robot().PeerWants(kPath));
  EXPECT_FALSE(pair.robot().PeerWants(kCloud));
  const std::size_t before = pair.bytes_to_base;
  pair.robot().Offer(kPath, Numbered(1, 100, pair.now));
  pair.robot().Offer(kCloud, Numbered(1, 100'000, pair.now));
  pair.Run(1s);
  EXPECT_EQ(pair.at_base()[kPath].size(), 1U);
  EXPECT_TRUE(pair.at_base()[kCloud].empty());
  EXPECT_LT(pair.bytes_to_base - before, 2000U);
}

TEST(Endpoint, APoseIsFreshWhileCloudsFillTheLine) {
  Pair pair;
  pair.bytes_per_s = 62'500;  // 0.5 Mbit/s
  pair.Run(1s);
  std::uint32_t clouds = 0;
  std::uint32_t poses = 0;
  pair.Run(30s, [&] {
    if (poses % 2 == 0) pair.robot().Offer(kCloud, Numbered(clouds++, 4000, pair.now));  // 200 kB/s
    if (poses++ % 5 == 0) pair.robot().Offer(kPose, Numbered(poses, 100, pair.now));
  });
  pair.Run(1s);
  const auto& received = pair.at_base();
  EXPECT_EQ(received.at(kPose).size(), 600U);
  Duration worst{0};
  for (const auto& pose : received.at(kPose)) {
    ASSERT_TRUE(pose.age);
    worst = std::max(worst, *pose.age);
  }
  EXPECT_LT(Seconds(worst), 0.4);
  // The rest of the line carries clouds, of which the newest were chosen.
  EXPECT_GT(received.at(kCloud).size(), 200U);
  const auto& counts = pair.robot().scheduler().counts(kCloud);
  EXPECT_EQ(counts.offered, counts.sent + counts.dropped);
  EXPECT_TRUE(std::ranges::is_sorted(NumbersOf(received.at(kCloud))));
}

TEST(Endpoint, AfterACutCloudsAndTheirPosesArriveLateInOrderAndComplete) {
  Pair pair;
  pair.Run(1s);
  std::uint32_t ticks = 0;
  const auto offer = [&] {
    if (ticks % 20 == 0) pair.robot().Offer(kCloud, Numbered(ticks, 4000, pair.now));
    if (ticks % 5 == 0) pair.robot().Offer(kPose, Numbered(ticks, 100, pair.now));
    ++ticks;
  };
  pair.Run(2s, offer);
  pair.cut = true;
  pair.Run(30s, offer);
  EXPECT_FALSE(pair.robot().up(pair.now));
  pair.cut = false;
  pair.Run(5s, offer);
  pair.Run(2s);
  EXPECT_TRUE(pair.robot().up(pair.now));
  const auto& received = pair.at_base();
  std::vector<std::uint32_t> all_poses;
  for (std::uint32_t tick = 0; tick < ticks; tick += 5) all_poses.push_back(tick);
  EXPECT_EQ(NumbersOf(received.at(kPose)), all_poses);
  // Clouds of the two seconds until the cut was noticed replace each other; all later ones arrive.
  const std::vector<std::uint32_t> clouds = NumbersOf(received.at(kCloud));
  EXPECT_TRUE(std::ranges::is_sorted(clouds));
  EXPECT_GE(clouds.size() + 12, std::size_t{ticks / 20});
  EXPECT_EQ(pair.robot().status().kept, 0U);
}

TEST(Endpoint, KeepsNoMoreThanItMayAndCountsTheRest) {
  Endpoint::Options options;
  options.keep_bytes = 100'000;
  Pair pair(options);
  pair.Run(1s);
  pair.cut = true;
  std::uint32_t number = 0;
  pair.Run(10s, [&] {
    pair.robot().Offer(kCloud, Numbered(number++, 4000, pair.now));
    EXPECT_LE(pair.robot().status().kept_bytes, options.keep_bytes);
  });
  const std::uint64_t dropped = pair.robot().dropped_kept(kCloud);
  EXPECT_GT(dropped, 500U);
  pair.cut = false;
  pair.Run(5s);
  EXPECT_EQ(NumberOf(pair.at_base()[kCloud].back()), number - 1);
}

TEST(Endpoint, APathThatWaitedForALongCutIsOldAndTheReceiverKnows) {
  Pair pair;
  pair.Run(1s);
  pair.robot().Offer(kPath, Numbered(1, 100, pair.now));
  pair.Run(200ms);
  pair.cut = true;
  pair.Run(20ms);
  pair.robot().Offer(kPath, Numbered(2, 100, pair.now));
  pair.Run(10s);
  pair.cut = false;
  pair.Run(1s);
  const auto& paths = pair.at_base()[kPath];
  ASSERT_EQ(paths.size(), 2U);
  EXPECT_LT(Seconds(*paths[0].age), 0.1);
  EXPECT_NEAR(Seconds(*paths[1].age), 10.0, 0.5);
}

TEST(Endpoint, WhenTheSidesFindEachOtherAgainLogsAreCompleteAndTheLastStateIsRepeated) {
  Pair pair;
  pair.Run(1s);
  pair.robot().Offer(kStatus, Numbered(77, 200, pair.now));
  std::uint32_t number = 0;
  const auto offer = [&] {
    if (number < 40) pair.robot().Offer(kLog, Numbered(number++, 50, pair.now));
  };
  pair.Run(200ms, offer);
  pair.cut = true;
  pair.Run(100ms, offer);
  pair.matched = false;  // what was under way is lost
  pair.Run(5s, offer);
  pair.cut = false;
  pair.matched = true;
  pair.Run(3s, offer);
  // What had arrived, but whose acknowledgment had not, arrives twice.
  std::vector<std::uint32_t> numbers = NumbersOf(pair.at_base()[kLog]);
  EXPECT_LT(numbers.size(), 45U);
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  EXPECT_EQ(numbers, UpTo(40));
  ASSERT_GE(pair.at_base()[kStatus].size(), 2U);
  EXPECT_EQ(NumberOf(pair.at_base()[kStatus].back()), 77U);
}

TEST(Endpoint, ASideThatIsRestartedAsksForANewSession) {
  Pair pair;
  pair.Run(1s);
  pair.robot().Offer(kPose, Numbered(1, 100, pair.now));
  pair.Run(1s);
  pair.RestartBase();  // at once, so that the robot's side notices nothing
  pair.Run(3s);
  EXPECT_FALSE(pair.errors().empty());
  std::uint32_t number = 0;
  pair.Run(1s, [&] { pair.robot().Offer(kPose, Numbered(number++, 100, pair.now)); });
  pair.Run(1s);
  EXPECT_EQ(NumbersOf(pair.at_base()[kPose]), UpTo(number));
}

TEST(Endpoint, KnowsHowFarTheClocksAreApartWithinHalfOfTheRoundTrip) {
  Pair pair;
  pair.delay = 30ms;
  pair.base_ahead = 1234ms;
  pair.Run(3s);
  const auto robot = pair.robot().status();
  ASSERT_TRUE(robot.clock_offset);
  EXPECT_NEAR(Seconds(*robot.clock_offset), 1.234, Seconds(robot.clock_delay) / 2.0);
  EXPECT_NEAR(Seconds(*pair.base().status().clock_offset), -1.234, 0.04);
}

TEST(Endpoint, RefusesASideWithOtherTopics) {
  Endpoint robot({.session = 1, .topics = 5}, Policies());
  ByteWriter payload;
  Report report;
  report.topics = 6;
  report.wanted = ~std::uint64_t{0};
  Put(payload, report);
  const auto taken = robot.Take({7, 1, payload.Take()}, {1s, 1s});
  ASSERT_TRUE(taken.error);
  EXPECT_NE(taken.error->find("other topics"), std::string::npos);
  EXPECT_EQ(robot.peer_wants(), 0U);
}

TEST(Endpoint, FramesOutOfOrderOrTooLongAreRefusedAndASessionBegunAgainIsFollowed) {
  Endpoint end({}, Policies());
  const Moment now{1s, 1s};
  EXPECT_TRUE(end.Take({5, 2, {1, 2, 3}}, now).error);
  EXPECT_FALSE(end.Take({5, 3, {1, 2, 3}}, now).error);  // nothing of this session counts any longer
  EXPECT_TRUE(end.Take({6, 1, Buffer(kFrameBytes + 1)}, now).error);
  EXPECT_TRUE(end.Take({7, 1, {0}}, now).error);
  ByteWriter payload;
  Put(payload, Report{});
  const auto taken = end.Take({8, 1, payload.Take()}, now);
  EXPECT_FALSE(taken.error) << *taken.error;
  EXPECT_TRUE(taken.new_session);
}

}  // namespace
}  // namespace thalweg::link
