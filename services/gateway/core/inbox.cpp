#include "services/gateway/core/inbox.h"

#include <utility>

namespace thalweg::gateway {

bool Inbox::Put(Item item) {
  const std::lock_guard lock(mutex_);
  const bool was_empty = is_empty();
  Queue& queue = queues_[item.topic];
  queue.bytes += item.message->size();
  queue.messages.push_back({++numbers_, std::move(item)});
  while (queue.messages.size() > kMostMessages || (queue.messages.size() > 1 && queue.bytes > kMostBytes)) {
    queue.bytes -= queue.messages.front().item.message->size();
    queue.messages.pop_front();
    ++replaced_;
  }
  return was_empty;
}

bool Inbox::Put(const MapChange& change) {
  const std::lock_guard lock(mutex_);
  const bool was_empty = is_empty();
  if (change.replaced) blocks_.clear();
  const bool replaced = change.replaced || (map_ && map_->replaced);
  map_ = MapChange{change.stamp, change.voxel_size, replaced, {}};
  for (const BlockStates& block : change.blocks) blocks_[block.block] = block.octets;
  return was_empty;
}

bool Inbox::Put(const SurfaceChange& change) {
  const std::lock_guard lock(mutex_);
  const bool was_empty = is_empty();
  if (change.replaced) meshes_.clear();
  const bool replaced = change.replaced || (surface_ && surface_->replaced);
  surface_ = SurfaceChange{change.stamp, change.voxel_size, replaced, {}};
  for (const SharedMeshBlock& mesh : change.blocks) meshes_[mesh->block] = mesh;
  return was_empty;
}

Inbox::Content Inbox::TakeAll() {
  const std::lock_guard lock(mutex_);
  Content content;
  std::map<std::uint64_t, Item> in_order;
  for (auto& [topic, queue] : queues_) {
    for (Waiting& waiting : queue.messages) in_order.emplace(waiting.number, std::move(waiting.item));
  }
  for (auto& [number, item] : in_order) content.items.push_back(std::move(item));
  content.map = std::exchange(map_, std::nullopt);
  if (content.map) {
    for (const auto& [index, octets] : blocks_) content.map->blocks.push_back({index, octets});
  }
  content.surface = std::exchange(surface_, std::nullopt);
  if (content.surface) {
    for (const auto& [index, mesh] : meshes_) content.surface->blocks.push_back(mesh);
  }
  queues_.clear();
  blocks_.clear();
  meshes_.clear();
  return content;
}

std::uint64_t Inbox::TakeReplaced() {
  const std::lock_guard lock(mutex_);
  return std::exchange(replaced_, 0);
}

}  // namespace thalweg::gateway
