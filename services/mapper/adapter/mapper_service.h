#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/stamp_gaps.h"
#include "common/base/stopwatch.h"
#include "common/dds/bus.h"
#include "common/dds/cloud_placement.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"
#include "common/dds/depth_images.h"
#include "common/dds/map_log.h"
#include "common/service/background.h"
#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/adapter/map_keeper.h"
#include "services/mapper/adapter/options.h"
#include "services/mapper/core/cloud_filter.h"
#include "services/mapper/core/fused_map.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// The mapper as a service: places each cloud by the odometry at its stamp, fuses it into the map and
/// publishes the voxels that changed. It also publishes full copies on request and a standard Octomap for
/// tools, and its occupied voxels as points, by height and in their measured color, says in tf_static where
/// frames lie that do not move, saves its files when an operator commands it, and resumes from the checkpoint
/// and journal in its folder if there are any, see map_keeper.h. What cannot be written leaves the files as
/// they are, is counted in the health message and tried again after each period.
///
/// Encoding and writing files happens in the background, on copies of the map and of what scans change.
class MapperService {
 public:
  static constexpr auto kCheckpointFile = "checkpoint.map";
  static constexpr auto kResumeTiming = "resume";  ///< In health, where the map was resumed from that file.
  static constexpr std::size_t kMaxPendingClouds = 8;

  /// Throws std::invalid_argument naming a bad option, and std::runtime_error if the checkpoint has another
  /// voxel size. A checkpoint that cannot be read is reported in the log and set aside. Bus::Spin throws
  /// std::runtime_error if the first clouds show that the checkpoint is of another place.
  MapperService(const MapperOptions& options, dds::Bus& bus);

  /// Writes the checkpoint, map.bt, map.ot and map.ply, each even if another one cannot be written. Throws
  /// std::runtime_error naming those that were not.
  void Save();

  OccupancyGrid grid() const { return map_->Snapshot(); }   ///< A copy.
  std::uint64_t updates() const { return log_.number(); }   ///< Updates published in this session.
  std::size_t pending() const { return pending_.size(); }   ///< Clouds waiting for a pose.
  int listeners() const { return updates_out_.readers(); }  ///< Readers of the map updates.

 private:
  /// What to begin with.
  struct Start {
    std::unique_ptr<FusedMap> map;
    VoxelColors colors = {};
    MapPosition position = {};
    std::optional<JournalEnds> journal = std::nullopt;
    std::optional<double> resumed_ms = std::nullopt;  ///< [ms] Time that loading took; nothing = a new map.
  };
  static Start StartFrom(const MapperOptions& options);
  MapperService(const MapperOptions& options, dds::Bus& bus, Start start);

  struct PendingCloud {
    dds::StampedCloud stamped;
    Stopwatch since_arrival;
    const char* topic;  ///< From which it came.
  };

  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnCloud(const sensor_msgs::msg::PointCloud2& message);
  /// @param message  A depth image, or its calibration.
  template <class Message>
  void OnDepth(const Message& message);
  /// Waits for the pose of a cloud. @param topic  From which it came.
  void AddCloud(dds::StampedCloud cloud, const char* topic, const Stopwatch& since_arrival);
  void OnRequest(const thalweg_msgs::msg::MapRequest& message);
  void OnCommand(const thalweg_msgs::msg::OperatorCommand& message);
  void SaveWhenDue();
  void Reply(const dds::CommandId& id, bool accepted, const std::string& reason);
  void TakePending();
  void Integrate(PendingCloud& pending, const RigidTransform& T_WC);
  void PublishFullCopyWhenDue();
  void ComparePlace(const PointCloud& cloud, const RigidTransform& T_WC);
  Checkpoint CopyOfMap() const;
  void WriteCheckpointWhenNeeded();
  void MaintainFiles();
  void OnKept(const MapKeeper::Event& event);
  void PublishSnapshot();
  void Record(const std::string& name, double milliseconds);

  MapperOptions options_;
  dds::Bus& bus_;
  std::unique_ptr<CloudFilter> filter_;  ///< Null if nothing is to be dropped.
  std::unique_ptr<FusedMap> map_;
  VoxelColors colors_;
  dds::MapLog log_;
  dds::CloudPlacement placement_;
  std::deque<PendingCloud> pending_;
  dds::DepthImages depth_images_;
  StampGaps gaps_;
  bool full_copy_wanted_ = false;
  std::optional<Stopwatch> since_full_copy_;
  int clouds_to_compare_;    ///< With the map that this process began with.
  bool files_fail_ = false;  ///< Whether what is to be kept does not come to the disk.
  std::uint64_t journal_scans_ = 0;
  std::uint64_t journal_bytes_ = 0;  ///< What these scans take.
  bool snapshot_due_ = false;        ///< Whether the map has changed since the last Octomap,
  bool points_due_ = false;          ///< since the last points,
  bool colors_due_ = false;          ///< it or its colors since the last colored points.
  dds::CommandLedger commands_;
  std::vector<dds::CommandId> saves_due_;  ///< Commands to save the map that wait for the background.

  dds::Bus::Publisher<dds::topics::MapUpdates> updates_out_;
  dds::Bus::Publisher<dds::topics::Octomap> octomap_out_;
  dds::Bus::Publisher<dds::topics::OccupiedPoints> points_out_;
  dds::Bus::Publisher<dds::topics::ColoredPoints> colored_out_;
  dds::Bus::Publisher<dds::topics::StaticTransforms> transforms_out_;
  dds::Bus::Publisher<dds::topics::CommandReplies> replies_out_;
  std::optional<MapKeeper> keeper_;  ///< Unless checkpoint_period is 0.
  // Last, so that their tasks end before the members they use are destroyed.
  Background disk_;        ///< For keeper_, so that its files do not wait for others.
  Background background_;  ///< For all other files, and for tools.
};

}  // namespace thalweg::mapper
