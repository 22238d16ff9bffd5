#include "services/link/core/reassembly.h"

#include <gtest/gtest.h>

#include <random>

#include "services/link/core/scheduler.h"

namespace thalweg::link {
namespace {

using std::chrono_literals::operator""s;

TEST(Reassembly, GivesBackWhateverTheSchedulerCutsUpInOrderOfEachChannel) {
  std::mt19937 random(4);
  Scheduler scheduler(
      {{.name = "a", .most_waiting = 1000}, {.name = "b", .most_waiting = 1000, .packed = false}});
  Reassembly reassembly({true, false});
  std::array<std::vector<Buffer>, 2> offered;
  std::array<std::vector<Buffer>, 2> arrived;
  for (int k = 0; k < 200; ++k) {
    const std::size_t channel = random() % 2;
    Buffer message(1 + random() % 5000);
    for (std::uint8_t& byte : message) byte = static_cast<std::uint8_t>(random() % 4);
    offered[channel].push_back(message);
    scheduler.Offer(channel, {.bytes = message, .offered = 1s * k});
    ByteWriter frame;
    scheduler.Fill(frame, Priority::kBulk, 0s);
    ByteReader in(frame.bytes());
    while (!in.rest().empty()) {
      const auto piece = TakePiece(in);
      ASSERT_TRUE(piece);
      auto message_in = reassembly.Add(*piece);
      ASSERT_TRUE(message_in) << message_in.error();
      if (*message_in) arrived[piece->channel].push_back((*message_in)->bytes);
    }
  }
  for (const std::size_t channel : {0U, 1U}) {
    ASSERT_GT(arrived[channel].size(), 20U);
    offered[channel].resize(arrived[channel].size());
    EXPECT_EQ(arrived[channel], offered[channel]);
  }
}

TEST(Reassembly, RefusesPiecesThatDoNotFit) {
  const Buffer bytes(10, 1);
  const auto error_of = [&](std::vector<Piece> pieces) {
    Reassembly reassembly({false, false});
    for (std::size_t k = 0; k + 1 < pieces.size(); ++k) EXPECT_TRUE(reassembly.Add(pieces[k]));
    const auto result = reassembly.Add(pieces.back());
    return result ? std::string() : result.error();
  };
  const Piece begin{.channel = 0, .first = true, .last = false, .total = 20, .bytes = bytes};
  EXPECT_NE(error_of({{.channel = 2, .first = true, .last = true, .total = 10, .bytes = bytes}}), "");
  EXPECT_NE(error_of({{.channel = 0, .first = false, .last = true, .total = 0, .bytes = bytes}}), "");
  EXPECT_NE(error_of({begin, begin}), "");
  EXPECT_NE(error_of({{.channel = 0, .first = true, .last = false, .total = 10, .bytes = bytes}}), "");
  EXPECT_NE(error_of({{.channel = 0, .first = true, .last = true, .total = 11, .bytes = bytes}}), "");
  EXPECT_NE(error_of({{.channel = 0, .first = true, .last = true, .total = 0, .bytes = {}}}), "");
  EXPECT_NE(
      error_of(
          {{.channel = 0, .first = true, .last = false, .total = std::size_t{1} << 40U, .bytes = bytes}}),
      "");
  EXPECT_EQ(error_of({begin, {.channel = 0, .first = false, .last = true, .total = 0, .bytes = bytes}}), "");
}

TEST(Reassembly, RandomBytesGiveMessagesOrReasons) {
  std::mt19937 random(9);
  Reassembly reassembly({true, false, true});
  int refused = 0;
  for (int trial = 0; trial < 50'000; ++trial) {
    Buffer bytes(1 + random() % 60);
    for (std::uint8_t& byte : bytes)
      byte = static_cast<std::uint8_t>(random() % 8 == 0 ? random() : random() % 4);
    ByteReader in(bytes);
    const auto piece = TakePiece(in);
    if (!piece) continue;
    if (!reassembly.Add(*piece)) {
      ++refused;
      reassembly.Clear();
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace thalweg::link
