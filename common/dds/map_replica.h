#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/base/time.h"
#include "common/dds/topics.h"
#include "common/geometry/scan_view.h"
#include "common/voxel/occupancy_grid.h"

namespace thalweg::dds {

/// A reader's copy of the mapper's map, kept exact by numbered updates (their sender: map_log.h).
///
/// Messages may be lost, repeated or reordered, and the mapper may restart at any time: as soon as missing()
/// is empty, the copy equals, bit by bit, the mapper's map at number() of session(), the newest update known.
/// Sessions have no order: a full copy of another session replaces the map. A number that the messages after
/// it contradict, be it in error or by intent, is forgotten again, so that none makes the reader deaf: one
/// too large to come soon, or a full copy ahead of all updates.
///
/// Memory: at most 2.2 kB for each of kMostBlocks blocks, whatever is received.
/// Threading: one thread.
class MapReplica {
 public:
  /// Blocks that a copy may have: 67 million voxels, more than the explorer can plan with. A message of a few
  /// megabytes can list blocks of one voxel each that would take up gigabytes.
  static constexpr std::size_t kMostBlocks = 1U << 17U;

  /// How often a reader asks for a full copy while it lacks one.
  static constexpr Duration kRequestPeriod = std::chrono::milliseconds(500);

  /// The effect of an update.
  struct Applied {
    /// A full copy was applied: any voxel may have changed; `changes` is empty.
    bool replaced = false;
    std::vector<VoxelChange> changes;  ///< Otherwise the voxels that changed, each once.
    std::vector<ScanView> scans;       ///< Views of the clouds in the update.
  };

  /// Applies an update. Returns nothing if it was not needed (an old number, an unnecessary full copy) or
  /// leaves a gap; then missing() says what to request. Error, with the map unchanged, if the message is
  /// invalid or the map would have more than kMostBlocks blocks.
  Result<std::optional<Applied>> Apply(const thalweg_msgs::msg::MapUpdate& update);

  /// Why a full copy is needed, if it is. The reader must repeat the request, each kRequestPeriod, until one
  /// has arrived.
  const std::optional<std::string>& missing() const { return missing_; }
  thalweg_msgs::msg::MapRequest MakeRequest(Time now, std::string_view reader) const;

  bool has_map() const { return grid_.has_value(); }
  const OccupancyGrid& grid() const { return *grid_; }  ///< Precondition: has_map().
  std::uint64_t session() const { return session_; }
  std::uint64_t number() const { return number_; }

 private:
  std::optional<Error> CheckSize(const thalweg_msgs::msg::MapUpdate& update) const;
  void Hear(const thalweg_msgs::msg::MapUpdate& update);
  void ForgetContradictedNumbers(const thalweg_msgs::msg::MapUpdate& update);
  Applied Replace(const thalweg_msgs::msg::MapUpdate& update);
  Applied Change(const thalweg_msgs::msg::MapUpdate& update, std::vector<ScanView> scans);

  std::optional<OccupancyGrid> grid_;
  std::uint64_t session_ = 0;
  std::uint64_t number_ = 0;
  std::uint64_t heard_number_ = 0;   ///< Largest number received in this session.
  int full_below_heard_ = 0;         ///< Full copies in a row that are older than that.
  int older_in_a_row_ = 0;           ///< Messages in a row that are older than the copy.
  bool distrusted_ = false;          ///< Whether any full copy is to replace this one.
  std::uint64_t other_session_ = 0;  ///< Another session received since the last full copy; 0 = none.
  std::uint64_t other_number_ = 0;   ///< Largest number received in that session.
  std::optional<std::string> missing_ = "no map yet";
};

}  // namespace thalweg::dds
