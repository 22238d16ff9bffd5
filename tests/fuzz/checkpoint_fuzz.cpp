// libFuzzer target: for any bytes as a checkpoint of the mapper, as its journal, as one scan of it, as the
// patches in either, as a file of OctoMap or as a PLY, the readers return a map that can be gone on with, or
// say what is wrong, and take up no more memory than their limits.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/hash.h"
#include "common/compression/compression.h"
#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/core/map_patch.h"
#include "services/mapper/core/octomap_file.h"
#include "services/mapper/core/ply_file.h"
#include "services/mapper/core/ply_map.h"

namespace {

using namespace thalweg;
using namespace thalweg::mapper;

using Buffer = std::vector<std::uint8_t>;

constexpr MapPosition kBase{.map = 1, .writer = 2, .number = 3};
constexpr double kVoxelSize = 0.1;

void Require(bool good) {
  if (!good) __builtin_trap();
}

/// A mapper goes on with the map: every color takes another sample, and the map is stored again.
void GoOnWith(Checkpoint checkpoint) {
  Require(checkpoint.grid.voxel_size() > 0.0);
  std::vector<VoxelIndex> colored;
  for (const auto& [index, block] : checkpoint.colors.blocks()) {
    colored.push_back(OccupancyGrid::IndexInBlock(index, 0));
  }
  for (const VoxelIndex& voxel : colored) checkpoint.colors.Add(voxel, {1, 2, 3});
  const auto back =
      DecodeCheckpoint(EncodeCheckpoint(checkpoint.grid, checkpoint.colors, checkpoint.position));
  Require(back && back->grid.SameAs(checkpoint.grid) && back->position == checkpoint.position);
}

void FuzzCheckpoint(const std::string& bytes) {
  auto checkpoint = DecodeCheckpoint(bytes);
  if (!checkpoint) return Require(!checkpoint.error().empty());
  GoOnWith(*std::move(checkpoint));
}

/// With length and checksum, so that the fuzzer need not find them.
void FuzzContent(const char* magic, const std::string& content) {
  ByteWriter header;
  header.U64(content.size());
  header.U64(HashOf(content));
  FuzzCheckpoint(magic + std::string(header.bytes().begin(), header.bytes().end()) + content);
}

void FuzzJournal(Bytes bytes) {
  Checkpoint map{.grid = OccupancyGrid(kVoxelSize), .colors = {}, .position = kBase};
  const JournalUse use = ApplyJournal(bytes, map);
  Require(use.unused_bytes <= bytes.size());
  if (use.unused_bytes > 0) Require(!use.problem.empty());
  if (use.ends) {
    Require(use.ends->offsets.back() + use.unused_bytes == bytes.size());
    Require(use.ends->last_number() == map.position.number);
  }
  GoOnWith(std::move(map));
}

Buffer Joined(Buffer a, Bytes b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// As a patch before compression, which the fuzzer would not find.
Buffer Packed(Bytes content) {
  ByteWriter out;
  out.Varint(content.size());
  out.Append(Compress(Compression::kZstd, content));
  return out.Take();
}

void FuzzPatch(Bytes bytes) {
  const auto patch = DecodeMapPatch(bytes);
  if (!patch) return Require(!patch.error().empty());
  const auto again = Encode(*patch);
  Require(static_cast<bool>(again));
  const auto back = DecodeMapPatch(*again);
  Require(back && back->voxels.size() <= patch->voxels.size() && back->colors.size() <= patch->colors.size());
}

void FuzzOctomap(const std::string& bytes) {
  constexpr std::size_t kMostBlocks = 64;
  const Bytes all(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  const auto map = DecodeOctomap(all, kMostBlocks);
  if (!map) return Require(!map.error().empty());
  Require(map->grid.block_count() <= kMostBlocks);
  map->grid.ForEachKnown([](const VoxelIndex& voxel, float) { Require(InIndexRange(voxel)); });
}

void FuzzPly(const std::string& bytes) {
  constexpr std::size_t kMostBlocks = 64;
  const Bytes all(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  const auto ply = DecodePly(all);
  if (!ply) return Require(!ply.error().empty());
  Require(ply->points.size() <= bytes.size());
  Require(ply->colors.empty() || ply->colors.size() == ply->points.size());
  const auto map = MapOf(*ply, ply->map_voxel_size.value_or(0.1), kMostBlocks);
  if (!map) return Require(!map.error().empty());
  Require(map->grid.block_count() <= kMostBlocks);
  map->grid.ForEachKnown([](const VoxelIndex& voxel, float) { Require(InIndexRange(voxel)); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes bytes(data, size);
  const std::string text(reinterpret_cast<const char*>(data), size);
  FuzzCheckpoint(text);
  FuzzContent("THALWEG1", text);
  FuzzContent("THALWEG2", text);
  const Buffer head = EncodeHead({kVoxelSize, kBase});
  const MapPosition next{.map = kBase.map, .writer = 5, .number = kBase.number + 1};
  FuzzJournal(bytes);
  FuzzJournal(Joined(head, bytes));
  FuzzJournal(Joined(head, EncodeRecord(next, bytes)));
  FuzzJournal(Joined(Joined(head, EncodeRecord(next, Packed(bytes))), bytes));
  FuzzOctomap(text);
  FuzzOctomap("# Octomap OcTree file\nid OcTree\nres 0.1\ndata\n" + text);
  FuzzOctomap("# Octomap OcTree file\nid ColorOcTree\nres 0.1\ndata\n" + text);
  FuzzOctomap("# Octomap OcTree binary file\nid OcTree\nres 0.1\ndata\n" + text);
  FuzzPly(text);
  for (const char* const format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string ply = "ply\nformat " + std::string(format) + " 1.0\n";
    FuzzPly(ply + text);
    FuzzPly(ply +
            "comment thalweg voxel_size 0.1\nelement vertex 4\nproperty float x\nproperty char y\nproperty "
            "char z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "element face 2\nproperty list uchar uchar vertex_indices\nend_header\n" +
            text);
    FuzzPly(ply +
            "element vertex 4\nproperty char x\nproperty char y\nproperty char z\n"
            "element face 2\nproperty list uchar uchar vertex_indices\nend_header\n" +
            text);
  }
  FuzzPatch(bytes);
  FuzzPatch(Packed(bytes));
  return 0;
}
