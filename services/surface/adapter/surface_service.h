#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/stopwatch.h"
#include "common/dds/bus.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"
#include "common/dds/placed_views.h"
#include "common/service/background.h"
#include "services/surface/adapter/options.h"
#include "services/surface/adapter/volume_file.h"
#include "services/surface/core/fused/live_surface.h"
#include "services/surface/core/fused/place_judge.h"
#include "services/surface/core/fused/remembered_place.h"

namespace thalweg::surface {

/// The fused surface as a service: places each organized cloud by the odometry at its stamp, fuses it,
/// publishes the blocks of the mesh that changed as numbered updates, full copies on request, how much was
/// seen how well, and where the surface is torn. It goes on from the checkpoint in its folder, if there is
/// one. When an operator commands the mapper to save its map, the mesh is saved as well; the answer is the
/// mapper's.
///
/// Refused and counted: clouds that are not organized, or not of one pinhole camera; those of another camera,
/// until it has stayed; and poses that jump.
///
/// Fusing and meshing take longer than the time between poses, so that they are done by a worker, while the
/// bus's thread goes on reading; files are compressed and written by another.
class SurfaceService {
 public:
  static constexpr auto kCheckpointFile = "checkpoint.surface";
  static constexpr auto kMeshFile = "map_surface.ply";
  static constexpr std::size_t kMaxWaiting = 8;  ///< Clouds that wait to be fused.

  /// Throws std::invalid_argument naming a bad option, and std::runtime_error if the checkpoint has another
  /// voxel size, or another notion of what is inspected. A checkpoint that cannot be read is reported in the
  /// log and set aside. Bus::Spin throws std::runtime_error if the first clouds show that the checkpoint is
  /// of another place.
  SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus);

  /// Writes the checkpoint and the mesh, each even if the other one cannot be written. Throws
  /// std::runtime_error naming those that were not.
  void Save();

  // These wait for the worker, and hold until the bus spins again.
  const SurfaceMesh& mesh() const;
  const FusedSurface& surface() const;
  std::uint64_t updates() const;  ///< Published in this session.

  std::uint64_t scans() const { return scans_; }            ///< Fused by this process.
  int listeners() const { return updates_out_.readers(); }  ///< Readers of the updates.

 private:
  SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus, StoredVolume start);

  using PlacedCloud = dds::PlacedViews::View;
  /// What the worker is to do.
  struct Task {
    std::vector<PlacedCloud> clouds;
    bool publish = false;
    bool full_copy = false;
    bool store = false;
    bool save_mesh = false;
  };
  struct Outcome {
    std::vector<double> fusions = {};       ///< How long each took [ms],
    std::optional<double> mesh = {};        ///< and the mesh [ms],
    std::optional<double> rifts = {};       ///< and the rifts [ms],
    std::optional<double> full_copy = {};   ///< and a full copy [ms].
    bool full = false;                      ///< Whether the surface takes all memory that it may.
    bool store_withheld = false;            ///< Whether clouds were not stored that may be of another place.
    std::optional<std::string> error = {};  ///< Why the service cannot go on.
  };

  void OnOdometry(const nav_msgs::msg::Odometry& message);
  /// @param message  A cloud, a depth image, or its calibration.
  template <class Message>
  void OnDepth(const Message& message);
  void OnRequest(const thalweg_msgs::msg::MapRequest& message);
  void OnCommand(const thalweg_msgs::msg::OperatorCommand& message);
  void TakePlaced();
  void BeginWork();
  void Finish(const Outcome& outcome);
  void Store();
  void SaveMesh();

  // Called by the worker, or while it does nothing.
  Outcome Do(const Task& task);
  std::optional<std::string> ComparePlace(const PlacedCloud& cloud);
  bool PublishChanges();
  void PublishFullCopy();
  void PublishStatus();
  void PublishRifts();
  void PublishRiftMarkers();
  thalweg_msgs::msg::SurfaceUpdate NewUpdate(bool full) const;
  void Send(bool full, std::span<const VoxelIndex> blocks);

  SurfaceServiceOptions options_;
  dds::Bus& bus_;
  dds::PlacedViews views_;
  std::vector<PlacedCloud> to_fuse_;  ///< Oldest first.
  bool working_ = false;              ///< Whether the worker has a task whose outcome is not yet known.
  std::uint64_t scans_ = 0;
  bool was_full_ = false;
  bool publish_due_ = false;
  bool full_copy_wanted_ = false;
  std::optional<Stopwatch> since_full_copy_;
  bool store_due_ = false;
  bool save_due_ = false;
  dds::CommandLedger commands_;
  bool file_failed_ = false;  ///< Whether the last checkpoint could not be written.

  // Used by the worker while it is busy, else by the bus's thread.
  LiveSurface live_;
  const std::uint64_t session_;
  std::uint64_t number_ = 0;
  Time fused_stamp_;  ///< Stamp of the newest cloud that was fused.
  std::uint64_t fused_ = 0;
  std::uint64_t fused_stated_ = 0;
  bool rifts_due_ = false;   ///< Whether the surface is newer than the rifts.
  double rifts_took_ = 0.0;  ///< [ms] The last search.
  Stopwatch since_rifts_;
  thalweg_msgs::msg::SurfaceRifts rifts_stated_;  ///< Without a header.
  bool markers_due_ = false;                      ///< Whether they have not been published as markers.
  std::optional<TruncatedVolume> to_store_;       ///< Blocks that have changed since the last checkpoint.
  std::shared_ptr<const SurfaceMesh> to_save_;
  std::optional<RememberedPlace> resumed_;  ///< What the checkpoint knew, while clouds are compared with it.
  PlaceJudge place_judge_;
  bool store_withheld_ = false;  ///< A checkpoint is due once that is known.

  VolumeFile file_;  ///< Used by disk_ while that is busy.
  dds::Bus::Publisher<dds::topics::SurfaceUpdates> updates_out_;
  dds::Bus::Publisher<dds::topics::SurfaceStatus> status_out_;
  dds::Bus::Publisher<dds::topics::SurfaceRifts> rifts_out_;
  dds::Bus::Publisher<dds::topics::RiftMarkers> rift_markers_out_;
  // Last, so that their tasks end before the members they use are destroyed.
  mutable Background disk_;
  mutable Background worker_;
};

}  // namespace thalweg::surface
