#include "services/surface/core/fused/mesh_border.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <unordered_set>
#include <utility>

namespace thalweg::surface {
namespace {

std::pair<MeshVertex::Id, MeshVertex::Id> EndsOf(const BorderEdge& edge) {
  return {edge.from, edge.to};
}

/// The edges of a block's faces whose opposite no other face of the block has, in ascending order of their
/// ends.
MeshBorder::Edges OpenEdgesOf(const VoxelIndex& block, const BlockMesh& mesh) {
  // Each side of a face is kept at its lower vertex until its opposite comes.
  struct Side {
    std::uint16_t high = 0;  // the other vertex
    bool ascends = false;
  };
  std::vector<std::uint32_t> first(mesh.vertices.size() + 1);  // of each vertex, in `sides`
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) ++first[std::min(face[k], face[(k + 1) % 3]) + 1U];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> last(first.begin(), first.end() - 1);
  std::vector<Side> sides(first.back());
  for (const auto& face : mesh.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const bool ascends = face[k] < face[(k + 1) % 3];
      const std::uint16_t low = ascends ? face[k] : face[(k + 1) % 3];
      const std::uint16_t high = ascends ? face[(k + 1) % 3] : face[k];
      const auto is_opposite = [&](const Side& side) { return side.high == high && side.ascends != ascends; };
      const auto begin = sides.begin() + first[low];
      const auto end = sides.begin() + last[low];
      const auto opposite = std::find_if(begin, end, is_opposite);
      if (opposite == end) {
        *end = {high, ascends};
        ++last[low];
      } else {
        *opposite = *(end - 1);
        --last[low];
      }
    }
  }
  MeshBorder::Edges open;
  for (std::size_t low = 0; low < mesh.vertices.size(); ++low) {
    for (std::uint32_t k = first[low]; k < last[low]; ++k) {
      auto from = static_cast<std::uint16_t>(low);
      std::uint16_t to = sides[k].high;
      if (!sides[k].ascends) std::swap(from, to);
      open.push_back({.from = MeshVertex::Of(block, mesh.vertices[from].edge).id(),
                      .to = MeshVertex::Of(block, mesh.vertices[to].edge).id(),
                      .from_index = from,
                      .to_index = to});
    }
  }
  std::ranges::sort(open, {}, EndsOf);
  return open;
}

/// The block beyond the face in which an edge of a block lies, if the block ends there.
std::optional<VoxelIndex> Beyond(const VoxelIndex& block, const BorderEdge& edge) {
  const MeshVertex from = MeshVertex::Of(edge.from);
  const MeshVertex to = MeshVertex::Of(edge.to);
  const auto along = [&](std::int32_t VoxelIndex::*axis) -> int {
    const int first = (block.*axis) * TruncatedVolume::kEdge;
    if (from.voxel.*axis != to.voxel.*axis) return 0;
    return from.voxel.*axis == first ? -1 : from.voxel.*axis == first + TruncatedVolume::kEdge ? 1 : 0;
  };
  const auto is_across = [&](int axis) { return from.axis != axis && to.axis != axis; };
  if (const int x = along(&VoxelIndex::x); x != 0 && is_across(0)) return block + VoxelIndex{x, 0, 0};
  if (const int y = along(&VoxelIndex::y); y != 0 && is_across(1)) return block + VoxelIndex{0, y, 0};
  if (const int z = along(&VoxelIndex::z); z != 0 && is_across(2)) return block + VoxelIndex{0, 0, z};
  return std::nullopt;
}

}  // namespace

/// Whether the block beyond an open edge has the opposite one.
bool MeshBorder::GoesOn(const VoxelIndex& block, const BorderEdge& edge) const {
  const std::optional<VoxelIndex> beyond = Beyond(block, edge);
  if (!beyond) return false;
  const auto neighbor = open_.find(*beyond);
  if (neighbor == open_.end()) return false;
  return std::ranges::binary_search(neighbor->second, std::pair(edge.to, edge.from), {}, EndsOf);
}

void MeshBorder::Update(const SurfaceMesh& mesh, std::span<const VoxelIndex> updated) {
  std::unordered_set<VoxelIndex, VoxelIndexHash> concerned;
  for (const VoxelIndex& block : updated) {
    const auto found = mesh.blocks().find(block);
    Edges open = found == mesh.blocks().end() ? Edges() : OpenEdgesOf(block, found->second);
    const auto known = open_.find(block);
    if (known == open_.end() ? open.empty() : known->second == open) continue;
    if (open.empty()) {
      open_.erase(known);
    } else {
      open_.insert_or_assign(block, std::move(open));
    }
    concerned.insert(block);
    for (const VoxelIndex& step : kFaceNeighbors) concerned.insert(block + step);
  }
  for (const VoxelIndex& block : concerned) {
    Edges edges;
    if (const auto open = open_.find(block); open != open_.end()) {
      for (const BorderEdge& edge : open->second) {
        if (!GoesOn(block, edge)) edges.push_back(edge);
      }
    }
    if (edges.empty()) {
      border_.erase(block);
    } else {
      border_.insert_or_assign(block, std::move(edges));
    }
  }
}

}  // namespace thalweg::surface
