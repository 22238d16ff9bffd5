#include "services/surface/core/fused/surface_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <unordered_set>
#include <utility>

#include "common/voxel/grid_order.h"

namespace thalweg::surface {
namespace {

/// Whether a corner of the block's cells is inside a surface: one of its own voxels, or of the blocks above.
bool MayHaveSurface(const TruncatedVolume& volume, const VoxelIndex& block) {
  if (!volume.Find(block)) return false;
  for (int k = 0; k < 8; ++k) {
    const TruncatedVolume::Block* voxels = volume.Find(block + VoxelIndex{k & 1, k >> 1 & 1, k >> 2 & 1});
    if (voxels && voxels->has_inside) return true;
  }
  return false;
}

}  // namespace

std::span<const VoxelIndex> SurfaceMesh::Update(const TruncatedVolume& volume,
                                                std::span<const VoxelIndex> changed) {
  // A block's mesh reads its own voxels and those at the borders of all of its neighbors.
  std::unordered_set<VoxelIndex, VoxelIndexHash> concerned;
  for (const VoxelIndex& block : changed) {
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) concerned.insert(block + VoxelIndex{x, y, z});
      }
    }
  }
  updated_.clear();
  for (const VoxelIndex& block : concerned) {
    const auto known = blocks_.find(block);
    if (known == blocks_.end() && !MayHaveSurface(volume, block)) continue;
    BlockMesh mesh = MeshOf(volume, block);
    if (mesh.empty() && known == blocks_.end()) continue;
    if (known != blocks_.end()) Count(known->second, -1.0);
    Count(mesh, 1.0);
    updated_.push_back(block);
    if (mesh.empty()) {
      blocks_.erase(known);
    } else {
      blocks_.insert_or_assign(block, std::move(mesh));
    }
  }
  return updated_;
}

void SurfaceMesh::Count(const BlockMesh& mesh, double sign) {
  for (const auto& face : mesh.faces) {
    const auto corner = [&](std::size_t k) -> const BlockMesh::Vertex& { return mesh.vertices[face[k]]; };
    const Eigen::Vector3f across = (corner(1).p_W - corner(0).p_W).cross(corner(2).p_W - corner(0).p_W);
    const double third = sign * 0.5 * static_cast<double>(across.norm()) / 3.0;
    for (std::size_t k = 0; k < 3; ++k) {
      area_.seen += third;
      if (corner(k).best.inspected()) area_.inspected += third;
      if (corner(k).best.seen() && corner(k).best.sampling() <= limits_.sampling) area_.fine += third;
    }
  }
}

TriangleMesh SurfaceMesh::Joined() const {
  std::vector<VoxelIndex> order;
  order.reserve(blocks_.size());
  for (const auto& [index, mesh] : blocks_) order.push_back(index);
  std::ranges::sort(order, GridOrder());
  TriangleMesh joined;
  std::array<std::unordered_map<VoxelIndex, std::uint32_t, VoxelIndexHash>, 3> at_border;  // by axis
  constexpr int kCorners = TruncatedVolume::kEdge + 1;
  for (const VoxelIndex& index : order) {
    const BlockMesh& mesh = blocks_.at(index);
    std::vector<std::uint32_t> number;
    number.reserve(mesh.vertices.size());
    for (const BlockMesh::Vertex& vertex : mesh.vertices) {
      const int axis = vertex.edge % 3;
      const int from = vertex.edge / 3;
      const VoxelIndex in_block{from % kCorners, from / kCorners % kCorners, from / (kCorners * kCorners)};
      const auto next = static_cast<std::uint32_t>(joined.vertices_W.size());
      const auto is_border = [](int i) { return i == 0 || i == TruncatedVolume::kEdge; };
      if (is_border(in_block.x) || is_border(in_block.y) || is_border(in_block.z)) {
        const VoxelIndex voxel{index.x * TruncatedVolume::kEdge + in_block.x,
                               index.y * TruncatedVolume::kEdge + in_block.y,
                               index.z * TruncatedVolume::kEdge + in_block.z};
        const auto [known, is_new] = at_border[static_cast<std::size_t>(axis)].try_emplace(voxel, next);
        number.push_back(known->second);
        if (!is_new) continue;
      } else {
        number.push_back(next);
      }
      joined.vertices_W.push_back(vertex.p_W);
      joined.normals_W.push_back(vertex.normal_W);
      joined.colors.push_back(vertex.color);
    }
    for (const auto& face : mesh.faces) {
      const std::array<std::uint32_t, 3> corners = {number[face[0]], number[face[1]], number[face[2]]};
      joined.faces.push_back(corners);
    }
  }
  return joined;
}

}  // namespace thalweg::surface
