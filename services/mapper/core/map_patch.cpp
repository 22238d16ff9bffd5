#include "services/mapper/core/map_patch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "common/base/check.h"
#include "common/base/zig_zag.h"
#include "common/compression/compression.h"

namespace thalweg::mapper {
namespace {

constexpr std::size_t kBlockVoxels = OccupancyGrid::kBlockVoxels;
constexpr std::size_t kMaskBytes = kBlockVoxels / 8;
constexpr std::int32_t kMostBlockIndex = kMaxVoxelIndex >> OccupancyGrid::kBlockBits;
using Mask = std::array<std::uint8_t, kMaskBytes>;

bool Has(const Mask& mask, std::size_t k) {
  return ((mask[k / 8] >> (k % 8)) & 1U) != 0;
}

/// The blocks that values lie in, which voxels of them have one, and these values in the order of the bits.
template <class Value>
struct Cells {
  std::vector<VoxelIndex> blocks;
  std::vector<Mask> masks;
  std::vector<Value> values;
};

/// @param value_of  Takes an item, whose member `voxel` says where it lies.
template <class Item, class ValueOf>
auto Grouped(const std::vector<Item>& items, ValueOf&& value_of) {
  using Value = std::remove_cvref_t<std::invoke_result_t<ValueOf&, const Item&>>;
  Cells<Value> cells;
  std::vector<std::array<Value, kBlockVoxels>> contents;
  std::unordered_map<VoxelIndex, std::size_t, VoxelIndexHash> places;
  std::size_t place = 0;
  for (const Item& item : items) {
    const VoxelIndex block = OccupancyGrid::BlockOf(item.voxel);
    if (cells.blocks.empty() || cells.blocks[place] != block) {
      const auto [entry, is_new] = places.try_emplace(block, cells.blocks.size());
      place = entry->second;
      if (is_new) {
        cells.blocks.push_back(block);
        cells.masks.push_back({});
        contents.emplace_back();
      }
    }
    const std::size_t k = OccupancyGrid::OffsetInBlock(item.voxel);
    std::uint8_t& bits = cells.masks[place][k / 8];
    bits = static_cast<std::uint8_t>(bits | (1U << (k % 8)));
    contents[place][k] = value_of(item);
  }
  cells.values.reserve(items.size());
  for (std::size_t n = 0; n < contents.size(); ++n) {
    for (std::size_t k = 0; k < kBlockVoxels; ++k) {
      if (Has(cells.masks[n], k)) cells.values.push_back(contents[n][k]);
    }
  }
  return cells;
}

template <class Value>
void PutPlaces(ByteWriter& out, const Cells<Value>& cells) {
  out.Varint(cells.blocks.size());
  VoxelIndex last;
  for (const VoxelIndex& block : cells.blocks) {
    const VoxelIndex step = block - last;
    for (const std::int32_t along : {step.x, step.y, step.z}) out.Varint(ZigZag(along));
    last = block;
  }
  for (const Mask& mask : cells.masks) out.Append(mask);
}

/// Takes what PutPlaces puts, and returns the voxels in order.
Result<std::vector<VoxelIndex>> TakePlaces(ByteReader& in) {
  const std::uint64_t count = in.Varint();
  if (!in.good() || count > in.rest().size() / kMaskBytes) return Error{"ends within a block"};
  std::vector<VoxelIndex> blocks;
  std::array<std::int64_t, 3> at{};
  for (std::uint64_t n = 0; n < count; ++n) {
    for (std::int64_t& along : at) {
      const std::int64_t step = FromZigZag(in.Varint());
      if (step < -2 * kMostBlockIndex - 1 || step > 2 * kMostBlockIndex + 1 ||
          along + step < -kMostBlockIndex - 1 || along + step > kMostBlockIndex) {
        return Error{"has a block beyond the grid"};
      }
      along += step;
    }
    blocks.push_back({static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1]),
                      static_cast<std::int32_t>(at[2])});
  }
  std::vector<VoxelIndex> voxels;
  for (const VoxelIndex& block : blocks) {
    const Bytes bits = in.Take(kMaskBytes);
    if (!in.good()) return Error{"ends within a block"};
    for (std::size_t k = 0; k < kBlockVoxels; ++k) {
      if (((bits[k / 8] >> (k % 8)) & 1U) != 0) voxels.push_back(OccupancyGrid::IndexInBlock(block, k));
    }
    // Each voxel has a byte to come, so a false claim takes up no more memory than true ones.
    if (voxels.size() > in.rest().size()) return Error{"ends within a block"};
  }
  return voxels;
}

/// Bytes that an index into so many values needs.
int IndexBytes(std::size_t values) {
  int bytes = 1;
  while (bytes < 4 && values > (std::size_t{1} << (8 * bytes))) ++bytes;
  return bytes;
}

void PutLogOdds(ByteWriter& out, const std::vector<float>& values) {
  std::vector<std::uint32_t> palette;
  std::vector<std::uint32_t> indices;
  std::unordered_map<std::uint32_t, std::uint32_t> known;
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const auto [entry, is_new] = known.try_emplace(bits, static_cast<std::uint32_t>(palette.size()));
    if (is_new) palette.push_back(bits);
    indices.push_back(entry->second);
  }
  out.Varint(palette.size());
  for (const std::uint32_t bits : palette) out.U32(bits);
  for (int k = 0; k < IndexBytes(palette.size()); ++k) {
    for (const std::uint32_t index : indices) out.U8(static_cast<std::uint8_t>(index >> (8 * k)));
  }
}

/// Takes the log-odds of these voxels.
std::optional<Error> TakeLogOdds(ByteReader& in, const std::vector<VoxelIndex>& voxels,
                                 std::vector<VoxelChange>& changes) {
  const std::uint64_t count = in.Varint();
  if (!in.good() || count > voxels.size() || count > in.rest().size() / 4) {
    return Error{"ends within its log-odds"};
  }
  std::vector<float> palette(count);
  for (float& value : palette) {
    value = std::bit_cast<float>(in.U32());
    if (std::isinf(value)) return Error{"has infinite log-odds"};
    if (std::isnan(value)) return Error{"has log-odds that are no number"};
  }
  std::vector<std::uint32_t> indices(voxels.size());
  for (int k = 0; k < IndexBytes(count); ++k) {
    const Bytes plane = in.Take(voxels.size());
    if (!in.good()) return Error{"ends within its log-odds"};
    for (std::size_t n = 0; n < plane.size(); ++n) indices[n] |= std::uint32_t{plane[n]} << (8 * k);
  }
  changes.reserve(voxels.size());
  for (std::size_t n = 0; n < voxels.size(); ++n) {
    if (indices[n] >= count) return Error{"has a voxel without log-odds"};
    changes.push_back({voxels[n], palette[indices[n]]});
  }
  return std::nullopt;
}

constexpr std::array kChannels = {&VoxelColors::Mean::r, &VoxelColors::Mean::g, &VoxelColors::Mean::b};

void PutColors(ByteWriter& out, const std::vector<VoxelColors::Mean>& means) {
  for (const VoxelColors::Mean& mean : means) out.U8(static_cast<std::uint8_t>(mean.count));
  for (const auto channel : kChannels) {
    std::vector<std::uint16_t> steps;
    steps.reserve(means.size());
    std::uint16_t last = 0;
    for (const VoxelColors::Mean& mean : means) {
      const auto step = static_cast<std::int16_t>(static_cast<std::uint16_t>(mean.*channel - last));
      steps.push_back(static_cast<std::uint16_t>(ZigZag(step)));
      last = mean.*channel;
    }
    for (const std::uint16_t step : steps) out.U8(static_cast<std::uint8_t>(step >> 8U));
    for (const std::uint16_t step : steps) out.U8(static_cast<std::uint8_t>(step));
  }
}

std::optional<Error> TakeColors(ByteReader& in, const std::vector<VoxelIndex>& voxels,
                                std::vector<ColorChange>& changes) {
  const Bytes counts = in.Take(voxels.size());
  if (!in.good()) return Error{"ends within its colors"};
  changes.resize(voxels.size());
  for (std::size_t n = 0; n < voxels.size(); ++n) {
    if (counts[n] > VoxelColors::kMaxCount) return Error{"has a color of too many samples"};
    changes[n] = {voxels[n], {.count = counts[n]}};
  }
  for (const auto channel : kChannels) {
    const Bytes high = in.Take(voxels.size());
    const Bytes low = in.Take(voxels.size());
    if (!in.good()) return Error{"ends within its colors"};
    std::uint16_t value = 0;
    for (std::size_t n = 0; n < voxels.size(); ++n) {
      const std::int64_t step = FromZigZag(static_cast<std::uint64_t>(high[n]) << 8U | low[n]);
      value = static_cast<std::uint16_t>(value + step);
      changes[n].mean.*channel = value;
    }
  }
  return std::nullopt;
}

}  // namespace

void Apply(const MapPatch& patch, OccupancyGrid& grid, VoxelColors& colors) {
  // Voxels of a block mostly follow each other, so that few blocks are looked up.
  OccupancyGrid::Block* block = nullptr;
  VoxelIndex index;
  for (const VoxelChange& change : patch.voxels) {
    if (const VoxelIndex next = OccupancyGrid::BlockOf(change.voxel); !block || next != index) {
      block = &grid.BlockAt(next);
      index = next;
    }
    (*block)[OccupancyGrid::OffsetInBlock(change.voxel)] = change.log_odds;
  }
  VoxelColors::Block* color_block = nullptr;
  for (const ColorChange& change : patch.colors) {
    if (const VoxelIndex next = OccupancyGrid::BlockOf(change.voxel); !color_block || next != index) {
      color_block = &colors.BlockAt(next);
      index = next;
    }
    (*color_block)[OccupancyGrid::OffsetInBlock(change.voxel)] = change.mean;
  }
}

Result<std::vector<std::uint8_t>> Encode(const MapPatch& patch) {
  ByteWriter content;
  const auto voxels = Grouped(patch.voxels, [](const VoxelChange& change) { return change.log_odds; });
  PutPlaces(content, voxels);
  PutLogOdds(content, voxels.values);
  const auto colors = Grouped(patch.colors, [](const ColorChange& change) { return change.mean; });
  PutPlaces(content, colors);
  PutColors(content, colors.values);
  if (content.size() > kMostPatchBytes) {
    return Error{"a change of the map takes up " + std::to_string(content.size()) + " bytes, at most " +
                 std::to_string(kMostPatchBytes)};
  }
  ByteWriter out;
  out.Varint(content.size());
  out.Append(Compress(Compression::kZstd, content.bytes()));
  return out.Take();
}

Result<MapPatch> DecodeMapPatch(Bytes bytes) {
  ByteReader packed(bytes);
  const std::uint64_t size = packed.Varint();
  if (!packed.good() || size > kMostPatchBytes) return Error{"claims a size that no change has"};
  const Result<std::vector<std::uint8_t>> content =
      Decompress(NameOf(Compression::kZstd), packed.rest(), size);
  if (!content) return Error{content.error()};
  ByteReader in(*content);
  MapPatch patch;
  const auto voxels = TakePlaces(in);
  if (!voxels) return Error{voxels.error()};
  if (auto error = TakeLogOdds(in, *voxels, patch.voxels)) return *std::move(error);
  const auto colored = TakePlaces(in);
  if (!colored) return Error{colored.error()};
  if (auto error = TakeColors(in, *colored, patch.colors)) return *std::move(error);
  if (!in.rest().empty()) return Error{"has bytes after its end"};
  return patch;
}

}  // namespace thalweg::mapper
