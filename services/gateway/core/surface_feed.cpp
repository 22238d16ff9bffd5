#include "services/gateway/core/surface_feed.h"

#include <algorithm>

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
  if (change.replaced || start_ == 0) {
    blocks_.clear();
    by_change_.clear();
    start_ = ++changes_;
  }
  for (const SharedMeshBlock& mesh : change.blocks) {
    Entry& entry = blocks_[mesh->block];
    if (entry.changed != 0) by_change_.erase(entry.changed);
    entry = {++changes_, mesh};
    by_change_[entry.changed] = mesh->block;
  }
}

std::optional<Feed::Message> SurfaceFeed::Next(std::uint64_t& cursor) const {
  if (start_ == 0) return std::nullopt;
  const bool reset = cursor < start_;
  auto change = by_change_.upper_bound(cursor);
  if (!reset && change == by_change_.end()) return std::nullopt;
  std::vector<std::int32_t> position;
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> triangles;
  SurfaceMeshBlock all;
  cursor = std::max(cursor, start_);
  for (; change != by_change_.end(); ++change) {
    const SurfaceMeshBlock& mesh = *blocks_.at(change->second).mesh;
    const std::size_t bytes = sizeof(float) * (all.points_m.size() + mesh.points_m.size()) +
                              sizeof(std::uint16_t) * (all.faces.size() + mesh.faces.size());
    if (!position.empty() && bytes > kMostBytes) break;
    cursor = change->first;
    for (const std::int32_t c : {mesh.block.x, mesh.block.y, mesh.block.z}) position.push_back(c);
    vertices.push_back(static_cast<std::uint32_t>(mesh.points_m.size() / 3));
    triangles.push_back(static_cast<std::uint32_t>(mesh.faces.size() / 3));
    Append(all.points_m, mesh.points_m);
    Append(all.normals, mesh.normals);
    Append(all.colors, mesh.colors);
    Append(all.views, mesh.views);
    Append(all.faces, mesh.faces);
  }
  CdrWriter cdr;
  cdr.Put(voxel_size_);
  cdr.Put(static_cast<std::uint8_t>(reset));
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
