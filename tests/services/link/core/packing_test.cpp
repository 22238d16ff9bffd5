#include "services/link/core/packing.h"

#include <gtest/gtest.h>

#include <random>

namespace thalweg::link {
namespace {

Buffer RandomBytes(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  Buffer bytes(count);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

TEST(Packing, ReturnsEachMessageByteForByte) {
  for (const std::size_t size : {0U, 1U, 7U, 100U, 5000U, 200'000U}) {
    const Buffer before = RandomBytes(size, 1);
    Buffer message = before;
    if (size > 10) message[size / 2] ^= 0x55U;
    for (const Buffer& dictionary : {Buffer(), before}) {
      const auto unpacked = Unpack(Pack(message, dictionary), dictionary);
      ASSERT_TRUE(unpacked) << unpacked.error();
      EXPECT_EQ(*unpacked, message) << size;
    }
  }
}

TEST(Packing, ARepeatedMessageCostsAlmostNothing) {
  const Buffer path = RandomBytes(3000, 2);
  const Buffer before = path;  // zstd does not look into memory that it packs
  EXPECT_LT(Pack(path, before).size(), 30U);
  // What cannot be packed costs a byte.
  EXPECT_EQ(Pack(path).size(), path.size() + 1);
}

TEST(Packing, RefusesALengthBeyondTheLimitBeforeItReservesMemory) {
  ByteWriter bytes;
  bytes.U8(1);
  bytes.Varint(std::uint64_t{1} << 40U);
  const auto unpacked = Unpack(bytes.bytes());
  ASSERT_FALSE(unpacked);
  EXPECT_NE(unpacked.error().find("at most"), std::string::npos);
}

TEST(Packing, NamesWhatIsWrongWithGarbledBytes) {
  const Buffer good = Pack(Buffer(1000, 7));
  int refused = 0;
  for (std::size_t k = 0; k < good.size(); ++k) {
    for (const unsigned bit : {1U, 0x80U}) {
      Buffer bad = good;
      bad[k] = static_cast<std::uint8_t>(bad[k] ^ bit);
      const auto unpacked = Unpack(bad);
      refused += unpacked ? 0 : 1;
      EXPECT_TRUE(unpacked || !unpacked.error().empty());
    }
    EXPECT_FALSE(Unpack(Bytes(good).first(k))) << k;
  }
  EXPECT_GT(refused, 0);
  EXPECT_FALSE(Unpack({}));
}

}  // namespace
}  // namespace thalweg::link
