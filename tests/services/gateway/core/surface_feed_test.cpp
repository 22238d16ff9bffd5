#include "services/gateway/core/surface_feed.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <map>

namespace thalweg::gateway {
namespace {

using Place = std::array<std::int32_t, 3>;

/// A block of so many triangles, each with vertices of its own.
SharedMeshBlock MeshBlock(int x, std::size_t triangles, std::uint8_t color = 7) {
  SurfaceMeshBlock block{.block = {x, 0, 0}};
  for (std::size_t k = 0; k < 3 * triangles; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      block.points_m.push_back(static_cast<float>(x));
      block.normals.push_back(254);
      block.colors.push_back(color);
    }
    block.views.push_back(1);
    block.faces.push_back(static_cast<std::uint16_t>(k));
  }
  return std::make_shared<const SurfaceMeshBlock>(std::move(block));
}

/// A client's copy, read from the bytes by hand: the color of each block that has a mesh.
class MeshCopy {
 public:
  /// @return Number of blocks in the message; -1 = there was none.
  int Read(const SurfaceFeed& feed) {
    const std::optional<Feed::Message> message = feed.Next(cursor_);
    if (!message) return -1;
    bytes_ = *message->bytes;
    at_ = 4 + sizeof(double);
    if (bytes_[at_++] == 1) colors.clear();
    const auto position = Sequence<std::int32_t>();
    const auto vertices = Sequence<std::uint32_t>();
    const auto triangles = Sequence<std::uint32_t>();
    const auto points = Sequence<float>();
    const auto normals = Sequence<std::uint8_t>();
    const auto its_colors = Sequence<std::uint8_t>();
    const auto views = Sequence<std::uint8_t>();
    const auto faces = Sequence<std::uint16_t>();
    EXPECT_EQ(at_, bytes_.size());
    EXPECT_EQ(points.size(), normals.size());
    EXPECT_EQ(points.size(), its_colors.size());
    EXPECT_EQ(points.size(), 3 * views.size());
    std::size_t vertex = 0;
    std::size_t corners = 0;
    for (std::size_t n = 0; n < vertices.size(); ++n) {
      const Place place{position[3 * n], position[3 * n + 1], position[3 * n + 2]};
      colors.erase(place);
      if (vertices[n] > 0) {
        colors[place] = its_colors[3 * vertex];
        EXPECT_EQ(points[3 * vertex], static_cast<float>(place[0]));
      }
      vertex += vertices[n];
      corners += 3 * triangles[n];
    }
    EXPECT_EQ(vertex, views.size());
    EXPECT_EQ(corners, faces.size());
    return static_cast<int>(vertices.size());
  }
  int ReadAll(const SurfaceFeed& feed) {
    int messages = 0;
    while (Read(feed) >= 0) ++messages;
    return messages;
  }

  std::map<Place, int> colors;

 private:
  template <class T>
  std::vector<T> Sequence() {
    const auto align = [this](std::size_t size) { at_ = 4 + (at_ - 4 + size - 1) / size * size; };
    align(sizeof(std::uint32_t));
    std::uint32_t count = 0;
    std::memcpy(&count, &bytes_[at_], sizeof count);
    at_ += sizeof count;
    std::vector<T> values(count);
    if (count == 0) return values;
    align(sizeof(T));
    std::memcpy(values.data(), &bytes_[at_], count * sizeof(T));
    at_ += count * sizeof(T);
    return values;
  }

  std::uint64_t cursor_ = 0;
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

TEST(SurfaceFeed, SendsTheWholeMeshAndThenOnlyWhatChanged) {
  SurfaceFeed feed;
  MeshCopy copy;
  EXPECT_EQ(copy.Read(feed), -1) << "there is no mesh yet";
  feed.Update({.stamp = {},
               .voxel_size = 0.02,
               .replaced = true,
               .blocks = {MeshBlock(1, 2), MeshBlock(2, 1), MeshBlock(-3, 5)}});
  copy.ReadAll(feed);
  EXPECT_EQ(copy.colors.size(), 3U);
  feed.Update({.stamp = {}, .voxel_size = 0.02, .replaced = false, .blocks = {MeshBlock(2, 4, 9)}});
  EXPECT_EQ(copy.Read(feed), 1);
  EXPECT_EQ(copy.colors.at({2, 0, 0}), 9);
  feed.Update({.stamp = {}, .voxel_size = 0.02, .replaced = false, .blocks = {MeshBlock(1, 0)}});
  EXPECT_EQ(copy.Read(feed), 1);
  EXPECT_EQ(copy.colors.size(), 2U);
  EXPECT_EQ(copy.Read(feed), -1);
  MeshCopy late;
  late.ReadAll(feed);
  EXPECT_EQ(late.colors, copy.colors);
}

TEST(SurfaceFeed, ASlowClientGetsEachBlockOnce) {
  SurfaceFeed feed;
  for (int k = 0; k < 50; ++k) {
    feed.Update({.stamp = {},
                 .voxel_size = 0.02,
                 .replaced = false,
                 .blocks = {MeshBlock(1, 3, static_cast<std::uint8_t>(k))}});
  }
  MeshCopy copy;
  EXPECT_EQ(copy.Read(feed), 1);
  EXPECT_EQ(copy.colors.at({1, 0, 0}), 49);
}

TEST(SurfaceFeed, ALargeMeshComesInParts) {
  SurfaceFeed feed;
  SurfaceChange change{.stamp = {}, .voxel_size = 0.02, .replaced = true, .blocks = {}};
  for (int x = 0; x < 400; ++x) change.blocks.push_back(MeshBlock(x, 200));
  feed.Update(change);
  MeshCopy copy;
  EXPECT_EQ(copy.ReadAll(feed), 4) << "400 blocks of 600 vertices and corners take 3.4 MB";
  EXPECT_EQ(copy.colors.size(), 400U);
}

TEST(SurfaceFeed, AReplacedMeshBeginsAnew) {
  SurfaceFeed feed;
  MeshCopy copy;
  feed.Update(
      {.stamp = {}, .voxel_size = 0.02, .replaced = true, .blocks = {MeshBlock(1, 2), MeshBlock(2, 1)}});
  copy.ReadAll(feed);
  feed.Update({.stamp = {}, .voxel_size = 0.02, .replaced = true, .blocks = {MeshBlock(5, 2)}});
  copy.ReadAll(feed);
  EXPECT_EQ(copy.colors.size(), 1U);
}

}  // namespace
}  // namespace thalweg::gateway
