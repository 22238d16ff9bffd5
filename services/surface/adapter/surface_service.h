#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <unordered_set>

#include "common/base/stopwatch.h"
#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "common/geometry/pose_history.h"
#include "common/service/background.h"
#include "services/surface/adapter/options.h"
#include "services/surface/adapter/volume_file.h"
#include "services/surface/core/fused/pose_continuity.h"
#include "services/surface/core/fused/surface_mesh.h"

namespace thalweg::surface {

/// The fused surface as a service: places each organized cloud by the odometry at its stamp, fuses it,
/// publishes the blocks of the mesh that changed as numbered updates, full copies on request, and how much
/// was seen how well. It goes on from the checkpoint in its folder, if there is one.
///
/// Refused and counted: clouds that are not organized, or not of one pinhole camera; those of another camera,
/// until kNewCamera of them in a row say that it is there to stay; and poses that jump.
class SurfaceService {
 public:
  static constexpr auto kCheckpointFile = "checkpoint.surface";
  static constexpr auto kMeshFile = "map_surface.ply";
  static constexpr std::size_t kMaxPendingClouds = 8;
  static constexpr int kNewCamera = 10;

  /// Throws std::invalid_argument naming a bad option, and std::runtime_error if the checkpoint has another
  /// voxel size. A checkpoint that cannot be read is reported in the log and set aside.
  SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus);

  /// Writes the checkpoint and the mesh, each even if the other one cannot be written. Throws
  /// std::runtime_error naming those that were not.
  void Save();

  const SurfaceMesh& mesh() const { return mesh_; }
  const FusedSurface& surface() const { return surface_; }
  std::uint64_t scans() const { return scans_; }            ///< Fused by this process.
  std::uint64_t updates() const { return number_; }         ///< Published in this session.
  std::size_t pending() const { return pending_.size(); }   ///< Clouds waiting for a pose.
  int listeners() const { return updates_out_.readers(); }  ///< Readers of the updates.

 private:
  SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus, TruncatedVolume volume);

  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnCloud(const sensor_msgs::msg::PointCloud2& message);
  void OnRequest(const thalweg_msgs::msg::MapRequest& message);
  /// The camera to fuse a cloud with; nothing if the cloud is refused, which is counted.
  std::optional<PinholeCamera> CameraFor(const PointCloud& cloud);
  void TakePending();
  void Fuse(const dds::StampedCloud& cloud, const PinholeCamera& camera, const RigidTransform& T_WC);
  void Publish();
  void PublishFullCopyWhenDue();
  void PublishStatus();
  void WriteCheckpoint();
  thalweg_msgs::msg::SurfaceUpdate NewUpdate(bool full) const;

  struct PendingCloud {
    dds::StampedCloud stamped;
    PinholeCamera camera;
  };

  SurfaceServiceOptions options_;
  dds::Bus& bus_;
  FusedSurface surface_;
  SurfaceMesh mesh_;
  PoseContinuity continuity_;
  PoseHistory poses_;
  std::optional<Time> odometry_stamp_;
  std::optional<Time> cloud_stamp_;
  Time fused_stamp_;  ///< Stamp of the newest cloud that was fused.
  std::optional<PinholeCamera> camera_;
  std::optional<PinholeCamera> other_camera_;  ///< The one of the clouds that were refused last.
  int other_in_a_row_ = 0;
  std::deque<PendingCloud> pending_;
  std::unordered_set<VoxelIndex, VoxelIndexHash> unmeshed_;  ///< Blocks changed since the last mesh,
  std::unordered_set<VoxelIndex, VoxelIndexHash> unstored_;  ///< and since the last checkpoint.
  VolumeFile file_;
  std::uint64_t session_;
  std::uint64_t number_ = 0;
  std::uint64_t scans_ = 0;
  std::uint64_t scans_stated_ = 0;
  bool was_full_ = false;
  bool full_copy_wanted_ = false;
  std::optional<Stopwatch> since_full_copy_;
  dds::Bus::Publisher<dds::topics::SurfaceUpdates> updates_out_;
  dds::Bus::Publisher<dds::topics::SurfaceStatus> status_out_;
  Background disk_;  ///< Last, so that its task ends before the members it uses are destroyed.
};

}  // namespace thalweg::surface
