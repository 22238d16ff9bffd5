#include "services/link/core/map_codec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>

#include "common/base/check.h"
#include "common/base/zig_zag.h"

namespace thalweg::link {
namespace {

constexpr std::size_t kMaskBytes = OccupancyGrid::kBlockVoxels / 8;
constexpr std::uint64_t kMostBlocks = 1U << 14U;  // in one message
constexpr std::uint64_t kMostScans = 1024;
constexpr std::size_t kMostBytes = 1U << 20U;  // unpacked; sixteen times as much in memory
constexpr std::int64_t kMostBlockIndex = kMaxVoxelIndex >> OccupancyGrid::kBlockBits;

using Mask = std::array<std::uint8_t, kMaskBytes>;

struct CodedBlocks {
  std::vector<VoxelIndex> indices;
  std::vector<Mask> masks;
};

void PutDouble(ByteWriter& out, double value) {
  out.U64(std::bit_cast<std::uint64_t>(value));
}

double TakeDouble(ByteReader& in) {
  return std::bit_cast<double>(in.U64());
}

void PutScan(ByteWriter& out, const ScanView& scan) {
  const Eigen::Quaterniond q_WC(scan.T_WC.linear());
  for (const double value : {scan.T_WC.translation().x(), scan.T_WC.translation().y(),
                             scan.T_WC.translation().z(), q_WC.w(), q_WC.x(), q_WC.y(), q_WC.z()}) {
    PutDouble(out, value);
  }
  out.U8(scan.measured ? 1 : 0);
  if (scan.measured) out.Append(scan.measured->of_255);
}

Result<ScanView> TakeScan(ByteReader& in) {
  std::array<double, 7> values{};
  for (double& value : values) value = TakeDouble(in);
  const Eigen::Quaterniond q_WC(values[3], values[4], values[5], values[6]);
  const bool sound = std::ranges::all_of(values, [](double value) { return std::abs(value) < 1e6; });
  if (!sound || !(std::abs(q_WC.norm() - 1.0) < 0.01)) return Error{"a scan whose pose is none"};
  ScanView scan{MakeTransform(q_WC.normalized().toRotationMatrix(), {values[0], values[1], values[2]})};
  if (in.U8() != 0) {
    const Bytes shares = in.Take(MeasuredShares::kSide * MeasuredShares::kSide);
    scan.measured.emplace();
    if (in.good()) std::ranges::copy(shares, scan.measured->of_255.begin());
  }
  return scan;
}

/// Indices into the values that occur, in the order of their first occurrence.
struct Palette {
  std::vector<std::uint32_t> values;
  std::vector<std::uint32_t> indices;
};

Palette PaletteOf(const std::vector<float>& values) {
  Palette palette;
  std::map<std::uint32_t, std::uint32_t> known;
  for (const float value : values) {
    const std::uint32_t bits =
        std::bit_cast<std::uint32_t>(std::isnan(value) ? OccupancyGrid::kUnknown : value);
    const auto [entry, is_new] = known.try_emplace(bits, static_cast<std::uint32_t>(palette.values.size()));
    if (is_new) palette.values.push_back(bits);
    palette.indices.push_back(entry->second);
  }
  return palette;
}

void PutBlocks(ByteWriter& out, const std::vector<VoxelChange>& voxels) {
  CodedBlocks blocks;
  std::vector<std::array<float, OccupancyGrid::kBlockVoxels>> contents;
  for (const VoxelChange& change : voxels) {
    const VoxelIndex block = OccupancyGrid::BlockOf(change.voxel);
    if (blocks.indices.empty() || blocks.indices.back() != block) {
      blocks.indices.push_back(block);
      blocks.masks.push_back({});
      contents.push_back({});
    }
    const std::size_t k = OccupancyGrid::OffsetInBlock(change.voxel);
    blocks.masks.back()[k / 8] = static_cast<std::uint8_t>(blocks.masks.back()[k / 8] | (1U << (k % 8)));
    contents.back()[k] = change.log_odds;
  }
  THALWEG_CHECK(blocks.indices.size() <= kMostBlocks);
  std::vector<float> values;  // in the order of the bits
  for (std::size_t n = 0; n < contents.size(); ++n) {
    for (std::size_t k = 0; k < OccupancyGrid::kBlockVoxels; ++k) {
      if ((blocks.masks[n][k / 8] >> (k % 8)) & 1U) values.push_back(contents[n][k]);
    }
  }
  out.Varint(blocks.indices.size());
  VoxelIndex last{0, 0, 0};
  for (const VoxelIndex& block : blocks.indices) {
    out.Varint(ZigZag(std::int64_t{block.x} - last.x));
    out.Varint(ZigZag(std::int64_t{block.y} - last.y));
    out.Varint(ZigZag(std::int64_t{block.z} - last.z));
    last = block;
  }
  for (const Mask& mask : blocks.masks) out.Append(mask);
  const Palette palette = PaletteOf(values);
  out.Varint(palette.values.size());
  for (const std::uint32_t bits : palette.values) out.U32(bits);
  for (const std::uint32_t index : palette.indices) out.Varint(index);
}

Result<CodedBlocks> TakeBlockHeads(ByteReader& in) {
  const std::uint64_t count = in.Varint();
  if (!in.good() || count > kMostBlocks) return Error{"a change of " + std::to_string(count) + " blocks"};
  CodedBlocks blocks;
  std::array<std::int64_t, 3> at{};
  for (std::uint64_t n = 0; n < count && in.good(); ++n) {
    for (std::int64_t& coordinate : at) {
      const std::int64_t step = FromZigZag(in.Varint());
      if (std::abs(step / 4) > kMostBlockIndex) return Error{"a block beyond the largest index"};
      coordinate += step;
      if (coordinate < -kMostBlockIndex - 1 || coordinate > kMostBlockIndex) {
        return Error{"a block beyond the largest index"};
      }
    }
    blocks.indices.push_back({static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1]),
                              static_cast<std::int32_t>(at[2])});
  }
  for (std::uint64_t n = 0; n < count && in.good(); ++n) {
    const Bytes bits = in.Take(kMaskBytes);
    if (in.good()) std::ranges::copy(bits, blocks.masks.emplace_back().begin());
  }
  if (!in.good()) return Error{"a change is cut off"};
  return blocks;
}

std::optional<Error> TakeBlocks(ByteReader& in, std::vector<VoxelChange>& voxels) {
  const Result<CodedBlocks> blocks = TakeBlockHeads(in);
  if (!blocks) return Error{blocks.error()};
  const std::uint64_t count = in.Varint();
  if (!in.good() || count > in.rest().size() / 4) return Error{"a change is cut off"};
  std::vector<float> palette(count);
  for (float& value : palette) {
    value = std::bit_cast<float>(in.U32());
    if (std::isinf(value)) return Error{"infinite log odds"};
  }
  for (std::size_t n = 0; n < blocks->indices.size(); ++n) {
    for (std::size_t k = 0; k < OccupancyGrid::kBlockVoxels; ++k) {
      if (((blocks->masks[n][k / 8] >> (k % 8)) & 1U) == 0) continue;
      const std::uint64_t index = in.Varint();
      if (!in.good() || index >= palette.size()) return Error{"a voxel without a value"};
      voxels.push_back({OccupancyGrid::IndexInBlock(blocks->indices[n], k), palette[index]});
    }
  }
  return std::nullopt;
}

}  // namespace

Buffer Encode(const MapChange& change) {
  THALWEG_CHECK(change.scans.size() <= kMostScans);
  ByteWriter out;
  out.U8(change.reset ? 1 : 0);
  out.U64(static_cast<std::uint64_t>(change.stamp.time_since_epoch().count()));
  PutDouble(out, change.voxel_size);
  out.Varint(change.scans.size());
  for (const ScanView& scan : change.scans) PutScan(out, scan);
  PutBlocks(out, change.voxels);
  return Pack(out.bytes());
}

Result<MapChange> DecodeMapChange(Bytes bytes) {
  const Result<Buffer> unpacked = Unpack(bytes, {}, kMostBytes);
  if (!unpacked) return Error{unpacked.error()};
  ByteReader in(*unpacked);
  MapChange change;
  change.reset = in.U8() != 0;
  const auto stamp = static_cast<std::int64_t>(in.U64());
  change.voxel_size = TakeDouble(in);
  const std::uint64_t scans = in.Varint();
  if (!in.good() || scans > kMostScans) return Error{"a change of " + std::to_string(scans) + " scans"};
  if (!(change.voxel_size >= 1e-4 && change.voxel_size <= 100.0)) return Error{"a voxel size that is none"};
  if (stamp < 0 || stamp / 1'000'000'000 > std::numeric_limits<std::int32_t>::max()) {
    return Error{"a stamp that no clock shows"};
  }
  change.stamp = Time{Duration(stamp)};
  for (std::uint64_t n = 0; n < scans; ++n) {
    Result<ScanView> scan = TakeScan(in);
    if (!scan) return Error{scan.error()};
    change.scans.push_back(*std::move(scan));
  }
  if (auto error = TakeBlocks(in, change.voxels)) return *std::move(error);
  if (!in.good() || !in.rest().empty()) return Error{"a change of the wrong length"};
  return change;
}

}  // namespace thalweg::link
