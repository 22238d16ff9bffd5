#include "services/mapper/adapter/checkpoint.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include "common/base/check.h"
#include "common/base/hash.h"
#include "common/base/raw_reader.h"
#include "services/mapper/core/map_patch.h"

namespace thalweg::mapper {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::string_view kMagic = "THALWEG2";
constexpr std::string_view kUncompressedMagic = "THALWEG1";
constexpr std::size_t kHeaderBytes = kMagic.size() + 2 * sizeof(std::uint64_t);

class Writer {
 public:
  template <class T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void Append(Bytes bytes) { bytes_.append(bytes.begin(), bytes.end()); }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

bool InBlockRange(const VoxelIndex& block) {
  constexpr std::int32_t kMaxBlock = (kMaxVoxelIndex >> OccupancyGrid::kBlockBits) + 1;
  const auto near = [](std::int32_t i) { return i >= -kMaxBlock && i <= kMaxBlock; };
  return near(block.x) && near(block.y) && near(block.z) &&
         InIndexRange(OccupancyGrid::IndexInBlock(block, 0));
}

/// Decodes what follows the header of the uncompressed format. Error: why this is not a checkpoint.
Result<Checkpoint> DecodeUncompressed(RawReader reader) {
  double voxel_size = 0.0;
  std::uint32_t blocks = 0;
  if (!reader.Get(voxel_size) || !(voxel_size > 0.0 && std::isfinite(voxel_size)) || !reader.Get(blocks)) {
    return Error{"has no voxel size"};
  }
  if (blocks > kMostStoredBlocks) return Error{"has too many blocks"};
  Checkpoint checkpoint{.grid = OccupancyGrid(voxel_size), .colors = {}};
  for (std::uint32_t i = 0; i < blocks; ++i) {
    VoxelIndex index;
    OccupancyGrid::Block values;
    if (!reader.Get(index) || !reader.Get(values)) return Error{"ends within a block"};
    if (!InBlockRange(index)) return Error{"has a block beyond the grid"};
    for (const float value : values) {
      if (std::isinf(value)) return Error{"has infinite log-odds"};
    }
    checkpoint.grid.BlockAt(index) = values;
  }
  if (!reader.Get(blocks)) return Error{"has no colors"};
  if (blocks > kMostStoredBlocks) return Error{"has too many blocks"};
  for (std::uint32_t i = 0; i < blocks; ++i) {
    VoxelIndex index;
    VoxelColors::Block values;
    if (!reader.Get(index) || !reader.Get(values)) return Error{"ends within a color block"};
    if (!InBlockRange(index)) return Error{"has a color block beyond the grid"};
    for (const VoxelColors::Mean& mean : values) {
      if (mean.count > VoxelColors::kMaxCount) return Error{"has a color of too many samples"};
    }
    checkpoint.colors.BlockAt(index) = values;
  }
  if (!reader.rest().empty()) return Error{"has bytes after its end"};
  return checkpoint;
}

bool HasTooManyBlocks(const Checkpoint& checkpoint) {
  return std::max(checkpoint.grid.block_count(), checkpoint.colors.blocks().size()) > kMostStoredBlocks;
}

/// Decodes what follows the header.
Result<Checkpoint> DecodeContent(RawReader reader) {
  MapPosition position;
  double voxel_size = 0.0;
  std::uint32_t patches = 0;
  if (!reader.Get(position) || !reader.Get(voxel_size) || !(voxel_size > 0.0 && std::isfinite(voxel_size)) ||
      !reader.Get(patches)) {
    return Error{"has no voxel size"};
  }
  Checkpoint checkpoint{.grid = OccupancyGrid(voxel_size), .colors = {}, .position = position};
  for (std::uint32_t i = 0; i < patches; ++i) {
    std::uint32_t length = 0;
    const auto bytes = reader.Get(length) ? reader.Take(length) : std::nullopt;
    if (!bytes) return Error{"ends within a block"};
    const Result<MapPatch> patch = DecodeMapPatch(*bytes);
    if (!patch) return Error{patch.error()};
    Apply(*patch, checkpoint.grid, checkpoint.colors);
    if (HasTooManyBlocks(checkpoint)) return Error{"has too many blocks"};
  }
  if (!reader.rest().empty()) return Error{"has bytes after its end"};
  return checkpoint;
}

/// Puts a map as patches of a bounded size, so that neither side holds more than one of them uncompressed.
class PatchWriter {
 public:
  explicit PatchWriter(Writer& out) : out_(out) {}

  void AddBlock(const VoxelIndex& index, const OccupancyGrid::Block& block) {
    for (std::size_t k = 0; k < block.size(); ++k) {
      if (!std::isnan(block[k])) patch_.voxels.push_back({OccupancyGrid::IndexInBlock(index, k), block[k]});
    }
    PutWhenFull();
  }
  void AddColors(const VoxelIndex& index, const VoxelColors::Block& block) {
    for (std::size_t k = 0; k < block.size(); ++k) {
      if (block[k].count > 0) patch_.colors.push_back({OccupancyGrid::IndexInBlock(index, k), block[k]});
    }
    PutWhenFull();
  }
  /// Puts the rest, and returns the number of patches.
  std::uint32_t Finish() {
    if (blocks_ > 0) Put();
    return patches_;
  }

 private:
  void PutWhenFull() {
    constexpr int kBlocks = 64;
    if (++blocks_ == kBlocks) Put();
  }
  void Put() {
    const auto bytes = Encode(patch_);
    THALWEG_CHECK(bytes);
    out_.Put(static_cast<std::uint32_t>(bytes->size()));
    out_.Append(*bytes);
    patch_ = {};
    blocks_ = 0;
    ++patches_;
  }

  Writer& out_;
  MapPatch patch_;
  int blocks_ = 0;
  std::uint32_t patches_ = 0;
};

}  // namespace

std::string EncodeCheckpoint(const OccupancyGrid& grid, const VoxelColors& colors,
                             const MapPosition& position) {
  Writer patches;
  PatchWriter patch_writer(patches);
  grid.ForEachBlock([&](const VoxelIndex& index, const OccupancyGrid::Block& block) {
    patch_writer.AddBlock(index, block);
  });
  for (const auto& [index, block] : colors.blocks()) patch_writer.AddColors(index, block);
  const std::uint32_t count = patch_writer.Finish();
  Writer content;
  content.Put(position);
  content.Put(grid.voxel_size());
  content.Put(count);
  const std::string bytes = content.Take() + patches.Take();
  Writer header;
  header.Put(static_cast<std::uint64_t>(bytes.size()));
  header.Put(HashOf(bytes));
  return std::string(kMagic) + header.Take() + bytes;
}

Result<Checkpoint> DecodeCheckpoint(std::string_view bytes) {
  const bool uncompressed = bytes.starts_with(kUncompressedMagic);
  if (!uncompressed && !bytes.starts_with(kMagic)) return Error{"is not a checkpoint of thalweg's mapper"};
  if (bytes.size() < kHeaderBytes) return Error{"is truncated within its header"};
  RawReader header(bytes.substr(kMagic.size()));
  std::uint64_t size = 0;
  std::uint64_t hash = 0;
  header.Get(size);
  header.Get(hash);
  const std::string_view content = bytes.substr(kHeaderBytes);
  if (content.size() != size) {
    return Error{"has " + std::to_string(content.size()) + " bytes after its header, should have " +
                 std::to_string(size)};
  }
  if (HashOf(content) != hash) return Error{"is corrupt: its checksum does not match"};
  return uncompressed ? DecodeUncompressed(RawReader(content)) : DecodeContent(RawReader(content));
}

JournalUse ApplyJournal(Bytes journal, Checkpoint& checkpoint) {
  JournalUse use{.unused_bytes = journal.size()};
  Result<JournalReader> reader = JournalReader::Open(journal);
  if (!reader) {
    use.problem = reader.error();
    return use;
  }
  const JournalHead& head = reader->head();
  const MapPosition begun = checkpoint.position;
  if (head.base.map != begun.map || head.voxel_size != checkpoint.grid.voxel_size()) {
    use.problem = "is of another map";
  } else if (head.base.number > begun.number) {
    use.problem = "begins after scan " + std::to_string(head.base.number) +
                  ", the checkpoint ends with scan " + std::to_string(begun.number);
  } else if (head.base.number == begun.number && head.base.writer != begun.writer) {
    use.problem = "follows upon another course of this map";
  }
  if (!use.problem.empty()) return use;
  JournalEnds ends{.base_number = head.base.number, .offsets = {reader->whole_until()}};
  while (const std::optional<JournalRecord> record = reader->Next()) {
    if (record->position.number == begun.number && record->position.writer != begun.writer) {
      use.problem = "follows upon another course of this map";
      return use;
    }
    if (record->position.number > begun.number) {
      const Result<MapPatch> patch = DecodeMapPatch(record->content);
      if (!patch) {
        use.problem = "scan " + std::to_string(record->position.number) + ' ' + patch.error();
        break;
      }
      Apply(*patch, checkpoint.grid, checkpoint.colors);
      checkpoint.position = record->position;
      ++use.applied;
      if (HasTooManyBlocks(checkpoint)) {
        use.problem = "has too many blocks";
        return use;
      }
    }
    ends.offsets.push_back(reader->whole_until());
  }
  if (use.problem.empty()) use.problem = reader->problem();
  use.unused_bytes = journal.size() - ends.offsets.back();
  if (ends.last_number() >= begun.number) use.ends = std::move(ends);
  return use;
}

std::filesystem::path JournalOf(const std::filesystem::path& checkpoint_file) {
  return std::filesystem::path(checkpoint_file).replace_extension(".journal");
}

namespace {

/// The content of a file, or nothing if it cannot be opened.
std::optional<std::string> ContentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream.is_open()) return std::nullopt;
  return std::move(bytes).str();
}

}  // namespace

Result<std::optional<StoredMap>> LoadStoredMap(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::optional<StoredMap>();
  const std::optional<std::string> bytes = ContentOf(file);
  if (!bytes) return Error{file.string() + " cannot be read"};
  Result<Checkpoint> checkpoint = DecodeCheckpoint(*bytes);
  if (!checkpoint) return Error{file.string() + ' ' + checkpoint.error()};
  StoredMap stored{.checkpoint = *std::move(checkpoint), .journal = {}};
  const std::optional<std::string> journal = ContentOf(JournalOf(file));
  if (journal) {
    stored.journal = ApplyJournal({reinterpret_cast<const std::uint8_t*>(journal->data()), journal->size()},
                                  stored.checkpoint);
  }
  return std::optional<StoredMap>(std::move(stored));
}

Result<std::optional<Checkpoint>> LoadCheckpoint(const std::filesystem::path& file) {
  Result<std::optional<StoredMap>> stored = LoadStoredMap(file);
  if (!stored) return Error{stored.error()};
  if (!stored->has_value()) return std::optional<Checkpoint>();
  return std::optional<Checkpoint>(std::move((*stored)->checkpoint));
}

}  // namespace thalweg::mapper
