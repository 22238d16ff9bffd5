#include "services/surface/adapter/volume_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <type_traits>

#include "common/base/append_raw.h"
#include "common/base/hash.h"
#include "common/base/raw_reader.h"
#include "common/base/text.h"
#include "common/compression/compression.h"

namespace thalweg::surface {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(std::is_trivially_copyable_v<SurfaceVoxel> && sizeof(SurfaceVoxel) == 20,
              "no padding in files");

constexpr std::string_view kMagic = "THALSUR1";
constexpr std::uint64_t kVoxelBytes = sizeof(TruncatedVolume::Block::voxels);
constexpr std::size_t kBlockHead = 4 * sizeof(std::int32_t);

bool IsGood(const SurfaceVoxel& voxel) {
  return std::isfinite(voxel.distance) && voxel.weight >= 0.0F && voxel.weight <= SurfaceVoxel::kMostWeight;
}

}  // namespace

void VolumeFile::Put(const TruncatedVolume& changed) {
  changed.ForEachBlock([this](const VoxelIndex& index, const TruncatedVolume::Block& block) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(block.voxels.data());
    const auto packed = Compress(Compression::kZstd, thalweg::Bytes(first, kVoxelBytes));
    blocks_[index].assign(packed.begin(), packed.end());  // which takes no more memory than it needs
  });
}

std::string VolumeFile::Bytes() const {
  std::string file(kMagic);
  std::size_t size = file.size() + sizeof(std::uint64_t) + sizeof voxel_size_ + sizeof(float) * 2;
  for (const auto& [index, bytes] : blocks_) size += kBlockHead + bytes.size();
  file.reserve(size + sizeof(std::uint32_t));
  AppendRaw(file, std::uint64_t{0});  // the hash of what follows, once that is known
  const std::size_t first = file.size();
  AppendRaw(file, voxel_size_);
  AppendRaw(file, limits_.distance);
  AppendRaw(file, limits_.cosine);
  AppendRaw(file, static_cast<std::uint32_t>(blocks_.size()));
  for (const auto& [index, bytes] : blocks_) {
    for (const std::int32_t i : {index.x, index.y, index.z}) AppendRaw(file, i);
    AppendRaw(file, static_cast<std::uint32_t>(bytes.size()));
    file.append(bytes.begin(), bytes.end());
  }
  const std::uint64_t hash = HashOf(std::string_view(file).substr(first));
  std::memcpy(file.data() + kMagic.size(), &hash, sizeof hash);
  return file;
}

Result<StoredVolume> VolumeFrom(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return Error{"is no surface checkpoint"};
  RawReader reader(bytes.substr(kMagic.size()));
  std::uint64_t hash = 0;
  if (!reader.Get(hash) || hash != HashOf(reader.rest())) return Error{"is damaged: its checksum is wrong"};
  double voxel_size = 0.0;
  InspectionLimits limits;
  std::uint32_t count = 0;
  if (!reader.Get(voxel_size) || !reader.Get(limits.distance) || !reader.Get(limits.cosine) ||
      !reader.Get(count)) {
    return Error{"ends before its first block"};
  }
  if (!(voxel_size > 0.0 && std::isfinite(voxel_size))) {
    return Error{"has voxels of " + NumberText(voxel_size) + " m"};
  }
  if (count > reader.rest().size() / kBlockHead) return Error{"has fewer blocks than it says"};
  StoredVolume stored{TruncatedVolume(voxel_size), VolumeFile(voxel_size, limits)};
  for (std::uint32_t k = 0; k < count; ++k) {
    VoxelIndex index;
    std::uint32_t length = 0;
    if (!reader.Get(index.x) || !reader.Get(index.y) || !reader.Get(index.z) || !reader.Get(length)) {
      return Error{"ends within a block"};
    }
    if (!InIndexRange(index)) return Error{"has a block beyond the grid"};
    const std::optional<thalweg::Bytes> packed = reader.Take(length);
    if (!packed) return Error{"ends within a block"};
    const auto voxels = Decompress(NameOf(Compression::kZstd), *packed, kVoxelBytes);
    if (!voxels) return Error{voxels.error()};
    TruncatedVolume::Block& block = stored.volume.At(index);
    std::memcpy(block.voxels.data(), voxels->data(), kVoxelBytes);
    if (!std::all_of(block.voxels.begin(), block.voxels.end(), IsGood))
      return Error{"has a voxel without a value"};
    block.has_inside = std::any_of(block.voxels.begin(), block.voxels.end(),
                                   [](const SurfaceVoxel& v) { return v.known() && v.distance < 0.0F; });
    stored.file.blocks_[index].assign(packed->begin(), packed->end());
  }
  if (!reader.rest().empty()) return Error{"has bytes after its end"};
  return stored;
}

Result<std::optional<StoredVolume>> LoadVolume(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::optional<StoredVolume>();
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  if (!(bytes << stream.rdbuf())) return Error{file.string() + ": cannot be read"};
  Result<StoredVolume> stored = VolumeFrom(bytes.view());
  if (!stored) return Error{file.string() + ": " + stored.error()};
  return std::optional<StoredVolume>(*std::move(stored));
}

}  // namespace thalweg::surface
