#pragma once

#include <deque>
#include <optional>

#include "common/base/stopwatch.h"
#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/geometry/pose_history.h"
#include "services/mapper/adapter/background.h"
#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/adapter/options.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// Places clouds by the odometry at their stamps, fuses them into the map and publishes what changed; full
/// copies on request; a standard Octomap for tools. Goes on from the checkpoint in its folder, if there is
/// one.
///
/// Encoding and writing files happens in the background, on copies.
class MapperService {
 public:
  static constexpr auto kCheckpointFile = "checkpoint.map";
  static constexpr std::size_t kMaxPendingClouds = 8;

  /// Throws std::invalid_argument naming a bad option, std::runtime_error when the checkpoint there is of
  /// another voxel size. A checkpoint that cannot be read is named in the log and not gone on from.
  MapperService(const MapperOptions& options, dds::Bus& bus);

  /// Writes the checkpoint, map.ot, map.bt and map.ply. Throws std::runtime_error when that fails.
  void Save();

  const OccupancyGrid& grid() const { return map_.grid(); }
  std::uint64_t updates() const { return log_.number(); }   ///< Published in this session.
  std::size_t pending() const { return pending_.size(); }   ///< Clouds that wait for a pose.
  int listeners() const { return updates_out_.readers(); }  ///< To the updates.

 private:
  struct PendingCloud {
    dds::StampedCloud stamped;
    Stopwatch since_arrival;
  };

  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnCloud(const sensor_msgs::msg::PointCloud2& message);
  void OnRequest(const thalweg_msgs::msg::MapRequest& message);
  void TakePending();
  void Integrate(const PendingCloud& pending, const RigidTransform& T_WC);
  void PublishFullCopyWhenDue();
  void WriteCheckpoint();
  void PublishSnapshot();
  void Record(const std::string& name, double milliseconds);

  MapperOptions options_;
  dds::Bus& bus_;
  VoxelColors colors_;  ///< Before map_, whose start fills it, too.
  OccupancyMap map_;
  dds::MapLog log_;
  PoseHistory poses_;
  std::optional<Time> odometry_stamp_;
  std::optional<Time> cloud_stamp_;
  std::deque<PendingCloud> pending_;
  bool full_copy_wanted_ = false;
  std::optional<Stopwatch> since_full_copy_;
  bool checkpoint_due_ = false;  ///< The map has changed since the last one.
  bool snapshot_due_ = false;

  dds::Bus::Publisher<dds::topics::MapUpdates> updates_out_;
  dds::Bus::Publisher<dds::topics::Octomap> octomap_out_;
  Background background_;  ///< Last: it ends before what it uses.
};

}  // namespace thalweg::mapper
