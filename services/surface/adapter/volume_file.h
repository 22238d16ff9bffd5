#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
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
/// what counts as inspected, since voxels remember whether they were (distance and cosine, 32 bit float), the
/// number of blocks (32 bit), and for each block its index (3 x 32 bit), the length of its bytes (32 bit) and
/// these: its 512 voxels of 20 bytes as they are in memory, compressed by zstd.
class VolumeFile {
 public:
  VolumeFile(double voxel_size, const InspectionLimits& limits) : voxel_size_(voxel_size), limits_(limits) {}

  /// Compresses blocks, or compresses them again.
  void Put(const TruncatedVolume& changed);
  /// The file of all blocks so far.
  std::string Bytes() const;

  double voxel_size() const { return voxel_size_; }
  const InspectionLimits& limits() const { return limits_; }  ///< Without the sampling.

 private:
  friend Result<struct StoredVolume> VolumeFrom(std::string_view bytes);
  double voxel_size_;
  InspectionLimits limits_;
  std::unordered_map<VoxelIndex, std::vector<std::uint8_t>, VoxelIndexHash> blocks_;
};

/// A volume and the file that it came from.
struct StoredVolume {
  TruncatedVolume volume;
  VolumeFile file;
};

/// Decodes a file. Error: why this is not one.
Result<StoredVolume> VolumeFrom(std::string_view bytes);
/// Loads a file; nothing if there is none. Error: "FILE: REASON".
Result<std::optional<StoredVolume>> LoadVolume(const std::filesystem::path& file);

}  // namespace thalweg::surface
