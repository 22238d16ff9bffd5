#include "services/surface/adapter/surface_service.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/base/angles.h"
#include "common/base/text.h"
#include "common/dds/map_log.h"
#include "common/files/write_file.h"
#include "services/surface/adapter/mesh_message.h"
#include "services/surface/adapter/mesh_ply.h"
#include "services/surface/core/fused/cloud_camera.h"

namespace thalweg::surface {
namespace {

namespace topics = dds::topics;

TruncatedVolume VolumeToBeginWith(const SurfaceServiceOptions& options) {
  const std::filesystem::path file = options.out / SurfaceService::kCheckpointFile;
  if (options.checkpoint_period == Duration::zero()) return TruncatedVolume(options.surface.voxel_size);
  Result<std::optional<TruncatedVolume>> loaded = LoadVolume(file);
  if (!loaded) {
    std::filesystem::path aside = file;
    aside += ".unused";
    std::error_code ignored;
    std::filesystem::rename(file, aside, ignored);
    spdlog::warn("{}; it is now {}; starting with an empty surface", loaded.error(), aside.string());
    return TruncatedVolume(options.surface.voxel_size);
  }
  if (!loaded->has_value()) return TruncatedVolume(options.surface.voxel_size);
  TruncatedVolume& volume = **loaded;
  if (volume.voxel_size() != options.surface.voxel_size) {
    throw std::runtime_error(file.string() + " has voxels of " + NumberText(volume.voxel_size()) +
                             " m, surface.voxel_size_m is " + NumberText(options.surface.voxel_size) +
                             ": choose another --out or remove the file");
  }
  spdlog::info("resuming from {} with {} blocks", file.string(), volume.block_count());
  return std::move(volume);
}

std::vector<VoxelIndex> BlocksOf(const TruncatedVolume& volume) {
  std::vector<VoxelIndex> blocks;
  volume.ForEachBlock([&](const VoxelIndex& index, const auto&) { blocks.push_back(index); });
  return blocks;
}

}  // namespace

SurfaceService::SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus)
    : SurfaceService(options, bus, VolumeToBeginWith(options)) {}

SurfaceService::SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus, TruncatedVolume volume)
    : options_(options),
      bus_(bus),
      surface_(options.surface, std::move(volume)),
      mesh_(options.surface.limits),
      continuity_(options.continuity),
      session_(dds::MapLog::MakeSession()),
      updates_out_(bus.Advertise<topics::SurfaceUpdates>()),
      status_out_(bus.Advertise<topics::SurfaceStatus>()) {
  const std::vector<VoxelIndex> known = BlocksOf(surface_.volume());
  mesh_.Update(surface_.volume(), known);
  file_.Update(surface_.volume(), known);
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  bus.Subscribe<topics::DepthPoints>([this](const auto& message) { OnCloud(message); });
  bus.Subscribe<topics::SurfaceRequests>([this](const auto& message) { OnRequest(message); });
  bus.EveryWall(options.publish_period, [this] { Publish(); });
  bus.EveryWall(options.full_copy_period, [this] { PublishFullCopyWhenDue(); });
  if (options.checkpoint_period > Duration::zero()) {
    bus.EveryWall(options.checkpoint_period, [this] { WriteCheckpoint(); });
  }
}

void SurfaceService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const Result<dds::StampedPose> pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  if (odometry_stamp_ && pose->stamp <= *odometry_stamp_) {
    if (*odometry_stamp_ - pose->stamp < kClockRestart) {
      return bus_.health().Drop<topics::Odometry>("not later than the previous one");
    }
    bus_.health().Drop<topics::Odometry>("time jumped back: earlier poses discarded");
    poses_.Clear();
    continuity_.Forget();
  }
  odometry_stamp_ = pose->stamp;
  switch (continuity_.Judge(pose->stamp, pose->T)) {
    case PoseContinuity::Verdict::kJumps:
      return bus_.health().Reject<topics::Odometry>("jumps farther than the robot can have moved");
    case PoseContinuity::Verdict::kNewTrack:
      poses_.Clear();
      break;
    case PoseContinuity::Verdict::kFollows:
      break;
  }
  poses_.Add(pose->stamp, pose->T);
  TakePending();
}

void SurfaceService::OnCloud(const sensor_msgs::msg::PointCloud2& message) {
  const dds::Infinity infinity =
      options_.infinity_is_free ? dds::Infinity::kNoReturn : dds::Infinity::kNoMeasurement;
  Result<dds::StampedCloud> cloud = dds::FromIdl(message, infinity);
  if (!cloud) return bus_.health().Reject<topics::DepthPoints>(cloud.error());
  if (cloud_stamp_ && cloud->stamp <= *cloud_stamp_) {
    if (*cloud_stamp_ - cloud->stamp < kClockRestart) {
      return bus_.health().Drop<topics::DepthPoints>("not later than the previous one");
    }
    bus_.health().Drop<topics::DepthPoints>("time jumped back: earlier clouds discarded");
    pending_.clear();
    if (odometry_stamp_ && *odometry_stamp_ - cloud->stamp >= kClockRestart) poses_.Clear();
  }
  cloud_stamp_ = cloud->stamp;
  const std::optional<PinholeCamera> camera = CameraFor(cloud->cloud);
  if (!camera) return;
  if (pending_.size() == kMaxPendingClouds) {
    bus_.health().Drop<topics::DepthPoints>("no odometry has reached its stamp");
    pending_.pop_front();
  }
  pending_.push_back({*std::move(cloud), *camera});
  TakePending();
}

std::optional<PinholeCamera> SurfaceService::CameraFor(const PointCloud& cloud) {
  const Result<PinholeCamera> camera = CameraOf(cloud);
  if (!camera) {
    bus_.health().Reject<topics::DepthPoints>(camera.error());
    return std::nullopt;
  }
  if (!camera_) camera_ = *camera;
  if (IsSameCamera(*camera_, *camera)) {
    other_in_a_row_ = 0;
    return camera_;
  }
  const bool again = other_in_a_row_ > 0 && IsSameCamera(*other_camera_, *camera);
  other_in_a_row_ = again ? other_in_a_row_ + 1 : 1;
  other_camera_ = *camera;
  if (other_in_a_row_ >= kNewCamera) {
    spdlog::warn("the clouds are of another camera now: {} x {} pixels", camera->width_px, camera->height_px);
    camera_ = *camera;
    other_in_a_row_ = 0;
    return camera_;
  }
  bus_.health().Reject<topics::DepthPoints>(
      "is of another camera than those before: " + std::to_string(camera->width_px) + " x " +
      std::to_string(camera->height_px) + " pixels, fx " + NumberText(camera->fx));
  return std::nullopt;
}

void SurfaceService::TakePending() {
  while (!pending_.empty() && poses_.Reaches(pending_.front().stamped.stamp)) {
    const PendingCloud pending = std::move(pending_.front());
    pending_.pop_front();
    const Result<RigidTransform> T_WB = poses_.At(pending.stamped.stamp);
    if (T_WB) {
      Fuse(pending.stamped, pending.camera, *T_WB * options_.T_BC);
    } else {
      bus_.health().Drop<topics::DepthPoints>(T_WB.error());
    }
  }
}

void SurfaceService::Fuse(const dds::StampedCloud& cloud, const PinholeCamera& camera,
                          const RigidTransform& T_WC) {
  const Stopwatch stopwatch;
  const auto changed = surface_.Fuse(cloud.cloud, camera, T_WC);
  unmeshed_.insert(changed.begin(), changed.end());
  unstored_.insert(changed.begin(), changed.end());
  fused_stamp_ = cloud.stamp;
  ++scans_;
  bus_.health().Timed("fusion", stopwatch.Milliseconds());
  if (surface_.full() && !std::exchange(was_full_, true)) {
    spdlog::warn("the surface takes surface.most_memory_mb: nothing new is added to it");
  }
}

thalweg_msgs::msg::SurfaceUpdate SurfaceService::NewUpdate(bool full) const {
  thalweg_msgs::msg::SurfaceUpdate update;
  update.header().frame_id(dds::kMapFrame);
  update.header().stamp(dds::ToIdl(fused_stamp_));
  update.session(session_);
  update.number(number_);
  update.full(full);
  update.voxel_size_m(options_.surface.voxel_size);
  return update;
}

void SurfaceService::Publish() {
  if (scans_ != scans_stated_) PublishStatus();
  if (unmeshed_.empty()) return;
  const Stopwatch stopwatch;
  const std::vector<VoxelIndex> changed(unmeshed_.begin(), unmeshed_.end());
  unmeshed_.clear();
  const auto updated = mesh_.Update(surface_.volume(), changed);
  if (updated.empty()) return;
  ++number_;
  thalweg_msgs::msg::SurfaceUpdate update = NewUpdate(false);
  for (const VoxelIndex& block : updated) {
    const auto found = mesh_.blocks().find(block);
    update.blocks().push_back(
        ToIdl(block, found == mesh_.blocks().end() ? nullptr : &found->second, options_.surface.limits));
  }
  updates_out_.Write(update);
  bus_.health().Timed("mesh", stopwatch.Milliseconds());
}

void SurfaceService::PublishStatus() {
  thalweg_msgs::msg::SurfaceStatus status;
  status.header() = NewUpdate(false).header();
  status.scans(scans_);
  const SurfaceArea& area = mesh_.area();
  status.area_m2(area.seen);
  status.inspected_m2(area.inspected);
  status.fine_m2(area.fine);
  const InspectionLimits& limits = options_.surface.limits;
  status.inspection_distance_m(static_cast<double>(limits.distance));
  status.inspection_angle_deg(std::acos(static_cast<double>(limits.cosine)) / kDegree);
  status.sampling_m(static_cast<double>(limits.sampling));
  status.bytes(surface_.volume().bytes());
  status.full(surface_.full());
  status_out_.Write(status);
  scans_stated_ = scans_;
}

void SurfaceService::OnRequest(const thalweg_msgs::msg::MapRequest& message) {
  const Result<Time> stamp = dds::FromIdl(message.header(), dds::kMapFrame);
  if (!stamp) return bus_.health().Reject<topics::SurfaceRequests>(stamp.error());
  full_copy_wanted_ = true;
  PublishFullCopyWhenDue();
}

void SurfaceService::PublishFullCopyWhenDue() {
  const double period_ms = Seconds(options_.full_copy_period) * 1e3;
  if (!full_copy_wanted_ || (since_full_copy_ && since_full_copy_->Milliseconds() < period_ms)) return;
  const Stopwatch stopwatch;
  thalweg_msgs::msg::SurfaceUpdate update = NewUpdate(true);
  for (const auto& [block, mesh] : mesh_.blocks()) {
    update.blocks().push_back(ToIdl(block, &mesh, options_.surface.limits));
  }
  updates_out_.Write(update);
  full_copy_wanted_ = false;
  since_full_copy_ = Stopwatch();
  bus_.health().Timed("full copy", stopwatch.Milliseconds());
}

void SurfaceService::WriteCheckpoint() {
  if (unstored_.empty() || disk_.busy()) return;
  const Stopwatch stopwatch;
  const std::vector<VoxelIndex> changed(unstored_.begin(), unstored_.end());
  unstored_.clear();
  file_.Update(surface_.volume(), changed);
  bus_.health().Timed("checkpoint, compressed", stopwatch.Milliseconds());
  disk_.Run([this, bytes = file_.Bytes(options_.surface.voxel_size)] {
    try {
      WriteFile(options_.out / kCheckpointFile, bytes);
    } catch (const std::runtime_error& error) {
      // The next checkpoint, after the next scan, has all of it.
      bus_.Post([this, text = std::string(error.what())] {
        bus_.health().FileNotWritten(text);
        spdlog::error("{}; what is on disk stays whole", text);
      });
    }
  });
}

void SurfaceService::Save() {
  disk_.Wait();
  const std::vector<VoxelIndex> unmeshed(unmeshed_.begin(), unmeshed_.end());
  mesh_.Update(surface_.volume(), unmeshed);
  unmeshed_.clear();
  SeparateWrites writes;
  if (options_.checkpoint_period > Duration::zero()) {
    writes.Try([&] {
      const std::vector<VoxelIndex> unstored(unstored_.begin(), unstored_.end());
      file_.Update(surface_.volume(), unstored);
      WriteFile(options_.out / kCheckpointFile, file_.Bytes(options_.surface.voxel_size));
    });
  }
  writes.Try([&] { WriteFile(options_.out / kMeshFile, PlyOf(mesh_.Joined())); });
  const SurfaceArea& area = mesh_.area();
  spdlog::info("surface: {:.1f} m2 seen, {:.1f} m2 of it inspected, {:.1f} m2 sampled at {} m, {} blocks",
               area.seen, area.inspected, area.fine, options_.surface.limits.sampling,
               surface_.volume().block_count());
  writes.ThrowErrors();
}

}  // namespace thalweg::surface
