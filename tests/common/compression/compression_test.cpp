#include "common/compression/compression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thalweg {
namespace {

using testing::HasSubstr;

// The size is not trusted even below the limit: memory follows what comes out of the decoder.
TEST(Compression, AFalseSizeIsNamed) {
  const std::vector<std::uint8_t> bytes(1000, 7);
  for (const Compression compression : {Compression::kNone, Compression::kLz4, Compression::kZstd}) {
    const std::vector<std::uint8_t> compressed = Compress(compression, bytes);
    const auto whole = Decompress(NameOf(compression), compressed, bytes.size());
    ASSERT_TRUE(whole);
    EXPECT_EQ(*whole, bytes);
    for (const std::uint64_t size : {0ULL, 999ULL, 1001ULL, 1ULL << 27}) {
      const auto wrong = Decompress(NameOf(compression), compressed, size);
      ASSERT_FALSE(wrong) << size;
      EXPECT_THAT(wrong.error(), HasSubstr("its record says " + std::to_string(size)));
    }
  }
  EXPECT_THAT(Decompress("brotli", bytes, 1).error(), HasSubstr("must be zstd, lz4 or none"));
}

TEST(Compression, AStreamOfZerosLargerThanItsChunkMayBeIsNotUnpackedBeyondIt) {
  const std::vector<std::uint8_t> zeros(100 << 20);
  const std::vector<std::uint8_t> bomb = Compress(Compression::kZstd, zeros);
  ASSERT_LT(bomb.size(), 100'000U);
  EXPECT_FALSE(Decompress("zstd", bomb, 1000));
}

}  // namespace
}  // namespace thalweg
