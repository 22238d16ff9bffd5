#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "services/gateway/core/block_feed.h"
#include "services/gateway/core/surface_feed.h"

namespace thalweg::gateway {

/// What is on its way from the threads of the buses to the server's. Bounded, however long the server takes:
/// of each topic the newest messages wait, and of the map what has changed since the server looked.
///
/// Threading: any.
class Inbox {
 public:
  static constexpr std::size_t kMostMessages = 200;   ///< Most per topic,
  static constexpr std::size_t kMostBytes = 8 << 20;  ///< [byte] and their size; the newest one always waits.

  struct Item {
    std::size_t topic = 0;
    Time stamp;
    Bytes message;
    std::uint64_t part = 0;  ///< As in Hub::Publish.
  };
  /// As in BlockFeed::Update.
  struct MapChange {
    Time stamp;
    double voxel_size = 0.0;
    bool replaced = false;
    std::vector<BlockStates> blocks;
  };
  struct Content {
    std::vector<Item> items;  ///< Oldest first.
    std::optional<MapChange> map;
    std::optional<SurfaceChange> surface;
  };

  // All return whether the inbox was empty before, so that the server must be woken to look.
  bool Put(Item item);
  bool Put(const MapChange& change);
  bool Put(const SurfaceChange& change);

  Content TakeAll();
  /// Messages that gave way to newer ones since the last call.
  std::uint64_t TakeReplaced();

 private:
  struct Waiting {
    std::uint64_t number;  ///< In order of arrival.
    Item item;
  };
  struct Queue {
    std::deque<Waiting> messages;
    std::size_t bytes = 0;
  };
  bool is_empty() const { return queues_.empty() && !map_ && !surface_; }

  std::mutex mutex_;                     ///< Guards the rest.
  std::map<std::size_t, Queue> queues_;  ///< By topic; none is empty.
  std::uint64_t numbers_ = 0;
  std::optional<MapChange> map_;                                              ///< Without its blocks,
  std::unordered_map<VoxelIndex, BlockFeed::Octets, VoxelIndexHash> blocks_;  ///< of which each waits once.
  std::optional<SurfaceChange> surface_;                                      ///< Likewise.
  std::unordered_map<VoxelIndex, SharedMeshBlock, VoxelIndexHash> meshes_;
  std::uint64_t replaced_ = 0;
};

}  // namespace thalweg::gateway
