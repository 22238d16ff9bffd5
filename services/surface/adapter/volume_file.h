#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/base/result.h"
#include "services/surface/core/fused/truncated_volume.h"

namespace thalweg::surface {

/// A volume as a file: a checkpoint from which the service goes on. Blocks are compressed one by one, so that
/// a further checkpoint compresses only those that have changed since the one before.
///
/// Format, little endian: the magic, a hash of all that follows (FNV-1a, 64 bit), the voxel size (double),
/// the number of blocks (32 bit), and for each block its index (3 x 32 bit), the length of its bytes (32 bit)
/// and these: its 512 voxels of 20 bytes as they are in memory, compressed by zstd.
class VolumeFile {
 public:
  /// Compresses blocks again. @param changed  Blocks of the volume.
  void Update(const TruncatedVolume& volume, std::span<const VoxelIndex> changed);
  /// The file of all blocks so far.
  std::string Bytes(double voxel_size) const;
  std::size_t block_count() const { return blocks_.size(); }

 private:
  std::unordered_map<VoxelIndex, std::vector<std::uint8_t>, VoxelIndexHash> blocks_;
};

/// Decodes a file. Error: why this is not one.
Result<TruncatedVolume> VolumeFrom(std::string_view bytes);
/// Loads a file; nothing if there is none. Error: "FILE: REASON".
Result<std::optional<TruncatedVolume>> LoadVolume(const std::filesystem::path& file);

}  // namespace thalweg::surface
