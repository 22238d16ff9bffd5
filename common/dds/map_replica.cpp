#include "common/dds/map_replica.h"

#include <bit>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "common/base/text.h"
#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

// Wider than what any mapper publishes; bounds how much memory an invalid message can make a reader allocate.
constexpr double kLargestVoxel = 100.0;  // [m]
constexpr double kSmallestVoxel = 1e-4;  // [m]
// After so many messages in a row that contradict a number, the number was wrong. A writer's messages arrive
// in order, so that one would do; a few more, since readers must bear a network that reorders.
constexpr int kContradictions = 5;

std::string Name(const VoxelIndex& block) {
  return "block (" + std::to_string(block.x) + ", " + std::to_string(block.y) + ", " +
         std::to_string(block.z) + ")";
}

VoxelIndex IndexOf(const thalweg_msgs::msg::MapBlock& block) {
  return {block.x(), block.y(), block.z()};
}

std::optional<Error> CheckBlock(const thalweg_msgs::msg::MapBlock& block) {
  constexpr std::int32_t kMaxBlock = kMaxVoxelIndex >> OccupancyGrid::kBlockBits;
  const auto fits = [](std::int32_t v) { return v >= -kMaxBlock - 1 && v <= kMaxBlock; };
  if (!fits(block.x()) || !fits(block.y()) || !fits(block.z())) {
    return Error{Name(IndexOf(block)) + " is beyond the largest index, " + std::to_string(kMaxBlock)};
  }
  std::size_t bits = 0;
  for (const std::uint8_t octet : block.mask()) bits += static_cast<std::size_t>(std::popcount(octet));
  if (bits != block.log_odds().size()) {
    return Error{Name(IndexOf(block)) + " has " + std::to_string(bits) + " voxels in its mask and " +
                 std::to_string(block.log_odds().size()) + " log_odds"};
  }
  for (const float value : block.log_odds()) {
    if (std::isinf(value)) return Error{Name(IndexOf(block)) + " has infinite log_odds"};
  }
  return std::nullopt;
}

Error TooManyBlocks(std::size_t blocks) {
  return {"the map has " + std::to_string(blocks) + " blocks of 8^3 voxels, more than the " +
          std::to_string(MapReplica::kMostBlocks) +
          " that a reader holds: limit it by world.bounds or choose larger voxels"};
}

/// Checks everything that can be wrong with an update on its own.
std::optional<Error> CheckUpdate(const thalweg_msgs::msg::MapUpdate& update) {
  const Result<Time> stamp = FromIdl(update.header(), kMapFrame);
  if (!stamp) return Error{stamp.error()};
  if (update.session() == 0) return Error{"session is 0"};
  if (!update.full() && update.number() == 0) return Error{"number is 0 in an update that is not full"};
  if (update.full() && !update.scans().empty()) return Error{"scans in a full copy"};
  if (!(update.voxel_size_m() >= kSmallestVoxel && update.voxel_size_m() <= kLargestVoxel)) {
    return Error{"voxel_size_m is " + NumberText(update.voxel_size_m()) + ", must be 0.0001 to 100"};
  }
  if (update.blocks().size() > MapReplica::kMostBlocks) return TooManyBlocks(update.blocks().size());
  std::unordered_set<VoxelIndex, VoxelIndexHash> seen;
  for (const thalweg_msgs::msg::MapBlock& block : update.blocks()) {
    if (auto error = CheckBlock(block)) return error;
    if (!seen.insert(IndexOf(block)).second) return Error{Name(IndexOf(block)) + " occurs twice"};
  }
  return std::nullopt;
}

/// Calls visit(offset in block, log-odds) for each voxel that the block sets.
template <class Visitor>
void ForEachSet(const thalweg_msgs::msg::MapBlock& block, Visitor&& visit) {
  std::size_t next = 0;
  for (std::size_t k = 0; k < OccupancyGrid::kBlockVoxels; ++k) {
    if ((block.mask()[k / 8] >> (k % 8)) & 1U) visit(k, block.log_odds()[next++]);
  }
}

}  // namespace

Result<std::optional<MapReplica::Applied>> MapReplica::Apply(const thalweg_msgs::msg::MapUpdate& update) {
  if (auto error = CheckUpdate(update)) return *std::move(error);
  const bool same_session = update.session() == session_;
  if (has_map() && same_session && update.voxel_size_m() != grid_->voxel_size()) {
    return Error{"voxel_size_m is " + NumberText(update.voxel_size_m()) + ", was " +
                 NumberText(grid_->voxel_size())};
  }
  if (auto error = CheckSize(update)) return *std::move(error);
  std::vector<ScanView> scans;
  for (const thalweg_msgs::msg::ScanView& message : update.scans()) {
    const Result<ScanView> scan = FromIdl(message);
    if (!scan) return Error{"scan: " + scan.error()};
    scans.push_back(*scan);
  }

  Hear(update);
  if (same_session) ForgetContradictedNumbers(update);
  std::optional<Applied> applied;
  const bool newer = same_session && update.number() > number_;
  if (update.full()) {
    const bool needed = missing_ && same_session && update.number() == number_;
    if (!has_map() || !same_session || newer || needed || distrusted_) applied = Replace(update);
  } else if (has_map() && same_session && update.number() == number_ + 1) {
    applied = Change(update, std::move(scans));
  }

  if (!has_map()) return applied;
  if (other_session_ != 0) {
    missing_ = "the mapper was restarted";
  } else if (distrusted_) {
    missing_ = "updates are older than the copy";
  } else if (heard_number_ > number_) {
    if (!missing_) missing_ = "updates after " + std::to_string(number_) + " were lost";
  } else if (applied) {
    missing_.reset();
  }
  return applied;
}

/// Checks that an update of this copy does not make it too large.
std::optional<Error> MapReplica::CheckSize(const thalweg_msgs::msg::MapUpdate& update) const {
  const bool applies =
      !update.full() && has_map() && update.session() == session_ && update.number() == number_ + 1;
  if (!applies || grid_->block_count() + update.blocks().size() <= kMostBlocks) return std::nullopt;
  std::size_t blocks = grid_->block_count();
  for (const thalweg_msgs::msg::MapBlock& block : update.blocks()) {
    blocks += grid_->FindBlock(IndexOf(block)) == nullptr ? 1 : 0;
  }
  if (blocks <= kMostBlocks) return std::nullopt;
  return TooManyBlocks(blocks);
}

void MapReplica::Hear(const thalweg_msgs::msg::MapUpdate& update) {
  if (update.session() == session_) {
    heard_number_ = std::max(heard_number_, update.number());
  } else if (update.session() == other_session_) {
    other_number_ = std::max(other_number_, update.number());
  } else {
    other_session_ = update.session();
    other_number_ = update.number();
  }
}

void MapReplica::ForgetContradictedNumbers(const thalweg_msgs::msg::MapUpdate& update) {
  const bool below_heard = update.full() && update.number() < heard_number_;
  if (update.full()) full_below_heard_ = below_heard ? full_below_heard_ + 1 : 0;
  if (full_below_heard_ >= kContradictions) heard_number_ = number_;
  older_in_a_row_ = update.number() < number_ ? older_in_a_row_ + 1 : 0;
  if (older_in_a_row_ >= kContradictions) distrusted_ = true;
}

MapReplica::Applied MapReplica::Replace(const thalweg_msgs::msg::MapUpdate& update) {
  grid_.emplace(update.voxel_size_m());
  for (const thalweg_msgs::msg::MapBlock& message : update.blocks()) {
    OccupancyGrid::Block& block = grid_->BlockAt(IndexOf(message));
    ForEachSet(message, [&](std::size_t k, float log_odds) { block[k] = log_odds; });
  }
  if (update.session() != session_) heard_number_ = other_number_;  // which Hear() has just recorded
  if (distrusted_) heard_number_ = update.number();
  distrusted_ = false;
  older_in_a_row_ = 0;
  session_ = update.session();
  number_ = update.number();
  other_session_ = 0;
  return {.replaced = true, .changes = {}, .scans = {}};
}

MapReplica::Applied MapReplica::Change(const thalweg_msgs::msg::MapUpdate& update,
                                       std::vector<ScanView> scans) {
  Applied applied{.replaced = false, .changes = {}, .scans = std::move(scans)};
  for (const thalweg_msgs::msg::MapBlock& message : update.blocks()) {
    const VoxelIndex index = IndexOf(message);
    OccupancyGrid::Block& block = grid_->BlockAt(index);
    ForEachSet(message, [&](std::size_t k, float log_odds) {
      block[k] = log_odds;
      applied.changes.push_back({OccupancyGrid::IndexInBlock(index, k), log_odds});
    });
  }
  number_ = update.number();
  return applied;
}

thalweg_msgs::msg::MapRequest MapReplica::MakeRequest(Time now, std::string_view reader) const {
  thalweg_msgs::msg::MapRequest request;
  request.header(MakeHeader(now, kMapFrame));
  request.reader(std::string(reader));
  request.session(session_);
  request.number(number_);
  request.reason(missing_.value_or(""));
  return request;
}

}  // namespace thalweg::dds
