#include "services/surface/adapter/volume_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <type_traits>

#include "common/base/hash.h"
#include "common/compression/compression.h"

namespace thalweg::surface {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(std::is_trivially_copyable_v<SurfaceVoxel> && sizeof(SurfaceVoxel) == 20,
              "no padding in files");

constexpr std::string_view kMagic = "THALSUR1";
constexpr std::uint64_t kVoxelBytes = sizeof(TruncatedVolume::Block::voxels);
constexpr std::uint32_t kMostBlocks = 1U << 20U;  // 10 GB

template <class T>
void Append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  bool Get(T& value) {
    if (bytes_.size() < sizeof value) return false;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return true;
  }
  std::optional<thalweg::Bytes> Take(std::size_t count) {
    if (bytes_.size() < count) return std::nullopt;
    const thalweg::Bytes taken(reinterpret_cast<const std::uint8_t*>(bytes_.data()), count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
};

bool IsGood(const SurfaceVoxel& voxel) {
  return std::isfinite(voxel.distance) && voxel.weight >= 0.0F && voxel.weight <= SurfaceVoxel::kMostWeight;
}

bool InRange(const VoxelIndex& block) {
  const auto near = [](std::int32_t i) { return i >= -kMaxVoxelIndex && i <= kMaxVoxelIndex; };
  return near(block.x) && near(block.y) && near(block.z);
}

}  // namespace

void VolumeFile::Update(const TruncatedVolume& volume, std::span<const VoxelIndex> changed) {
  for (const VoxelIndex& index : changed) {
    const TruncatedVolume::Block* block = volume.Find(index);
    if (!block) continue;
    const auto* first = reinterpret_cast<const std::uint8_t*>(block->voxels.data());
    blocks_[index] = Compress(Compression::kZstd, thalweg::Bytes(first, kVoxelBytes));
  }
}

std::string VolumeFile::Bytes(double voxel_size) const {
  std::string content;
  Append(content, voxel_size);
  Append(content, static_cast<std::uint32_t>(blocks_.size()));
  for (const auto& [index, bytes] : blocks_) {
    for (const std::int32_t i : {index.x, index.y, index.z}) Append(content, i);
    Append(content, static_cast<std::uint32_t>(bytes.size()));
    content.append(bytes.begin(), bytes.end());
  }
  std::string file(kMagic);
  Append(file, HashOf(content));
  return file + content;
}

Result<TruncatedVolume> VolumeFrom(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return Error{"is no surface checkpoint"};
  Reader reader(bytes.substr(kMagic.size()));
  std::uint64_t hash = 0;
  if (!reader.Get(hash) || hash != HashOf(reader.rest())) return Error{"is damaged: its checksum is wrong"};
  double voxel_size = 0.0;
  std::uint32_t count = 0;
  if (!reader.Get(voxel_size) || !(voxel_size > 0.0 && std::isfinite(voxel_size)) || !reader.Get(count)) {
    return Error{"has no voxel size"};
  }
  if (count > kMostBlocks) return Error{"has too many blocks"};
  TruncatedVolume volume(voxel_size);
  for (std::uint32_t k = 0; k < count; ++k) {
    VoxelIndex index;
    std::uint32_t length = 0;
    if (!reader.Get(index.x) || !reader.Get(index.y) || !reader.Get(index.z) || !reader.Get(length)) {
      return Error{"ends within a block"};
    }
    if (!InRange(index)) return Error{"has a block beyond the grid"};
    const std::optional<thalweg::Bytes> packed = reader.Take(length);
    if (!packed) return Error{"ends within a block"};
    const auto voxels = Decompress(NameOf(Compression::kZstd), *packed, kVoxelBytes);
    if (!voxels) return Error{voxels.error()};
    TruncatedVolume::Block& block = volume.At(index);
    std::memcpy(block.voxels.data(), voxels->data(), kVoxelBytes);
    if (!std::all_of(block.voxels.begin(), block.voxels.end(), IsGood))
      return Error{"has a voxel without a value"};
    block.has_inside = std::any_of(block.voxels.begin(), block.voxels.end(),
                                   [](const SurfaceVoxel& v) { return v.known() && v.distance < 0.0F; });
  }
  if (!reader.rest().empty()) return Error{"has bytes after its end"};
  return volume;
}

Result<std::optional<TruncatedVolume>> LoadVolume(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::optional<TruncatedVolume>();
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  if (!(bytes << stream.rdbuf())) return Error{file.string() + ": cannot be read"};
  Result<TruncatedVolume> volume = VolumeFrom(bytes.view());
  if (!volume) return Error{file.string() + ": " + volume.error()};
  return std::optional<TruncatedVolume>(*std::move(volume));
}

}  // namespace thalweg::surface
