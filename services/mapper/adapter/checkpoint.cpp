#include "services/mapper/adapter/checkpoint.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "common/base/hash.h"

namespace thalweg::mapper {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::string_view kMagic = "THALWEG1";
constexpr std::size_t kHeaderBytes = kMagic.size() + 2 * sizeof(std::uint64_t);

class Writer {
 public:
  template <class T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  /// Returns false and leaves `value` unchanged if fewer bytes are left.
  template <class T>
  bool Get(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (bytes_.size() < sizeof(T)) return false;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
    return true;
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

bool InBlockRange(const VoxelIndex& block) {
  constexpr std::int32_t kMaxBlock = (kMaxVoxelIndex >> OccupancyGrid::kBlockBits) + 1;
  const auto near = [](std::int32_t i) { return i >= -kMaxBlock && i <= kMaxBlock; };
  return near(block.x) && near(block.y) && near(block.z) &&
         InIndexRange(OccupancyGrid::IndexInBlock(block, 0));
}

/// Decodes what follows the header. Error: why this is not a checkpoint.
Result<Checkpoint> DecodeContent(Reader reader) {
  double voxel_size = 0.0;
  std::uint32_t blocks = 0;
  if (!reader.Get(voxel_size) || !(voxel_size > 0.0 && std::isfinite(voxel_size)) || !reader.Get(blocks)) {
    return Error{"has no voxel size"};
  }
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
  for (std::uint32_t i = 0; i < blocks; ++i) {
    VoxelIndex index;
    VoxelColors::Block values;
    if (!reader.Get(index) || !reader.Get(values)) return Error{"ends within a color block"};
    if (!InBlockRange(index)) return Error{"has a color block beyond the grid"};
    checkpoint.colors.BlockAt(index) = values;
  }
  if (!reader.at_end()) return Error{"has bytes after its end"};
  return checkpoint;
}

}  // namespace

std::string EncodeCheckpoint(const OccupancyGrid& grid, const VoxelColors& colors) {
  Writer content;
  content.Put(grid.voxel_size());
  content.Put(static_cast<std::uint32_t>(grid.block_count()));
  grid.ForEachBlock([&content](const VoxelIndex& index, const OccupancyGrid::Block& block) {
    content.Put(index);
    content.Put(block);
  });
  content.Put(static_cast<std::uint32_t>(colors.blocks().size()));
  for (const auto& [index, block] : colors.blocks()) {
    content.Put(index);
    content.Put(block);
  }
  const std::string bytes = content.Take();
  Writer header;
  header.Put(static_cast<std::uint64_t>(bytes.size()));
  header.Put(HashOf(bytes));
  return std::string(kMagic) + header.Take() + bytes;
}

Result<Checkpoint> DecodeCheckpoint(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return Error{"is not a checkpoint of thalweg's mapper"};
  if (bytes.size() < kHeaderBytes) return Error{"is truncated within its header"};
  Reader header(bytes.substr(kMagic.size()));
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
  return DecodeContent(Reader(content));
}

Result<std::optional<Checkpoint>> LoadCheckpoint(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::optional<Checkpoint>();
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream.is_open()) return Error{file.string() + " cannot be read"};
  Result<Checkpoint> checkpoint = DecodeCheckpoint(bytes.str());
  if (!checkpoint) return Error{file.string() + ' ' + checkpoint.error()};
  return std::optional<Checkpoint>(*std::move(checkpoint));
}

OccupancyGrid CopyOf(const OccupancyGrid& grid) {
  OccupancyGrid copy(grid.voxel_size());
  grid.ForEachBlock(
      [&copy](const VoxelIndex& index, const OccupancyGrid::Block& block) { copy.BlockAt(index) = block; });
  return copy;
}

}  // namespace thalweg::mapper
