#include "services/gateway/core/surface_feed.h"

#include "services/gateway/core/cdr_writer.h"

namespace thalweg::gateway {
namespace {

template <class T>
void Append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

void SurfaceFeed::Update(const SurfaceChange& change) {
  stamp_ = change.stamp;
  voxel_size_ = change.voxel_size;
  if (change.replaced || !blocks_.has_begun()) blocks_.Restart();
  for (const SharedMeshBlock& mesh : change.blocks) blocks_.Set(mesh->block, mesh);
}

std::optional<Feed::Message> SurfaceFeed::Next(std::uint64_t& cursor) const {
  std::vector<std::int32_t> position;
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> triangles;
  SurfaceMeshBlock all;
  const auto reset = blocks_.TakeSince(cursor, [&](const VoxelIndex& block, const SharedMeshBlock& shared) {
    const SurfaceMeshBlock& mesh = *shared;
    const std::size_t bytes = sizeof(float) * (all.points_m.size() + mesh.points_m.size()) +
                              sizeof(std::uint16_t) * (all.faces.size() + mesh.faces.size());
    if (!position.empty() && bytes > kMostBytes) return false;
    for (const std::int32_t c : {block.x, block.y, block.z}) position.push_back(c);
    vertices.push_back(static_cast<std::uint32_t>(mesh.points_m.size() / 3));
    triangles.push_back(static_cast<std::uint32_t>(mesh.faces.size() / 3));
    Append(all.points_m, mesh.points_m);
    Append(all.normals, mesh.normals);
    Append(all.colors, mesh.colors);
    Append(all.views, mesh.views);
    Append(all.faces, mesh.faces);
    return true;
  });
  if (!reset) return std::nullopt;
  CdrWriter cdr;
  cdr.Put(voxel_size_);
  cdr.Put(static_cast<std::uint8_t>(*reset));
  cdr.PutSequence(position);
  cdr.PutSequence(vertices);
  cdr.PutSequence(triangles);
  cdr.PutSequence(all.points_m);
  cdr.PutSequence(all.normals);
  cdr.PutSequence(all.colors);
  cdr.PutSequence(all.views);
  cdr.PutSequence(all.faces);
  return Message{stamp_, std::make_shared<const std::vector<std::uint8_t>>(cdr.Take())};
}

}  // namespace thalweg::gateway
