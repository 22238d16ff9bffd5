#include "services/surface/core/fused/block_mesh.h"

#include <algorithm>
#include <cmath>

#include "services/surface/core/fused/marching_cubes.h"

namespace thalweg::surface {
namespace {

constexpr int kEdge = TruncatedVolume::kEdge;
constexpr int kCornerEdge = kEdge + 1;  // corners of the cells along an axis
constexpr int kBorder = 1;              // voxels beyond the corners, for central differences
constexpr int kCopyEdge = kCornerEdge + 2 * kBorder;
constexpr float kMostChange = 2.0F;  // along an edge through a surface, in its lengths

/// The voxels of a block and around it.
class Copy {
 public:
  Copy(const TruncatedVolume& volume, const VoxelIndex& block) {
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) CopyFrom(volume.Find(block + VoxelIndex{x, y, z}), x, y, z);
      }
    }
  }

  /// @param x, y, z  -1 to 9, from the block's first voxel; nullptr if unknown.
  const SurfaceVoxel* At(int x, int y, int z) const { return voxels_[Offset(x, y, z)]; }
  const SurfaceVoxel* At(const VoxelIndex& i) const { return At(i.x, i.y, i.z); }

  /// Central differences, or one-sided where one of the neighbors is unknown.
  Eigen::Vector3f Gradient(const VoxelIndex& i) const {
    Eigen::Vector3f gradient = Eigen::Vector3f::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const VoxelIndex step = kFaceNeighbors[2 * axis];
      const SurfaceVoxel* before = At(i - step);
      const SurfaceVoxel* behind = At(i + step);
      const SurfaceVoxel* here = At(i);
      const float length = before && behind ? 2.0F : 1.0F;
      if (!before) before = here;
      if (!behind) behind = here;
      gradient[axis] = (behind->distance - before->distance) / length;
    }
    return gradient;
  }

 private:
  static std::size_t Offset(int x, int y, int z) {
    return static_cast<std::size_t>(((z + kBorder) * kCopyEdge + y + kBorder) * kCopyEdge + x + kBorder);
  }
  void CopyFrom(const TruncatedVolume::Block* block, int bx, int by, int bz) {
    if (!block) return;
    const auto first = [](int b) { return std::max(b * kEdge, -kBorder); };
    const auto last = [](int b) { return std::min(b * kEdge + kEdge - 1, kCornerEdge - 1 + kBorder); };
    for (int z = first(bz); z <= last(bz); ++z) {
      for (int y = first(by); y <= last(by); ++y) {
        for (int x = first(bx); x <= last(bx); ++x) {
          const SurfaceVoxel& voxel =
              block->voxels[TruncatedVolume::OffsetOf(x - bx * kEdge, y - by * kEdge, z - bz * kEdge)];
          if (voxel.known()) voxels_[Offset(x, y, z)] = &voxel;
        }
      }
    }
  }

  std::array<const SurfaceVoxel*, kCopyEdge * kCopyEdge * kCopyEdge> voxels_{};
};

class Mesher {
 public:
  Mesher(const TruncatedVolume& volume, const VoxelIndex& block)
      : voxel_size_(static_cast<float>(volume.voxel_size())),
        most_change_(kMostChange * voxel_size_),
        first_W_(VoxelCenter({block.x * kEdge, block.y * kEdge, block.z * kEdge}, volume.voxel_size())),
        copy_(volume, block) {
    vertex_of_edge_.fill(kNone);
  }

  BlockMesh Run() {
    VoxelIndex i;
    for (i.z = 0; i.z < kEdge; ++i.z) {
      for (i.y = 0; i.y < kEdge; ++i.y) {
        for (i.x = 0; i.x < kEdge; ++i.x) AddCell(i);
      }
    }
    return std::move(mesh_);
  }

 private:
  static constexpr std::uint16_t kNone = 0xFFFF;

  static VoxelIndex Corner(const VoxelIndex& cell, int corner) {
    return cell + VoxelIndex{corner & 1, corner >> 1 & 1, corner >> 2 & 1};
  }

  void AddCell(const VoxelIndex& cell) {
    std::array<const SurfaceVoxel*, MarchingCubes::kCorners> corners;
    unsigned inside = 0;
    for (int c = 0; c < MarchingCubes::kCorners; ++c) {
      const SurfaceVoxel* voxel = copy_.At(Corner(cell, c));
      if (!voxel) return;
      corners[static_cast<std::size_t>(c)] = voxel;
      if (voxel->distance < 0.0F) inside |= 1U << c;
    }
    if (inside == 0 || inside == 0xFF) return;
    for (int edge = 0; edge < MarchingCubes::kEdges; ++edge) {
      const float a = corners[static_cast<std::size_t>(MarchingCubes::EdgeStart(edge))]->distance;
      const float b = corners[static_cast<std::size_t>(MarchingCubes::EdgeEnd(edge))]->distance;
      if ((a < 0.0F) != (b < 0.0F) && std::abs(a - b) > most_change_) return;
    }
    for (const auto& triangle : MarchingCubes::TrianglesOf(static_cast<std::uint8_t>(inside))) {
      std::array<std::uint16_t, 3> face;
      for (std::size_t k = 0; k < 3; ++k) face[k] = VertexOn(cell, triangle[k]);
      mesh_.faces.push_back(face);
    }
  }

  std::uint16_t VertexOn(const VoxelIndex& cell, int edge) {
    const VoxelIndex from = Corner(cell, MarchingCubes::EdgeStart(edge));
    const VoxelIndex to = Corner(cell, MarchingCubes::EdgeEnd(edge));
    const int key = edge / 4 + 3 * (from.x + kCornerEdge * (from.y + kCornerEdge * from.z));
    std::uint16_t& known = vertex_of_edge_[static_cast<std::size_t>(key)];
    if (known != kNone) return known;
    const SurfaceVoxel& a = *copy_.At(from);
    const SurfaceVoxel& b = *copy_.At(to);
    const float share = a.distance / (a.distance - b.distance);
    const Eigen::Vector3f start(static_cast<float>(from.x), static_cast<float>(from.y),
                                static_cast<float>(from.z));
    Eigen::Vector3f place = start;
    place[edge / 4] += share;
    const SurfaceVoxel& nearer = share < 0.5F ? a : b;
    const SurfaceVoxel& other = share < 0.5F ? b : a;
    const Eigen::Vector3f gradient =
        copy_.Gradient(from) + share * (copy_.Gradient(to) - copy_.Gradient(from));
    BlockMesh::Vertex vertex{.p_W = (first_W_ + (voxel_size_ * place).cast<double>()).cast<float>(),
                             .normal_W = Eigen::Vector3f::UnitZ(),
                             .best = nearer.best.seen() ? nearer.best : other.best,
                             .edge = static_cast<std::uint16_t>(key)};
    if (gradient.norm() > 0.0F) vertex.normal_W = gradient.normalized();
    if (nearer.colored || other.colored) vertex.color = nearer.colored ? nearer.color : other.color;
    if (a.colored && b.colored) vertex.color = Mixed(a.color, b.color, share);
    known = static_cast<std::uint16_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(vertex);
    return known;
  }

  static Rgb Mixed(const Rgb& a, const Rgb& b, float share) {
    const auto mix = [share](std::uint8_t from, std::uint8_t to) {
      const auto value = static_cast<float>(from);
      return static_cast<std::uint8_t>(std::lround(value + share * (static_cast<float>(to) - value)));
    };
    return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
  }

  float voxel_size_;
  float most_change_;
  Eigen::Vector3d first_W_;
  Copy copy_;
  std::array<std::uint16_t, 3 * kCornerEdge * kCornerEdge * kCornerEdge> vertex_of_edge_;
  BlockMesh mesh_;
};

}  // namespace

BlockMesh MeshOf(const TruncatedVolume& volume, const VoxelIndex& block) {
  return Mesher(volume, block).Run();
}

}  // namespace thalweg::surface
