#include "services/mapper/adapter/mapper_service.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/files/write_file.h"
#include "services/mapper/adapter/map_files.h"

namespace thalweg::mapper {
namespace {

namespace topics = dds::topics;

constexpr auto kSavePeriod = std::chrono::milliseconds(100);  ///< Between looks whether a save can begin.

/// The map to start with: the checkpoint's, if there is a valid one, else an empty map. Fills `colors`
/// likewise.
OccupancyMap StartFrom(const MapperOptions& options, VoxelColors& colors) {
  OccupancyMap empty(options.map);  // first, because it rejects bad options before any file is read
  if (options.checkpoint_period == Duration::zero()) return empty;
  const std::filesystem::path file = options.out / MapperService::kCheckpointFile;
  Result<std::optional<Checkpoint>> loaded = LoadCheckpoint(file);
  if (!loaded) {
    spdlog::warn("{}; starting with an empty map", loaded.error());
    return empty;
  }
  if (!loaded->has_value()) return empty;
  Checkpoint& checkpoint = **loaded;
  if (checkpoint.grid.voxel_size() != options.map.voxel_size) {
    throw std::runtime_error(file.string() + " has voxels of " +
                             std::to_string(checkpoint.grid.voxel_size()) + " m, mapper.voxel_size_m is " +
                             std::to_string(options.map.voxel_size) +
                             ": choose another --out or remove the file");
  }
  spdlog::info("resuming from {} with {} blocks", file.string(), checkpoint.grid.block_count());
  colors = std::move(checkpoint.colors);
  return {options.map, std::move(checkpoint.grid)};
}

/// Marks rays without a return as not measured, for clouds whose ray directions are unknown.
/// @return Whether there were any.
bool ForgetNoReturns(PointCloud& cloud) {
  bool any = false;
  for (Eigen::Vector3f& p_C : cloud.points_C) {
    if (!IsNoReturn(p_C)) continue;
    p_C.setConstant(std::numeric_limits<float>::quiet_NaN());
    any = true;
  }
  return any;
}

std::string SizeText(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

}  // namespace

MapperService::MapperService(const MapperOptions& options, dds::Bus& bus)
    : options_(options),
      bus_(bus),
      map_(StartFrom(options, colors_)),
      log_(dds::MapLog::MakeSession(), options.map.voxel_size),
      snapshot_due_(map_.grid().block_count() > 0),
      updates_out_(bus.Advertise<topics::MapUpdates>()),
      octomap_out_(bus.Advertise<topics::Octomap>()),
      replies_out_(bus.Advertise<topics::CommandReplies>()) {
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  bus.Subscribe<topics::DepthPoints>([this](const auto& message) { OnCloud(message); });
  bus.Subscribe<topics::MapRequests>([this](const auto& message) { OnRequest(message); });
  bus.Subscribe<topics::OperatorCommands>([this](const auto& message) { OnCommand(message); });
  bus.EveryWall(kSavePeriod, [this] { SaveWhenDue(); });
  bus.EveryWall(options.full_copy_period, [this] { PublishFullCopyWhenDue(); });
  bus.EveryWall(options.snapshot_period, [this] { PublishSnapshot(); });
  if (options.checkpoint_period > Duration::zero()) {
    bus.EveryWall(options.checkpoint_period, [this] { WriteCheckpoint(); });
  }
}

void MapperService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const Result<dds::StampedPose> pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  if (odometry_stamp_ && pose->stamp <= *odometry_stamp_) {
    if (*odometry_stamp_ - pose->stamp < kClockRestart) {
      return bus_.health().Drop<topics::Odometry>("not later than the previous one");
    }
    bus_.health().Drop<topics::Odometry>("time jumped back: earlier poses discarded");
    poses_.Clear();
  }
  odometry_stamp_ = pose->stamp;
  poses_.Add(pose->stamp, pose->T);
  TakePending();
}

void MapperService::OnCloud(const sensor_msgs::msg::PointCloud2& message) {
  const Stopwatch since_arrival;
  const std::optional<PinholeCamera>& no_return = options_.map.no_return;
  Result<dds::StampedCloud> cloud =
      dds::FromIdl(message, no_return ? dds::Infinity::kNoReturn : dds::Infinity::kNoMeasurement);
  if (!cloud) return bus_.health().Reject<topics::DepthPoints>(cloud.error());
  const int width_px = cloud->cloud.width_px;
  const int height_px = cloud->cloud.height_px;
  if (no_return && (width_px != no_return->width_px || height_px != no_return->height_px) &&
      ForgetNoReturns(cloud->cloud)) {
    bus_.health().Drop<topics::DepthPoints>(
        "only rays without a return: their directions are known only in clouds of depth_sensor's size, " +
        SizeText(no_return->width_px, no_return->height_px) + ", and this cloud is " +
        SizeText(width_px, height_px));
  }
  if (cloud_stamp_ && cloud->stamp <= *cloud_stamp_) {
    if (*cloud_stamp_ - cloud->stamp < kClockRestart) {
      return bus_.health().Drop<topics::DepthPoints>("not later than the previous one");
    }
    bus_.health().Drop<topics::DepthPoints>("time jumped back: earlier clouds discarded");
    pending_.clear();
    // Poses from before the jump must not place this cloud; poses that already follow the jump may.
    if (odometry_stamp_ && *odometry_stamp_ - cloud->stamp >= kClockRestart) poses_.Clear();
  }
  cloud_stamp_ = cloud->stamp;
  if (pending_.size() == kMaxPendingClouds) {
    bus_.health().Drop<topics::DepthPoints>("no odometry has reached its stamp");
    pending_.pop_front();
  }
  pending_.push_back({*std::move(cloud), since_arrival});
  TakePending();
}

void MapperService::TakePending() {
  while (!pending_.empty() && poses_.Reaches(pending_.front().stamped.stamp)) {
    const PendingCloud pending = std::move(pending_.front());
    pending_.pop_front();
    const Result<RigidTransform> T_WB = poses_.At(pending.stamped.stamp);
    if (T_WB) {
      Integrate(pending, *T_WB * options_.T_BC);
    } else {
      bus_.health().Drop<topics::DepthPoints>(T_WB.error());
    }
  }
}

void MapperService::Integrate(const PendingCloud& pending, const RigidTransform& T_WC) {
  const PointCloud& cloud = pending.stamped.cloud;
  const Stopwatch stopwatch;
  const std::span<const VoxelChange> changes = map_.Integrate(cloud, T_WC);
  Record("integration", stopwatch.Milliseconds());
  if (!cloud.colors.empty()) {
    for (const OccupancyMap::Hit& hit : map_.hits()) colors_.Add(hit.voxel, cloud.colors[hit.pixel]);
  }
  log_.Add(pending.stamped.stamp, {.T_WC = T_WC, .measured = MeasuredShares::Of(cloud)}, changes);
  // Even without changes: readers also need to know where the camera looked from
  updates_out_.Write(log_.TakeUpdate());
  Record("scan to update", pending.since_arrival.Milliseconds());
  if (changes.empty()) return;
  checkpoint_due_ = true;
  snapshot_due_ = true;
}

void MapperService::OnRequest(const thalweg_msgs::msg::MapRequest& message) {
  const Result<Time> stamp = dds::FromIdl(message.header(), dds::kMapFrame);
  if (!stamp) return bus_.health().Reject<topics::MapRequests>(stamp.error());
  full_copy_wanted_ = true;
  PublishFullCopyWhenDue();
}

void MapperService::OnCommand(const thalweg_msgs::msg::OperatorCommand& message) {
  if (message.kind() != thalweg_msgs::msg::COMMAND_SAVE_MAP) return;  // for the explorer
  const dds::CommandId id = dds::IdOf(message);
  if (!commands_.Begin(id)) {  // sent again: answered again, but not carried out again
    if (const auto* const reply = commands_.ReplyTo(id)) replies_out_.Write(*reply);
    return;
  }
  // One save answers all that wait for it. So many who wait at a time are no operators.
  constexpr std::size_t kMostWaiting = 16;
  if (saves_due_.size() >= kMostWaiting) return Reply(id, false, "too many wait for the map to be saved");
  saves_due_.push_back(id);
  SaveWhenDue();
}

void MapperService::SaveWhenDue() {
  if (saves_due_.empty() || background_.busy()) return;
  auto copy = std::make_shared<const Checkpoint>(CopyOf(map_.grid()), colors_);
  background_.Run([this, copy, ids = std::exchange(saves_due_, {})] {
    std::string error;
    try {
      if (options_.checkpoint_period > Duration::zero()) {
        WriteFile(options_.out / kCheckpointFile, EncodeCheckpoint(copy->grid, copy->colors));
      }
      SaveMap(copy->grid, copy->colors, options_.out);
    } catch (const std::exception& failure) {
      error = failure.what();
    }
    bus_.Post([this, ids, error] {
      for (const dds::CommandId& id : ids) {
        Reply(id, error.empty(), error.empty() ? "the map is saved in " + options_.out.string() : error);
      }
    });
  });
}

void MapperService::Reply(const dds::CommandId& id, bool accepted, const std::string& reason) {
  spdlog::info("command {} of {}: {}{}", id.number, id.sender, accepted ? "" : "refused: ", reason);
  const auto reply = dds::MakeReply(bus_.Now(), "mapper", id, accepted, reason);
  commands_.Finish(id, reply);
  replies_out_.Write(reply);
}

void MapperService::PublishFullCopyWhenDue() {
  const double period_ms = Seconds(options_.full_copy_period) * 1e3;
  if (!full_copy_wanted_ || (since_full_copy_ && since_full_copy_->Milliseconds() < period_ms)) return;
  const Stopwatch stopwatch;
  updates_out_.Write(log_.FullCopy(map_.grid()));
  full_copy_wanted_ = false;
  since_full_copy_ = Stopwatch();
  Record("full copy", stopwatch.Milliseconds());
}

void MapperService::WriteCheckpoint() {
  if (!checkpoint_due_ || background_.busy()) return;
  const Stopwatch stopwatch;
  auto copy = std::make_shared<const Checkpoint>(CopyOf(map_.grid()), colors_);
  checkpoint_due_ = false;
  background_.Run([this, copy, file = options_.out / kCheckpointFile] {
    const Stopwatch in_background;
    std::optional<std::string> failure;
    try {
      WriteFile(file, EncodeCheckpoint(copy->grid, copy->colors));
    } catch (const std::exception& error) {
      failure = error.what();
    }
    bus_.Post([this, failure] { OnCheckpoint(failure); });
    bus_.Post([this, took = in_background.Milliseconds()] { Record("checkpoint, in background", took); });
  });
  Record("checkpoint, copy", stopwatch.Milliseconds());
}

void MapperService::OnCheckpoint(const std::optional<std::string>& error) {
  if (error) {
    checkpoint_due_ = true;
    bus_.health().FileNotWritten(*error);
  }
  if (error.has_value() == std::exchange(checkpoint_fails_, error.has_value())) return;
  if (error) {
    spdlog::error("{}; the previous checkpoint stays, the next attempt is in {} s", *error,
                  Seconds(options_.checkpoint_period));
  } else {
    spdlog::info("{} can be written again", kCheckpointFile);
  }
}

void MapperService::PublishSnapshot() {
  // Building an octree takes long, so none is built while nobody listens; a new listener gets one within a
  // period.
  if (!snapshot_due_ || octomap_out_.readers() == 0 || background_.busy()) return;
  auto copy = std::make_shared<const OccupancyGrid>(CopyOf(map_.grid()));
  snapshot_due_ = false;
  background_.Run([this, copy, stamp = cloud_stamp_.value_or(bus_.Now())] {
    const Stopwatch in_background;
    octomap_out_.Write(ToIdl(stamp, *ToOcTree(*copy)));
    bus_.Post([this, took = in_background.Milliseconds()] { Record("octomap, in background", took); });
  });
}

void MapperService::Save() {
  background_.Wait();
  SeparateWrites writes;
  if (options_.checkpoint_period > Duration::zero()) {
    writes.Try([&] { WriteFile(options_.out / kCheckpointFile, EncodeCheckpoint(map_.grid(), colors_)); });
  }
  writes.Try([&] { SaveMap(map_.grid(), colors_, options_.out); });
  writes.ThrowErrors();
}

void MapperService::Record(const std::string& name, double milliseconds) {
  bus_.health().Timed(name, milliseconds);
}

}  // namespace thalweg::mapper
