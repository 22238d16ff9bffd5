#include "services/surface/core/fused/mesh_patches.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <unordered_set>
#include <utility>

#include "common/base/check.h"
#include "common/voxel/for_each_voxel.h"

namespace thalweg::surface {
namespace {

constexpr double kNoPath = std::numeric_limits<double>::infinity();

/// Whether two ascending sequences have an element in common.
bool HaveInCommon(const std::vector<MeshVertex::Id>& a, const std::vector<MeshVertex::Id>& b) {
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() && j != b.end()) {
    if (*i == *j) return true;
    if (*i < *j) {
      ++i;
    } else {
      ++j;
    }
  }
  return false;
}

double Between(const Eigen::Vector3f& a_W, const Eigen::Vector3f& b_W) {
  return static_cast<double>((a_W - b_W).norm());
}

}  // namespace

/// The connected pieces of one block.
struct MeshPatches::Pieces {
  std::vector<std::uint16_t> of_vertex;
  std::vector<Patch> patches;  ///< Without neighbors.
};

MeshPatches::Pieces MeshPatches::PiecesOf(const VoxelIndex& block, const BlockMesh& mesh) {
  std::vector<std::uint16_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), std::uint16_t{0});
  const auto root = [&](std::uint16_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& face : mesh.faces) {
    for (const std::size_t k : {1U, 2U}) {
      const auto [low, high] = std::minmax({root(face[0]), root(face[k])});
      parent[high] = low;
    }
  }
  Pieces pieces;
  std::vector<float> counts;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    // A root comes before all that it stands for, so that its own entry is known.
    const std::uint16_t its_root = root(static_cast<std::uint16_t>(i));
    if (its_root == i) {
      pieces.of_vertex.push_back(static_cast<std::uint16_t>(pieces.patches.size()));
      pieces.patches.emplace_back();
      counts.push_back(0.0F);
    } else {
      pieces.of_vertex.push_back(pieces.of_vertex[its_root]);
    }
    Patch& patch = pieces.patches[pieces.of_vertex.back()];
    patch.center_W += mesh.vertices[i].p_W;
    counts[pieces.of_vertex.back()] += 1.0F;
    const MeshVertex vertex = MeshVertex::Of(block, mesh.vertices[i].edge);
    if (IsOnRim(block, vertex)) patch.rim.push_back(vertex.id());
  }
  for (std::size_t k = 0; k < pieces.patches.size(); ++k) {
    pieces.patches[k].center_W /= counts[k];
    std::ranges::sort(pieces.patches[k].rim);
  }
  return pieces;
}

/// Takes over the mesh of a block. Returns whether its neighborhood may be another.
bool MeshPatches::Refresh(const VoxelIndex& block, const BlockMesh* mesh) {
  const auto known = blocks_.find(block);
  if (!mesh) {
    if (known == blocks_.end()) return false;
    unused_.insert(unused_.end(), known->second.patches.begin(), known->second.patches.end());
    blocks_.erase(known);
    return true;
  }
  Pieces pieces = PiecesOf(block, *mesh);
  Block& entry = known == blocks_.end() ? blocks_[block] : known->second;
  bool same_rims = entry.patches.size() == pieces.patches.size();
  for (std::size_t k = 0; same_rims && k < pieces.patches.size(); ++k) {
    same_rims = patches_[entry.patches[k]].rim == pieces.patches[k].rim;
  }
  const auto name_vertices = [&] {
    entry.patch_of_vertex.clear();
    for (const std::uint16_t k : pieces.of_vertex) entry.patch_of_vertex.push_back(entry.patches[k]);
  };
  if (same_rims) {
    for (std::size_t k = 0; k < pieces.patches.size(); ++k) {
      patches_[entry.patches[k]].center_W = pieces.patches[k].center_W;
    }
    name_vertices();
    return false;
  }
  unused_.insert(unused_.end(), entry.patches.begin(), entry.patches.end());
  entry.patches.clear();
  for (Patch& patch : pieces.patches) {
    if (unused_.empty()) {
      unused_.push_back(static_cast<Id>(patches_.size()));
      patches_.emplace_back();
    }
    const Id id = unused_.back();
    unused_.pop_back();
    patches_[id] = std::move(patch);
    entry.patches.push_back(id);
  }
  name_vertices();
  return true;
}

void MeshPatches::Connect(const VoxelIndex& block) {
  const auto own = blocks_.find(block);
  if (own == blocks_.end()) return;
  for (const Id id : own->second.patches) patches_[id].neighbors.clear();
  ForEachVoxel(CubeAround(block, 1), [&](const VoxelIndex& around) {
    const auto other = blocks_.find(around);
    if (other == blocks_.end() || around == block) return;
    for (const Id id : own->second.patches) {
      for (const Id neighbor : other->second.patches) {
        if (HaveInCommon(patches_[id].rim, patches_[neighbor].rim))
          patches_[id].neighbors.push_back(neighbor);
      }
    }
  });
}

void MeshPatches::Update(const SurfaceMesh& mesh, std::span<const VoxelIndex> updated) {
  std::unordered_set<VoxelIndex, VoxelIndexHash> concerned;
  for (const VoxelIndex& block : updated) {
    const auto found = mesh.blocks().find(block);
    if (!Refresh(block, found == mesh.blocks().end() ? nullptr : &found->second)) continue;
    ForEachVoxel(CubeAround(block, 1), [&](const VoxelIndex& around) { concerned.insert(around); });
  }
  for (const VoxelIndex& block : concerned) Connect(block);
}

const std::vector<MeshPatches::Id>& MeshPatches::PatchesOf(const VoxelIndex& block) const {
  const auto found = blocks_.find(block);
  THALWEG_CHECK(found != blocks_.end());
  return found->second.patch_of_vertex;
}

std::optional<MeshPatches::Place> MeshPatches::Nearest(const SurfaceMesh& mesh, const Eigen::Vector3d& p_W,
                                                       double voxel_size) const {
  // A block's cells begin at the center of its first voxel.
  const Eigen::Vector3d shifted_W = p_W - Eigen::Vector3d::Constant(0.5 * voxel_size);
  std::optional<Place> nearest;
  float least = std::numeric_limits<float>::infinity();
  ForEachVoxel(CubeAround(BlockOf(VoxelAt(shifted_W, voxel_size)), 1), [&](const VoxelIndex& block) {
    const auto found = mesh.blocks().find(block);
    if (found == mesh.blocks().end()) return;
    const auto& vertices = found->second.vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const float distance = (vertices[i].p_W - p_W.cast<float>()).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      nearest = {PatchesOf(block)[i], vertices[i].p_W};
    }
  });
  return nearest;
}

MeshPatches::Paths::Paths(const MeshPatches& patches, const Place& start)
    : patches_(patches), start_(start), lengths_(patches.patches_.size(), kNoPath) {
  using Entry = std::pair<double, Id>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  lengths_[start.patch] = 0.0;
  next.emplace(0.0, start.patch);
  while (!next.empty()) {
    const auto [length, id] = next.top();
    next.pop();
    if (length > lengths_[id]) continue;
    const Patch& patch = patches.patches_[id];
    const Eigen::Vector3f& from_W = id == start.patch ? start.p_W : patch.center_W;
    for (const Id neighbor : patch.neighbors) {
      const double beyond = length + Between(from_W, patches.patches_[neighbor].center_W);
      if (beyond >= lengths_[neighbor]) continue;
      lengths_[neighbor] = beyond;
      next.emplace(beyond, neighbor);
    }
  }
}

double MeshPatches::Paths::To(const Place& place) const {
  if (place.patch == start_.patch) return Between(start_.p_W, place.p_W);
  double least = kNoPath;
  for (const Id neighbor : patches_.patches_[place.patch].neighbors) {
    const Eigen::Vector3f& from_W =
        neighbor == start_.patch ? start_.p_W : patches_.patches_[neighbor].center_W;
    least = std::min(least, lengths_[neighbor] + Between(from_W, place.p_W));
  }
  return least;
}

}  // namespace thalweg::surface
