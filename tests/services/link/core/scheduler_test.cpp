#include "services/link/core/scheduler.h"

#include <gtest/gtest.h>

#include <random>

namespace thalweg::link {
namespace {

using std::chrono_literals::operator""s;

Message MessageOf(std::size_t size, std::uint8_t fill = 1) {
  std::mt19937 random(fill);  // so that packing does not shorten it
  Buffer bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  bytes.at(0) = fill;
  return {.bytes = std::move(bytes)};
}

/// The channels of the pieces in the next frame.
std::vector<std::size_t> NextFrame(Scheduler& scheduler, Priority least = Priority::kBulk,
                                   std::vector<Scheduler::Finished>* finished = nullptr) {
  ByteWriter frame;
  auto done = scheduler.Fill(frame, least, 0s);
  if (finished != nullptr) *finished = std::move(done);
  EXPECT_LE(frame.size(), kFrameBytes);
  std::vector<std::size_t> channels;
  ByteReader in(frame.bytes());
  while (!in.rest().empty()) {
    const auto piece = TakePiece(in);
    EXPECT_TRUE(piece);
    channels.push_back(piece->channel);
  }
  return channels;
}

Scheduler PathPoseAndCloud() {
  return Scheduler({{.name = "cloud", .priority = Priority::kBulk, .packed = false},
                    {.name = "pose", .priority = Priority::kPose, .most_waiting = 10, .packed = false},
                    {.name = "path", .priority = Priority::kCommand, .packed = false}});
}

TEST(Scheduler, APoseNeverWaitsBehindACloudThatHasStarted) {
  Scheduler scheduler = PathPoseAndCloud();
  scheduler.Offer(0, MessageOf(5000));
  EXPECT_EQ(NextFrame(scheduler), std::vector<std::size_t>{0});
  scheduler.Offer(1, MessageOf(100));
  scheduler.Offer(2, MessageOf(50));
  // The most urgent first, and the cloud goes on in the same frame.
  EXPECT_EQ(NextFrame(scheduler), (std::vector<std::size_t>{2, 1, 0}));
}

TEST(Scheduler, OnlyUrgentPiecesGoWhereOnlyTheyAreAllowed) {
  Scheduler scheduler = PathPoseAndCloud();
  scheduler.Offer(0, MessageOf(500));
  scheduler.Offer(1, MessageOf(100));
  EXPECT_EQ(NextFrame(scheduler, Priority::kPose), std::vector<std::size_t>{1});
  EXPECT_TRUE(NextFrame(scheduler, Priority::kPose).empty());
  EXPECT_EQ(NextFrame(scheduler), std::vector<std::size_t>{0});
}

TEST(Scheduler, TheNewestCloudWinsUnlessAnOlderOneHasStarted) {
  Scheduler scheduler = PathPoseAndCloud();
  scheduler.Offer(0, MessageOf(3000, 1));
  NextFrame(scheduler);  // 1 has started
  for (const std::uint8_t fill : {2, 3, 4}) scheduler.Offer(0, MessageOf(3000, fill));
  std::vector<std::uint8_t> arrived;
  for (int frame = 0; frame < 10; ++frame) {
    std::vector<Scheduler::Finished> finished;
    NextFrame(scheduler, Priority::kBulk, &finished);
    for (const auto& done : finished) arrived.push_back(done.message.bytes[0]);
  }
  EXPECT_EQ(arrived, (std::vector<std::uint8_t>{1, 4}));
  EXPECT_EQ(scheduler.counts(0).offered, 4U);
  EXPECT_EQ(scheduler.counts(0).sent, 2U);
  EXPECT_EQ(scheduler.counts(0).dropped, 2U);
}

TEST(Scheduler, AQueueKeepsItsOrderAndDropsTheOldestWhenItIsFull) {
  Scheduler scheduler = PathPoseAndCloud();
  for (int k = 0; k < 15; ++k) scheduler.Offer(1, MessageOf(20, static_cast<std::uint8_t>(k)));
  EXPECT_EQ(scheduler.waiting(1), 10U);
  std::vector<Scheduler::Finished> finished;
  NextFrame(scheduler, Priority::kBulk, &finished);
  ASSERT_EQ(finished.size(), 10U);  // several messages share a frame
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(finished[k].message.bytes[0], k + 5);
}

TEST(Scheduler, ChannelsThatAreEquallyUrgentTakeTurns) {
  Scheduler scheduler({{.name = "a", .packed = false}, {.name = "b", .packed = false}});
  scheduler.Offer(0, MessageOf(20'000));
  scheduler.Offer(1, MessageOf(20'000));
  std::array<int, 2> frames{};
  for (int k = 0; k < 20; ++k) ++frames[NextFrame(scheduler).at(0)];
  EXPECT_EQ(frames[0], 10);
  EXPECT_EQ(frames[1], 10);
}

TEST(Scheduler, ASourceIsAskedOnlyWhenItIsItsTurn) {
  Scheduler scheduler = PathPoseAndCloud();
  int asked = 0;
  scheduler.SetSource(0, [&](Duration) -> std::optional<Message> {
    if (++asked > 2) return std::nullopt;
    return MessageOf(2000);
  });
  scheduler.Offer(1, MessageOf(1150));
  NextFrame(scheduler, Priority::kPose);
  EXPECT_EQ(asked, 0);
  for (int k = 0; k < 10; ++k) NextFrame(scheduler);
  EXPECT_EQ(scheduler.counts(0).sent, 2U);
}

TEST(Scheduler, ANewSessionStartsWhatWasCrossingAgainAndRepeatsTheLastState) {
  Scheduler scheduler(
      {{.name = "cloud", .packed = false},
       {.name = "state", .priority = Priority::kState, .repeats_last = true, .packed = false}});
  scheduler.Offer(1, MessageOf(10, 7));
  NextFrame(scheduler);
  scheduler.Offer(0, MessageOf(3000, 9));
  NextFrame(scheduler);
  scheduler.Restart(1s);
  std::vector<std::size_t> channels;
  std::size_t cloud_bytes = 0;
  for (int k = 0; k < 5; ++k) {
    ByteWriter frame;
    const auto finished = scheduler.Fill(frame, Priority::kBulk, 1s);
    cloud_bytes += frame.size();
    for (const auto& done : finished) channels.push_back(done.channel);
  }
  EXPECT_EQ(channels, (std::vector<std::size_t>{1, 0}));
  EXPECT_GT(cloud_bytes, 3000U);
}

TEST(Scheduler, APrefaceCrossesOnceInASession) {
  Scheduler scheduler({{.name = "cloud", .packed = false}});
  const auto preface = std::make_shared<const Buffer>(1000, std::uint8_t{5});
  const auto bytes_of_next = [&] {
    const std::uint64_t before = scheduler.counts(0).bytes;
    Message message = MessageOf(100);
    message.preface = preface;
    scheduler.Offer(0, std::move(message));
    NextFrame(scheduler);
    NextFrame(scheduler);
    return scheduler.counts(0).bytes - before;
  };
  EXPECT_GT(bytes_of_next(), 1100U);
  EXPECT_LT(bytes_of_next(), 120U);
  scheduler.Restart(0s);
  EXPECT_GT(bytes_of_next(), 1100U);
}

}  // namespace
}  // namespace thalweg::link
