#include "services/mapper/adapter/mapper_service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/duration_text.h"
#include "common/base/size_text.h"
#include "common/base/text.h"
#include "common/dds/clock_problem.h"
#include "common/files/write_file.h"
#include "common/voxel/map_agreement.h"
#include "services/mapper/adapter/map_files.h"
#include "services/mapper/core/cloud_units.h"
#include "services/mapper/core/map_patch.h"

namespace thalweg::mapper {
namespace {

namespace topics = dds::topics;

constexpr auto kSavePeriod = std::chrono::milliseconds(100);  ///< Between looks whether a save can begin.
constexpr int kMostCloudsToCompare = 5;  ///< If the first ones show nothing that the map knows.

/// Says what became of the journal beside a checkpoint.
void LogUse(const JournalUse& use, const std::filesystem::path& journal_file) {
  if (use.problem.empty()) return;
  if (use.ends) {
    spdlog::warn("{}: {}; {} scans before it are used, {} bytes from there on are cut off",
                 journal_file.string(), use.problem, use.applied, use.unused_bytes);
  } else {
    spdlog::warn("{}: {}; {} scans of it are used; {}", journal_file.string(), use.problem, use.applied,
                 SetAside(journal_file));
  }
}

/// Why a cloud waited for its pose in vain.
std::string NotReachedText(Time cloud, const std::optional<Time>& odometry) {
  if (!odometry) return "no odometry has come";
  return "its stamp is " + DurationText(Seconds(cloud - *odometry)) +
         " ahead of the newest odometry: does that come, and by one clock?";
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

/// What the sensor means by a depth of +infinity.
dds::Infinity InfinityFor(const OccupancyMap::Options& map) {
  return map.no_return ? dds::Infinity::kNoReturn : dds::Infinity::kNoMeasurement;
}

}  // namespace

MapperService::Start MapperService::StartFrom(const MapperOptions& options) {
  // First, because it rejects bad options before any file is read.
  Start start{.map = MakeMap(options.engine, options.map)};
  if (options.checkpoint_period == Duration::zero()) return start;
  const Stopwatch stopwatch;
  const std::filesystem::path file = options.out / kCheckpointFile;
  Result<std::optional<StoredMap>> loaded = LoadStoredMap(file);
  if (!loaded) {
    spdlog::warn("{}; {}; starting with an empty map", loaded.error(), SetAside(file));
    SetAside(JournalOf(file));
    return start;
  }
  if (!loaded->has_value()) return start;
  auto& [checkpoint, journal] = **loaded;
  if (checkpoint.grid.voxel_size() != options.map.voxel_size) {
    throw std::runtime_error(file.string() + " has voxels of " + NumberText(checkpoint.grid.voxel_size()) +
                             " m, mapper.voxel_size_m is " + NumberText(options.map.voxel_size) +
                             ": choose another --out or remove the file");
  }
  LogUse(journal, JournalOf(file));
  const double resumed_ms = stopwatch.Milliseconds();
  spdlog::info(
      "resuming from {} with {} blocks, after {} scans, {} of them from its journal; loaded in {:.0f} ms",
      file.string(), checkpoint.grid.block_count(), checkpoint.position.number, journal.applied, resumed_ms);
  return {.map = MakeMap(options.engine, options.map, std::move(checkpoint.grid)),
          .colors = std::move(checkpoint.colors),
          .position = checkpoint.position,
          .journal = std::move(journal.ends),
          .resumed_ms = resumed_ms};
}

MapperService::MapperService(const MapperOptions& options, dds::Bus& bus)
    : MapperService(options, bus, StartFrom(options)) {}

MapperService::MapperService(const MapperOptions& options, dds::Bus& bus, Start start)
    : options_(options),
      bus_(bus),
      filter_(MakeFilter(options.filter)),
      map_(std::move(start.map)),
      colors_(std::move(start.colors)),
      log_(dds::MapLog::MakeSession(), options.map.voxel_size),
      placement_(bus.health()),
      depth_images_(bus, InfinityFor(options.map)),
      clouds_to_compare_(map_->empty() ? 0 : kMostCloudsToCompare),
      snapshot_due_(!map_->empty()),
      points_due_(snapshot_due_),
      colors_due_(!colors_.blocks().empty()),
      updates_out_(bus.Advertise<topics::MapUpdates>()),
      octomap_out_(bus.Advertise<topics::Octomap>()),
      points_out_(bus.Advertise<topics::OccupiedPoints>()),
      colored_out_(bus.Advertise<topics::ColoredPoints>()),
      transforms_out_(bus.Advertise<topics::StaticTransforms>()),
      replies_out_(bus.Advertise<topics::CommandReplies>()) {
  if (start.resumed_ms) bus.health().Timed(kResumeTiming, *start.resumed_ms);
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  if (options.reads_images) {
    bus.Subscribe<topics::DepthImage>([this](const auto& message) { OnDepth(message); });
    bus.Subscribe<topics::DepthCameraInfo>([this](const auto& message) { OnDepth(message); });
  } else {
    bus.Subscribe<topics::DepthPoints>([this](const auto& message) { OnCloud(message); });
  }
  const std::optional<RigidTransform> stated =
      options.states_camera ? std::optional(options.T_BC) : std::nullopt;
  transforms_out_.Write(dds::StaticTransformsToIdl(Time{}, stated));  // kept for those who join later
  bus.Subscribe<topics::MapRequests>([this](const auto& message) { OnRequest(message); });
  bus.Subscribe<topics::OperatorCommands>([this](const auto& message) { OnCommand(message); });
  bus.EveryWall(kSavePeriod, [this] { SaveWhenDue(); });
  bus.EveryWall(options.full_copy_period, [this] { PublishFullCopyWhenDue(); });
  bus.EveryWall(options.snapshot_period, [this] { PublishSnapshot(); });
  if (options.checkpoint_period > Duration::zero()) {
    keeper_.emplace(MapKeeper::Options{.checkpoint_file = options.out / kCheckpointFile},
                    options.map.voxel_size, start.position, std::move(start.journal),
                    [this](const MapKeeper::Event& event) { bus_.Post([this, event] { OnKept(event); }); });
    bus.EveryWall(options.checkpoint_period, [this] { MaintainFiles(); });
  }
}

void MapperService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const Result<dds::StampedPose> pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  if (placement_.JudgePose(pose->stamp) == StampOrder::Verdict::kNotLater) return;
  placement_.poses().Add(pose->stamp, pose->T);
  TakePending();
}

void MapperService::OnCloud(const sensor_msgs::msg::PointCloud2& message) {
  const Stopwatch since_arrival;
  Result<dds::StampedCloud> cloud = dds::FromIdl(message, InfinityFor(options_.map));
  if (!cloud) return bus_.health().Reject<topics::DepthPoints>(cloud.error());
  AddCloud(*std::move(cloud), topics::DepthPoints::kName, since_arrival);
}

template <class Message>
void MapperService::OnDepth(const Message& message) {
  const Stopwatch since_arrival;
  std::optional<dds::DepthImages::Cloud> cloud = depth_images_.Add(message);
  if (cloud) AddCloud(std::move(cloud->stamped), topics::DepthImage::kName, since_arrival);
}

void MapperService::AddCloud(dds::StampedCloud cloud, const char* topic, const Stopwatch& since_arrival) {
  if (const auto problem = dds::MissingStamp(cloud.stamp, bus_.Now()))
    return bus_.health().Reject(topic, *problem);
  if (IsOfOtherUnits(cloud.cloud, options_.map.max_range)) {
    return bus_.health().Reject(topic, "nearly all of its points are more than " +
                                           NumberText(FarthestPlausible(options_.map.max_range)) +
                                           " m away: they must be in meters, are they in millimeters?");
  }
  const std::optional<PinholeCamera>& no_return = options_.map.no_return;
  const int width_px = cloud.cloud.width_px;
  const int height_px = cloud.cloud.height_px;
  if (no_return && (width_px != no_return->width_px || height_px != no_return->height_px) &&
      ForgetNoReturns(cloud.cloud)) {
    bus_.health().Drop(
        topic,
        "only rays without a return: their directions are known only in clouds of depth_sensor's size, " +
            SizeText(no_return->width_px, no_return->height_px) + ", and this cloud is " +
            SizeText(width_px, height_px));
  }
  const StampOrder::Verdict order = placement_.JudgeCloud(cloud.stamp, topic);
  if (order == StampOrder::Verdict::kNotLater) return;
  if (order == StampOrder::Verdict::kRestarted) pending_.clear();
  if (const std::size_t missing = options_.counts_gaps ? gaps_.Add(cloud.stamp) : 0; missing > 0) {
    bus_.health().Drop(topic, "missing by their stamps: lost on the way, or never sent", missing);
  }
  if (pending_.size() == kMaxPendingClouds) {
    bus_.health().Drop(topic, NotReachedText(pending_.front().stamped.stamp, placement_.newest_pose()));
    pending_.pop_front();
  }
  pending_.push_back({std::move(cloud), since_arrival, topic});
  TakePending();
}

void MapperService::TakePending() {
  while (!pending_.empty() && placement_.poses().Reaches(pending_.front().stamped.stamp)) {
    PendingCloud pending = std::move(pending_.front());
    pending_.pop_front();
    const auto T_WB = placement_.PoseAt(pending.stamped.stamp, pending.topic);
    if (T_WB) Integrate(pending, *T_WB * options_.T_BC);
  }
}

void MapperService::Integrate(PendingCloud& pending, const RigidTransform& T_WC) {
  PointCloud& cloud = pending.stamped.cloud;
  if (clouds_to_compare_ > 0) ComparePlace(cloud, T_WC);
  WriteCheckpointWhenNeeded();
  if (filter_) {
    const Stopwatch filtering;
    filter_->Apply(cloud);
    Record("filter", filtering.Milliseconds());
  }
  const Stopwatch stopwatch;
  const std::span<const VoxelChange> changes = map_->Integrate(cloud, T_WC);
  Record("integration", stopwatch.Milliseconds());
  MapPatch patch;
  if (!cloud.colors.empty()) {
    for (const Hit& hit : map_->hits()) {
      const VoxelColors::Added added = colors_.Add(hit.voxel, cloud.colors[hit.pixel]);
      patch.colors.push_back({hit.voxel, added.mean});
      colors_due_ |= added.changed;
    }
  }
  if (keeper_) {
    patch.voxels.assign(changes.begin(), changes.end());
    keeper_->Add(std::move(patch));
  }
  log_.Add(pending.stamped.stamp, {.T_WC = T_WC, .measured = MeasuredShares::Of(cloud)}, changes);
  // Even without changes: readers also need to know where the camera looked from
  updates_out_.Write(log_.TakeUpdate());
  Record("scan to update", pending.since_arrival.Milliseconds());
  if (changes.empty()) return;
  snapshot_due_ = true;
  points_due_ = true;
  colors_due_ |= !colors_.blocks().empty();  // another voxel may be occupied
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
  auto copy = std::make_shared<const Checkpoint>(CopyOfMap());
  background_.Run([this, copy, ids = std::exchange(saves_due_, {})] {
    std::string error;
    try {
      if (keeper_) keeper_->WriteCheckpoint(*copy);
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
  updates_out_.Write(log_.FullCopy(map_->Snapshot()));
  full_copy_wanted_ = false;
  since_full_copy_ = Stopwatch();
  Record("full copy", stopwatch.Milliseconds());
}

void MapperService::ComparePlace(const PointCloud& cloud, const RigidTransform& T_WC) {
  // Farther away, the errors of sensor and pose are too large.
  constexpr double kFarthest = 4.0;  // [m]
  const MapAgreement agreement =
      Compare(map_->Snapshot(), cloud, T_WC, std::min(kFarthest, options_.map.max_range));
  const std::string file = (options_.out / kCheckpointFile).string();
  if (agreement.IsOfAnotherPlace()) throw std::runtime_error(AnotherPlaceText(agreement, file));
  --clouds_to_compare_;
  if (!agreement.IsTelling()) return;
  clouds_to_compare_ = 0;
  spdlog::info("{} agrees with {} of {} rays", file, agreement.agreeing, agreement.known());
}

Checkpoint MapperService::CopyOfMap() const {
  return {map_->Snapshot(), colors_, keeper_ ? keeper_->position() : MapPosition{}};
}

void MapperService::WriteCheckpointWhenNeeded() {
  if (!keeper_ || disk_.busy() || !keeper_->NeedsCheckpoint()) return;
  const Stopwatch stopwatch;
  auto copy = std::make_shared<const Checkpoint>(CopyOfMap());
  Record("checkpoint, copy", stopwatch.Milliseconds());
  disk_.Run([this, copy] {
    const Stopwatch in_background;
    try {
      keeper_->WriteCheckpoint(*copy);
    } catch (const std::runtime_error&) {
      return;  // which the keeper has reported
    }
    bus_.Post([this, took = in_background.Milliseconds()] { Record("checkpoint, in background", took); });
  });
}

void MapperService::MaintainFiles() {
  // Before the first scan there is nothing to do, and its checkpoint must not wait for that.
  if (disk_.busy() || updates() == 0) return;
  if (keeper_->NeedsCheckpoint()) return WriteCheckpointWhenNeeded();
  disk_.Run([this] {
    const Stopwatch in_background;
    keeper_->Maintain();
    bus_.Post([this, took = in_background.Milliseconds()] {
      Record("journal sync, in background", took);
      WriteCheckpointWhenNeeded();
    });
  });
}

void MapperService::OnKept(const MapKeeper::Event& event) {
  switch (event.kind) {
    case MapKeeper::Event::Kind::kStored:
      ++journal_scans_;
      journal_bytes_ += event.bytes;
      return Record("journal, in background", event.milliseconds);
    case MapKeeper::Event::Kind::kFailed:
      bus_.health().FileNotWritten(event.text);
      if (std::exchange(files_fail_, true)) return;
      return spdlog::error("{}; what is on disk stays whole, the next attempt is in {} s", event.text,
                           Seconds(options_.checkpoint_period));
    case MapKeeper::Event::Kind::kRecovered:
      files_fail_ = false;
      const std::string text =
          (options_.out / kCheckpointFile).string() + " can be written again, and no scan is missing";
      bus_.health().Drop(dds::Health::kFiles, text, 0);  // for those who have read of the failure
      return spdlog::info(text);
  }
}

void MapperService::PublishSnapshot() {
  // Building an octree takes long, so none is built while nobody listens; a new listener gets one within a
  // period.
  const bool octomap = snapshot_due_ && octomap_out_.readers() > 0;
  const bool points = points_due_ && points_out_.readers() > 0;
  const bool colored = colors_due_ && colored_out_.readers() > 0;
  if ((!octomap && !points && !colored) || background_.busy()) return;
  auto copy = std::make_shared<const OccupancyGrid>(map_->Snapshot());
  auto colors = colored ? std::make_shared<const VoxelColors>(colors_) : nullptr;
  if (octomap) snapshot_due_ = false;
  if (points) points_due_ = false;
  if (colored) colors_due_ = false;
  background_.Run([this, copy, colors, octomap, points,
                   stamp = placement_.newest_cloud().value_or(bus_.Now())] {
    const Stopwatch in_background;
    if (octomap) octomap_out_.Write(ToIdl(stamp, *ToOcTree(*copy)));
    if (points) points_out_.Write(dds::ToIdl(stamp, OccupiedPoints(*copy)));
    if (colors) colored_out_.Write(dds::ToIdl(stamp, ColoredPoints(*copy, *colors)));
    bus_.Post([this, took = in_background.Milliseconds()] { Record("maps for tools, in background", took); });
  });
}

void MapperService::Save() {
  disk_.Wait();
  background_.Wait();
  SeparateWrites writes;
  if (keeper_) {
    writes.Try([&] { keeper_->WriteCheckpoint(CopyOfMap()); });
    if (journal_scans_ > 0) {
      spdlog::info("{} scans went through the journal, {} bytes each", journal_scans_,
                   journal_bytes_ / journal_scans_);
    }
  }
  writes.Try([&] { SaveMap(map_->Snapshot(), colors_, options_.out); });
  writes.ThrowErrors();
}

void MapperService::Record(const std::string& name, double milliseconds) {
  bus_.health().Timed(name, milliseconds);
}

}  // namespace thalweg::mapper
