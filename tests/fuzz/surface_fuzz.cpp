// libFuzzer target: for any bytes as a checkpoint of the surface, as what its checksum covers, or as the
// voxels of one of its blocks, the reader returns a volume that can be meshed and stored again, or says what
// is wrong.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/append_raw.h"
#include "common/base/hash.h"
#include "services/surface/adapter/volume_file.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace {

using namespace thalweg;
using namespace thalweg::surface;

constexpr std::string_view kMagic = "THALSUR1";

void Require(bool good) {
  if (!good) __builtin_trap();
}

void Read(std::string_view bytes) {
  const Result<StoredVolume> stored = VolumeFrom(bytes);
  if (!stored) return Require(!stored.error().empty());
  std::vector<VoxelIndex> blocks;
  stored->volume.ForEachBlock([&](const VoxelIndex& index, const auto&) { blocks.push_back(index); });
  SurfaceMesh mesh(stored->file.limits());
  mesh.Update(stored->volume, blocks);
  const TriangleMesh joined = mesh.Joined();
  for (const auto& face : joined.faces) {
    for (const std::uint32_t vertex : face) Require(vertex < joined.vertices_W.size());
  }
  const Result<StoredVolume> again = VolumeFrom(stored->file.Bytes());
  Require(again && again->volume.block_count() == stored->volume.block_count());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  Read(bytes);
  std::string sealed(kMagic);
  AppendRaw(sealed, HashOf(bytes));
  Read(sealed.append(bytes));

  TruncatedVolume volume(0.02);
  TruncatedVolume::Block& block = volume.At({1, -2, 3});
  std::memcpy(block.voxels.data(), data, std::min(size, sizeof block.voxels));
  VolumeFile file(0.02, {});
  file.Put(volume);
  Read(file.Bytes());
  return 0;
}
