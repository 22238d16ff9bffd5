#include "services/explorer/core/map/look_memory.h"

#include <algorithm>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/moved_grid.h"

namespace thalweg::explorer {

bool IsInVain(AsideReason reason) {
  return reason == AsideReason::kLookedAt || reason == AsideReason::kVisited ||
         reason == AsideReason::kNoDepth;
}

std::string_view NameOf(AsideReason reason) {
  switch (reason) {
    case AsideReason::kLookedAt:
      return "looked_at";
    case AsideReason::kVisited:
      return "visited";
    case AsideReason::kOutOfSight:
      return "out_of_sight";
    case AsideReason::kLostThere:
      return "lost_there";
    case AsideReason::kNoDepth:
      return "no_depth";
    case AsideReason::kIgnored:
      return "ignored";
    case AsideReason::kTooSmall:
      return "too_small";
    case AsideReason::kNoRoom:
      return "no_room";
    case AsideReason::kNone:
      break;
  }
  return "none";
}

std::optional<AsideReason> AsideReasonNamed(std::string_view name) {
  const auto* const found =
      std::ranges::find_if(kAsideReasons, [&](AsideReason reason) { return NameOf(reason) == name; });
  if (found != std::end(kAsideReasons)) return *found;
  return name == NameOf(AsideReason::kNone) ? std::optional(AsideReason::kNone) : std::nullopt;
}

void LookMemory::Cover(const VoxelBox& box) {
  if (entries_.box() == box) return;
  entries_ = MovedTo(entries_, box, Entry{});
  aside_ = MovedTo(aside_, box, std::uint8_t{0});
}

void LookMemory::Clear() {
  entries_.Fill(Entry{});
  aside_.Fill(0);
}

void LookMemory::Look(const VoxelIndex& i, const Eigen::Vector3d& p_W, Sensed sensed, Time now) {
  Entry& entry = entries_[i];
  if (entry.looks > 0 && (entry.last_W.cast<double>() - p_W).norm() < options_.apart) return;
  entry.last_W = p_W.cast<float>();
  CountLook(i, AsideReason::kLookedAt, sensed, now);
}

void LookMemory::CountLook(const VoxelIndex& i, AsideReason reason, Sensed sensed, Time now) {
  Entry& entry = entries_[i];
  const auto count = [](std::uint8_t& n) { n = static_cast<std::uint8_t>(std::min(255, n + 1)); };
  count(entry.looks);
  if (sensed == Sensed::kNothing) count(entry.sensed_nothing);
  if (entry.looks < options_.looks) return;
  SetAside(i, 2 * entry.sensed_nothing > entry.looks ? AsideReason::kNoDepth : reason, now);
}

void LookMemory::SetAside(const VoxelIndex& i, AsideReason reason, Time now) {
  if (reason != AsideReason::kIgnored && (!options_.sets_aside || aside_[i] != 0)) return;
  aside_[i] = static_cast<std::uint8_t>(reason);
  entries_[i].set_aside = now;
}

void LookMemory::Reopen(const VoxelIndex& i) {
  Entry& entry = entries_[i];
  if (aside_[i] == 0 || entry.chances >= options_.chances) return;
  if (aside_[i] == static_cast<std::uint8_t>(AsideReason::kIgnored)) return;
  ++entry.chances;
  entry.looks = static_cast<std::uint8_t>(std::max(0, options_.looks - 1));
  // Looks after it was set aside were counted, too. Keep only as many as match the reason it was set aside
  // for.
  entry.sensed_nothing =
      aside_[i] == static_cast<std::uint8_t>(AsideReason::kNoDepth) ? entry.looks : std::uint8_t{0};
  aside_[i] = 0;
}

/// Handles a voxel that was known with confidence and is now doubtful.
void LookMemory::BecomeDoubtful(const VoxelIndex& i) {
  Entry& entry = entries_[i];
  if (entry.chances >= options_.chances && options_.sets_aside) {
    aside_[i] = static_cast<std::uint8_t>(AsideReason::kLookedAt);
    return;
  }
  entry.chances = static_cast<std::uint8_t>(std::min(255, entry.chances + 1));
  entry.looks = static_cast<std::uint8_t>(std::min<int>(entry.looks, std::max(0, options_.looks - 1)));
  entry.sensed_nothing = std::min(entry.sensed_nothing, entry.looks);
}

void LookMemory::Follow(std::span<const PlanningMap::StateChange> changes) {
  for (const PlanningMap::StateChange& change : changes) {
    if (change.before == VoxelState::kUnknown) {
      entries_[change.voxel] = Entry{};
      aside_[change.voxel] = 0;
    } else if (change.doubtful_now && !change.doubtful_before) {
      BecomeDoubtful(change.voxel);
    } else if (change.doubtful_before && !change.doubtful_now) {
      aside_[change.voxel] = 0;
    }
    if (change.now != VoxelState::kFree || change.before == VoxelState::kFree) continue;
    for (const VoxelIndex& offset : kFaceNeighbors) {
      const VoxelIndex neighbor = change.voxel + offset;
      if (aside_.Contains(neighbor)) Reopen(neighbor);
    }
  }
}

void LookMemory::ShiftTimes(Duration back) {
  for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k].set_aside -= back;
}

void LookMemory::Expire(Time now) {
  for (std::size_t k = 0; k < aside_.size(); ++k) {
    if (aside_[k] != 0 && now - entries_[k].set_aside > options_.expiry) Reopen(aside_.IndexAt(k));
  }
}

std::size_t LookMemory::ReopenInVain(const VoxelBox& within) {
  std::size_t reopened = 0;
  ForEachVoxel(within, [&](const VoxelIndex& i) {
    if (!aside_.Contains(i) || !IsInVain(static_cast<AsideReason>(aside_[i]))) return;
    Reopen(i);
    if (aside_[i] == 0) ++reopened;
  });
  return reopened;
}

std::size_t LookMemory::Release(AsideReason reason, Time before) {
  std::size_t released = 0;
  for (std::size_t k = 0; k < aside_.size(); ++k) {
    if (aside_[k] != static_cast<std::uint8_t>(reason) || entries_[k].set_aside >= before) continue;
    aside_[k] = 0;
    ++released;
  }
  return released;
}

void LookMemory::Release(AsideReason reason, std::span<const VoxelIndex> voxels) {
  for (const VoxelIndex& i : voxels) {
    if (aside_.Get(i, 0) == static_cast<std::uint8_t>(reason)) aside_[i] = 0;
  }
}

std::size_t LookMemory::Count(AsideReason reason) const {
  const std::uint8_t* const first = aside_.data();
  return static_cast<std::size_t>(
      std::count(first, first + aside_.size(), static_cast<std::uint8_t>(reason)));
}

std::map<AsideReason, std::vector<VoxelIndex>> LookMemory::SetAsideVoxels() const {
  std::map<AsideReason, std::vector<VoxelIndex>> voxels;
  for (std::size_t k = 0; k < aside_.size(); ++k) {
    if (aside_[k] != 0) voxels[static_cast<AsideReason>(aside_[k])].push_back(aside_.IndexAt(k));
  }
  return voxels;
}

}  // namespace thalweg::explorer
