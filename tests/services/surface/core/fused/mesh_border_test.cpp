#include "services/surface/core/fused/mesh_border.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "tests/services/surface/core/fused/volumes.h"

namespace thalweg::surface {
namespace {

using EdgeSet = std::set<std::pair<MeshVertex::Id, MeshVertex::Id>>;

/// By definition: edges of exactly one face of the whole mesh.
EdgeSet BorderByCounting(const SurfaceMesh& mesh) {
  std::map<std::pair<MeshVertex::Id, MeshVertex::Id>, int> excess;
  for (const auto& [block, its] : mesh.blocks()) {
    for (const auto& face : its.faces) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto from = MeshVertex::Of(block, its.vertices[face[k]].edge).id();
        const auto to = MeshVertex::Of(block, its.vertices[face[(k + 1) % 3]].edge).id();
        ++excess[{from, to}];
        --excess[{to, from}];
      }
    }
  }
  EdgeSet border;
  for (const auto& [edge, sides] : excess) {
    EXPECT_LE(std::abs(sides), 1);
    if (sides > 0) border.insert(edge);
  }
  return border;
}

EdgeSet EdgesOf(const SurfaceMesh& mesh, const MeshBorder& border) {
  EdgeSet edges;
  for (const auto& [block, its] : border.edges()) {
    const BlockMesh& block_mesh = mesh.blocks().at(block);
    for (const BorderEdge& edge : its) {
      EXPECT_TRUE(edges.emplace(edge.from, edge.to).second) << "each once";
      EXPECT_EQ(MeshVertex::Of(block, block_mesh.vertices[edge.from_index].edge).id(), edge.from);
      EXPECT_EQ(MeshVertex::Of(block, block_mesh.vertices[edge.to_index].edge).id(), edge.to);
    }
  }
  return edges;
}

TEST(MeshVertex, HasTheSameIdInAllBlocksThatHaveIt) {
  constexpr int kCorners = TruncatedVolume::kEdge + 1;
  const auto edge = [](int axis, int x, int y, int z) {
    return static_cast<std::uint16_t>(axis + 3 * (x + kCorners * (y + kCorners * z)));
  };
  EXPECT_EQ(MeshVertex::Of({-1, 2, 5}, edge(2, 8, 8, 3)).id(),
            MeshVertex::Of({0, 3, 5}, edge(2, 0, 0, 3)).id());
  EXPECT_NE(MeshVertex::Of({0, 0, 0}, edge(2, 8, 8, 3)).id(),
            MeshVertex::Of({0, 0, 0}, edge(1, 8, 8, 3)).id());
  for (const VoxelIndex& voxel :
       {VoxelIndex{-1, 0, 7}, VoxelIndex{1234, -4321, 524287}, VoxelIndex{-524288, 9, -9}}) {
    const MeshVertex vertex = MeshVertex::Of(MeshVertex{voxel, 2}.id());
    EXPECT_EQ(vertex.voxel, voxel);
    EXPECT_EQ(vertex.axis, 2);
  }
}

TEST(MeshBorder, OfAClosedMeshIsEmpty) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> distance(-1.0, 1.0);
  const TruncatedVolume volume = test::VolumeOf(1.0, [&](int x, int y, int z) {
    const bool is_outermost = std::min({x, y, z}) == -8 || std::max({x, y, z}) == 15;
    return is_outermost ? 0.5 : distance(random);
  });
  SurfaceMesh mesh({});
  MeshBorder border;
  border.Update(mesh, mesh.Update(volume, test::AllBlocks(volume)));
  ASSERT_GT(mesh.blocks().size(), 20U);
  EXPECT_TRUE(border.edges().empty());
}

TEST(MeshBorder, AfterEachUpdateHasTheEdgesOfExactlyOneFace) {
  // Random signs and holes: every case of a cell beside every other.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> distance(-1.0, 1.0);
  TruncatedVolume volume = test::VolumeOf(1.0, [&](int, int, int) { return distance(random); });
  SurfaceMesh mesh({});
  MeshBorder border;
  border.Update(mesh, mesh.Update(volume, test::AllBlocks(volume)));
  std::uniform_int_distribution<int> place(-8, 15);
  std::bernoulli_distribution known(0.5);
  for (int k = 0; k < 60; ++k) {
    const VoxelIndex low{place(random), place(random), place(random)};
    const int size = k % 5;
    const VoxelIndex high{std::min(low.x + size, 15), std::min(low.y + size, 15), std::min(low.z + size, 15)};
    test::SetKnown(volume, low, high, known(random));
    test::VoxelOf(volume, high.x, high.y, high.z).distance = static_cast<float>(distance(random));
    std::set<std::tuple<int, int, int>> blocks;
    for (int z = low.z >> 3; z <= high.z >> 3; ++z) {
      for (int y = low.y >> 3; y <= high.y >> 3; ++y) {
        for (int x = low.x >> 3; x <= high.x >> 3; ++x) blocks.emplace(x, y, z);
      }
    }
    std::vector<VoxelIndex> changed;
    for (const auto& [x, y, z] : blocks) changed.push_back({x, y, z});
    border.Update(mesh, mesh.Update(volume, changed));
    const EdgeSet by_counting = BorderByCounting(mesh);
    ASSERT_GT(by_counting.size(), 500U);
    ASSERT_EQ(EdgesOf(mesh, border), by_counting) << k;
  }
}

}  // namespace
}  // namespace thalweg::surface
