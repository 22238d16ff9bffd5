#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "common/voxel/voxel_index.h"

namespace thalweg::gateway {

/// Blocks in order of their last change, for readers who each remember how far they have come: a slow one
/// gets each block once, as it is when it can take it, and none costs memory.
template <class Value>
class BlocksByChange {
 public:
  /// Begins another collection, which replaces the reader's.
  void Restart() {
    blocks_.clear();
    by_change_.clear();
    start_ = ++changes_;
  }
  bool has_begun() const { return start_ != 0; }

  /// Nothing if the block is not there; valid until the next change.
  const Value* Find(const VoxelIndex& block) const {
    const auto found = blocks_.find(block);
    return found == blocks_.end() ? nullptr : &found->second.value;
  }
  void Set(const VoxelIndex& block, Value value) {
    Entry& entry = blocks_[block];
    if (entry.changed != 0) by_change_.erase(entry.changed);
    entry = {++changes_, std::move(value)};
    by_change_[entry.changed] = block;
  }

  /// Passes blocks that a reader lacks to take(block, value), oldest change first, until it returns false:
  /// that block is then not taken. Moves the cursor behind what was taken.
  /// @param cursor  The reader's; 0 at first.
  /// @return Whether the reader must forget earlier blocks; nothing if it lacks nothing.
  template <class Take>
  std::optional<bool> TakeSince(std::uint64_t& cursor, Take&& take) const {
    if (start_ == 0) return std::nullopt;
    const bool reset = cursor < start_;
    auto change = by_change_.upper_bound(cursor);
    if (!reset && change == by_change_.end()) return std::nullopt;
    cursor = std::max(cursor, start_);
    for (; change != by_change_.end() && take(change->second, blocks_.at(change->second).value); ++change)
      cursor = change->first;
    return reset;
  }

  /// Calls use(block, value) for every block.
  template <class Use>
  void ForEach(Use&& use) const {
    for (const auto& [block, entry] : blocks_) use(block, entry.value);
  }
  std::uint64_t changes() const { return changes_; }  ///< Grows with each change.

 private:
  struct Entry {
    std::uint64_t changed = 0;
    Value value;
  };
  std::uint64_t changes_ = 0;
  std::uint64_t start_ = 0;  ///< The change with which this collection began; 0 = none yet.
  std::unordered_map<VoxelIndex, Entry, VoxelIndexHash> blocks_;
  std::map<std::uint64_t, VoxelIndex> by_change_;
};

}  // namespace thalweg::gateway
