#pragma once

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

/// A reader's copy of the mapper's map, kept exact from numbered updates (their other side: map_log.h).
///
/// Whatever is lost, repeated or comes out of order, and however often the mapper restarts: once nothing is
/// missing(), the copy is bit by bit the map that the mapper had at number() of session(), the newest that
/// was heard of. Sessions have no order: a full copy of another session is believed. Threading: one thread.
class MapReplica {
 public:
  /// What one update did.
  struct Applied {
    bool replaced = false;             ///< A full copy came: everything may have changed; `changes` is empty.
    std::vector<VoxelChange> changes;  ///< What changed otherwise, each voxel once.
    std::vector<ScanView> scans;       ///< Of the clouds inside.
  };

  /// Takes one update. Nothing when it was not wanted (an old number, a full copy that was not needed) or
  /// leaves a gap: then missing() tells what to ask for. Error, and nothing taken, when the message lies.
  Result<std::optional<Applied>> Apply(const thalweg_msgs::msg::MapUpdate& update);

  /// Why a full copy is needed, when it is. The reader repeats the request until it has come.
  const std::optional<std::string>& missing() const { return missing_; }
  thalweg_msgs::msg::MapRequest MakeRequest(Time now, std::string_view reader) const;

  bool has_map() const { return grid_.has_value(); }
  const OccupancyGrid& grid() const { return *grid_; }  ///< Only with has_map().
  std::uint64_t session() const { return session_; }
  std::uint64_t number() const { return number_; }

 private:
  void Hear(const thalweg_msgs::msg::MapUpdate& update);
  Applied Replace(const thalweg_msgs::msg::MapUpdate& update);
  Applied Change(const thalweg_msgs::msg::MapUpdate& update, std::vector<ScanView> scans);

  std::optional<OccupancyGrid> grid_;
  std::uint64_t session_ = 0;
  std::uint64_t number_ = 0;
  std::uint64_t heard_number_ = 0;   ///< The largest of this session.
  std::uint64_t other_session_ = 0;  ///< Heard since the last full copy; 0 = none.
  std::uint64_t other_number_ = 0;   ///< The largest of that session.
  std::optional<std::string> missing_ = "no map yet";
};

}  // namespace thalweg::dds
