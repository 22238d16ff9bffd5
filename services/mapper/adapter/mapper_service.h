#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/base/stopwatch.h"
#include "common/dds/bus.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/geometry/pose_history.h"
#include "services/mapper/adapter/background.h"
#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/adapter/options.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// The mapper as a service: places each cloud by the odometry at its stamp, fuses it into the map and
/// publishes the voxels that changed. It also publishes full copies on request and a standard Octomap for
/// tools, saves its files when an operator commands it, and resumes from the checkpoint in its folder if
/// there is one. A checkpoint that cannot be written leaves the previous one as it is, is counted in the
/// health message and tried again after each period.
///
/// Encoding and writing files happens in the background, on copies of the map.
class MapperService {
 public:
  static constexpr auto kCheckpointFile = "checkpoint.map";
  static constexpr std::size_t kMaxPendingClouds = 8;

  /// Throws std::invalid_argument naming a bad option, and std::runtime_error if the checkpoint has another
  /// voxel size. A checkpoint that cannot be read is reported in the log and ignored.
  MapperService(const MapperOptions& options, dds::Bus& bus);

  /// Writes the checkpoint, map.bt, map.ot and map.ply, each even if another one cannot be written. Throws
  /// std::runtime_error naming those that were not.
  void Save();

  const OccupancyGrid& grid() const { return map_.grid(); }
  std::uint64_t updates() const { return log_.number(); }   ///< Updates published in this session.
  std::size_t pending() const { return pending_.size(); }   ///< Clouds waiting for a pose.
  int listeners() const { return updates_out_.readers(); }  ///< Readers of the map updates.

 private:
  struct PendingCloud {
    dds::StampedCloud stamped;
    Stopwatch since_arrival;
  };

  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnCloud(const sensor_msgs::msg::PointCloud2& message);
  void OnRequest(const thalweg_msgs::msg::MapRequest& message);
  void OnCommand(const thalweg_msgs::msg::OperatorCommand& message);
  void SaveWhenDue();
  void Reply(const dds::CommandId& id, bool accepted, const std::string& reason);
  void TakePending();
  void Integrate(const PendingCloud& pending, const RigidTransform& T_WC);
  void PublishFullCopyWhenDue();
  void WriteCheckpoint();
  void OnCheckpoint(const std::optional<std::string>& error);
  void PublishSnapshot();
  void Record(const std::string& name, double milliseconds);

  MapperOptions options_;
  dds::Bus& bus_;
  VoxelColors colors_;  ///< Before map_, whose initializer fills it.
  OccupancyMap map_;
  dds::MapLog log_;
  PoseHistory poses_;
  std::optional<Time> odometry_stamp_;
  std::optional<Time> cloud_stamp_;
  std::deque<PendingCloud> pending_;
  bool full_copy_wanted_ = false;
  std::optional<Stopwatch> since_full_copy_;
  bool checkpoint_due_ = false;    ///< Whether the map has changed since the last checkpoint.
  bool checkpoint_fails_ = false;  ///< Whether the last attempt to write it failed.
  bool snapshot_due_ = false;
  dds::CommandLedger commands_;
  std::vector<dds::CommandId> saves_due_;  ///< Commands to save the map that wait for the background.

  dds::Bus::Publisher<dds::topics::MapUpdates> updates_out_;
  dds::Bus::Publisher<dds::topics::Octomap> octomap_out_;
  dds::Bus::Publisher<dds::topics::CommandReplies> replies_out_;
  Background background_;  ///< Last, so that its task ends before the members it uses are destroyed.
};

}  // namespace thalweg::mapper
