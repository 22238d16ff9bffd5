#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "common/voxel/voxel_index.h"
#include "services/gateway/core/blocks_by_change.h"
#include "services/gateway/core/session.h"

namespace thalweg::gateway {

/// The triangles of a block of the surface's mesh, as they travel: see thalweg_msgs/msg/SurfaceBlock.
struct SurfaceMeshBlock {
  VoxelIndex block;
  std::vector<float> points_m = {};
  std::vector<std::uint8_t> normals = {};
  std::vector<std::uint8_t> colors = {};
  std::vector<std::uint8_t> views = {};
  std::vector<std::uint16_t> faces = {};
};
using SharedMeshBlock = std::shared_ptr<const SurfaceMeshBlock>;

/// What has changed of the surface's mesh.
struct SurfaceChange {
  Time stamp;
  double voxel_size = 0.0;
  bool replaced = false;  ///< Blocks that are not in `blocks` have no mesh any more.
  std::vector<SharedMeshBlock> blocks;
};

/// The mesh of the surface for a viewer: every block, then those that changed.
class SurfaceFeed final : public Feed {
 public:
  static constexpr std::string_view kTopic = "thalweg/surface";
  static constexpr std::string_view kSchemaName = "thalweg_msgs/msg/SurfaceMesh";
  static constexpr std::string_view kSchema =
      "# Meshes of blocks, one after the other; they replace earlier ones of the same place.\n"
      "float64 voxel_size_m\n"
      "bool reset           # forget all earlier blocks\n"
      "int32[] position     # x, y, z of each block\n"
      "uint32[] vertices    # their number in each block; 0 = it has no mesh any more\n"
      "uint32[] triangles   # their number in each block\n"
      "float32[] points_m   # x, y, z of each vertex, in map\n"
      "uint8[] normals      # x, y, z of each vertex: (n + 1) * 127\n"
      "uint8[] colors       # red, green, blue of each vertex\n"
      "uint8[] views        # of each vertex: 1 = seen near and square enough, + 2 = sampled finely enough\n"
      "uint16[] faces       # three vertices of its block for each triangle\n";
  static constexpr std::size_t kMostBytes = 1 << 20;  ///< In one message, so that others can pass between.

  void Update(const SurfaceChange& change);
  std::optional<Message> Next(std::uint64_t& cursor) const override;

 private:
  Time stamp_;
  double voxel_size_ = 0.0;
  BlocksByChange<SharedMeshBlock> blocks_;
};

}  // namespace thalweg::gateway
