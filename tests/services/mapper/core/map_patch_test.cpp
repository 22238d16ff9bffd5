#include "services/mapper/core/map_patch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <tuple>

#include "common/compression/compression.h"

namespace thalweg::mapper {
namespace {

using testing::HasSubstr;

std::tuple<int, int, int> Key(const VoxelIndex& voxel) {
  return {voxel.x, voxel.y, voxel.z};
}

/// Voxels in any order, also at the ends of the grid and negative, some of them twice.
MapPatch RandomPatch(std::mt19937& random, int voxels, int values) {
  std::uniform_int_distribution<int> near(-20, 20);
  std::uniform_int_distribution<int> value(0, values - 1);
  std::uniform_int_distribution<int> word(0, 65535);
  std::uniform_int_distribution<int> count(0, VoxelColors::kMaxCount);
  const auto voxel = [&]() -> VoxelIndex {
    if (near(random) == 0) return {kMaxVoxelIndex, -kMaxVoxelIndex - 1, near(random)};
    return {near(random), near(random), near(random)};
  };
  const auto u16 = [&] { return static_cast<std::uint16_t>(word(random)); };
  MapPatch patch;
  for (int n = 0; n < voxels; ++n) {
    patch.voxels.push_back({voxel(), -2.0F + 0.013F * static_cast<float>(value(random))});
    patch.colors.push_back({voxel(), {u16(), u16(), u16(), static_cast<std::uint16_t>(count(random))}});
  }
  return patch;
}

TEST(MapPatch, IsDecodedBitByBit) {
  std::mt19937 random(5);
  for (const auto& [voxels, values] : {std::pair{0, 1}, {1, 1}, {400, 20}, {3000, 1000}, {70'000, 70'000}}) {
    const MapPatch patch = RandomPatch(random, voxels, values);
    std::map<std::tuple<int, int, int>, std::uint32_t> log_odds;
    std::map<std::tuple<int, int, int>, VoxelColors::Mean> colors;
    for (const auto& change : patch.voxels) {
      log_odds[Key(change.voxel)] = std::bit_cast<std::uint32_t>(change.log_odds);
    }
    for (const auto& change : patch.colors) colors[Key(change.voxel)] = change.mean;
    const auto bytes = Encode(patch);
    ASSERT_TRUE(bytes) << bytes.error();
    const Result<MapPatch> back = DecodeMapPatch(*bytes);
    ASSERT_TRUE(back) << back.error();
    EXPECT_EQ(back->voxels.size(), log_odds.size()) << "each voxel once";
    EXPECT_EQ(back->colors.size(), colors.size());
    for (const auto& change : back->voxels) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(change.log_odds), log_odds.at(Key(change.voxel)));
    }
    for (const auto& change : back->colors) ASSERT_EQ(change.mean, colors.at(Key(change.voxel)));
  }
}

TEST(MapPatch, SetsItsValuesAndNoOthers) {
  OccupancyGrid grid(0.1);
  VoxelColors colors;
  grid.Set({1, 2, 3}, 0.5F);
  grid.Set({1, 2, 4}, 0.25F);
  Apply({.voxels = {{{1, 2, 4}, -1.0F}, {{-9, 0, 0}, 2.0F}}, .colors = {{{-9, 0, 0}, {256, 512, 768, 3}}}},
        grid, colors);
  EXPECT_EQ(grid.LogOdds({1, 2, 3}), 0.5F);
  EXPECT_EQ(grid.LogOdds({1, 2, 4}), -1.0F);
  EXPECT_EQ(grid.LogOdds({-9, 0, 0}), 2.0F);
  EXPECT_EQ(grid.State({-9, 0, 1}), VoxelState::kUnknown);
  EXPECT_EQ(colors.At({-9, 0, 0}), (Rgb{1, 2, 3}));
  EXPECT_FALSE(colors.At({1, 2, 4}));
}

/// As Encode does it, for contents that Encode does not make.
std::vector<std::uint8_t> Packed(Bytes content) {
  ByteWriter out;
  out.Varint(content.size());
  out.Append(Compress(Compression::kZstd, content));
  return out.Take();
}

/// One block with the given mask bits in its first byte.
ByteWriter OneBlock(std::uint8_t bits, std::uint64_t folded_x = 0) {
  ByteWriter out;
  out.Varint(1);
  out.Varint(folded_x);
  out.Varint(0);
  out.Varint(0);
  out.U8(bits);
  for (int k = 1; k < 64; ++k) out.U8(0);
  return out;
}

std::string ErrorOfPatch(const ByteWriter& content) {
  const auto patch = DecodeMapPatch(Packed(content.bytes()));
  return patch ? "none" : patch.error();
}

TEST(MapPatch, OfAStrangerIsCheckedFieldByField) {
  for (const auto& [value, error] : {std::pair{std::numeric_limits<float>::infinity(), "infinite"},
                                     {std::numeric_limits<float>::quiet_NaN(), "no number"}}) {
    ByteWriter out = OneBlock(1);
    out.Varint(1);
    out.U32(std::bit_cast<std::uint32_t>(value));
    out.U8(0);
    EXPECT_THAT(ErrorOfPatch(out), HasSubstr(error));
  }
  ByteWriter no_value = OneBlock(1);
  no_value.Varint(1);
  no_value.U32(0);
  no_value.U8(1);
  EXPECT_THAT(ErrorOfPatch(no_value), HasSubstr("without log-odds"));
  EXPECT_THAT(ErrorOfPatch(OneBlock(0, 2 * 4096)), HasSubstr("beyond the grid"));
  EXPECT_THAT(ErrorOfPatch(OneBlock(0, ~0ULL)), HasSubstr("beyond the grid"));
  ByteWriter color;
  color.Varint(0);  // no log-odds
  color.Varint(0);
  color.Append(OneBlock(1).bytes());
  color.U8(VoxelColors::kMaxCount + 1);
  for (int k = 0; k < 6; ++k) color.U8(0);
  EXPECT_THAT(ErrorOfPatch(color), HasSubstr("too many samples"));
  ByteWriter many;
  many.Varint(~0ULL);
  EXPECT_THAT(ErrorOfPatch(many), HasSubstr("ends within a block"));
}

TEST(MapPatch, OfAFewBytesClaimsNoMemory) {
  // Two thousand full blocks are announced, and none of their voxels has a value.
  ByteWriter out;
  out.Varint(2000);
  for (int k = 0; k < 3 * 2000; ++k) out.Varint(0);
  for (int k = 0; k < 64 * 2000; ++k) out.U8(255);
  const std::vector<std::uint8_t> bytes = Packed(out.bytes());
  EXPECT_LT(bytes.size(), 200U);
  EXPECT_THAT(DecodeMapPatch(bytes).error(), HasSubstr("ends within a block"));
  const std::vector<std::uint8_t> zeros(kMostPatchBytes + 1);
  EXPECT_THAT(DecodeMapPatch(Packed(zeros)).error(), HasSubstr("a size that no change has"));
}

TEST(MapPatch, CutAnywhereIsAnError) {
  std::mt19937 random(6);
  const auto bytes = Encode(RandomPatch(random, 50, 10));
  ASSERT_TRUE(bytes);
  for (std::size_t length = 0; length < bytes->size(); ++length) {
    EXPECT_FALSE(DecodeMapPatch(Bytes(*bytes).first(length))) << length;
  }
}

}  // namespace
}  // namespace thalweg::mapper
