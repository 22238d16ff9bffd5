#include "services/surface/adapter/surface_service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/base/angles.h"
#include "common/base/text.h"
#include "common/dds/map_log.h"
#include "common/files/write_file.h"
#include "common/voxel/map_agreement.h"
#include "services/surface/adapter/mesh_message.h"
#include "services/surface/adapter/mesh_ply.h"
#include "services/surface/adapter/rift_message.h"

namespace thalweg::surface {
namespace {

namespace topics = dds::topics;

/// Rifts are found again after so many times the time that this took: however large the surface, it takes at
/// most about a tenth of the time.
constexpr double kRiftPause = 9.0;

/// What the sensor means by a depth of +infinity.
dds::Infinity InfinityFor(const SurfaceServiceOptions& options) {
  return options.infinity_is_free ? dds::Infinity::kNoReturn : dds::Infinity::kNoMeasurement;
}

double DegreesOf(float cosine) {
  return std::acos(static_cast<double>(cosine)) / kDegree;
}

/// Throws rather than to mix what was fused under different options.
void CheckFits(const VolumeFile& file, const FusedSurface::Options& options, const std::string& name) {
  const auto check = [&](const std::string& option, double has, double wanted) {
    if (has == wanted) return;
    throw std::runtime_error(name + " was written with surface." + option + " " + NumberText(has) +
                             ", which is now " + NumberText(wanted) +
                             ": choose another --out or remove the file");
  };
  check("voxel_size_m", file.voxel_size(), options.voxel_size);
  check("inspection_distance_m", static_cast<double>(file.limits().distance),
        static_cast<double>(options.limits.distance));
  check("inspection_angle_deg", DegreesOf(file.limits().cosine), DegreesOf(options.limits.cosine));
}

StoredVolume VolumeToBeginWith(const SurfaceServiceOptions& options) {
  const FusedSurface::Options& surface = options.surface;
  StoredVolume nothing{TruncatedVolume(surface.voxel_size), VolumeFile(surface.voxel_size, surface.limits)};
  if (options.checkpoint_period == Duration::zero()) return nothing;
  const std::filesystem::path file = options.out / SurfaceService::kCheckpointFile;
  Result<std::optional<StoredVolume>> loaded = LoadVolume(file);
  if (!loaded) {
    spdlog::warn("{}; {}; starting with an empty surface", loaded.error(), SetAside(file));
    return nothing;
  }
  if (!loaded->has_value()) return nothing;
  CheckFits((*loaded)->file, surface, file.string());
  spdlog::info("resuming from {} with {} blocks", file.string(), (*loaded)->volume.block_count());
  return std::move(**loaded);
}

/// About as many bytes as the message takes.
std::size_t BytesOf(const thalweg_msgs::msg::SurfaceBlock& block) {
  constexpr std::size_t kHead = 48;
  return kHead + sizeof(float) * block.points_m().size() + block.normals().size() + block.colors().size() +
         block.views().size() + sizeof(std::uint16_t) * block.faces().size();
}

}  // namespace

SurfaceService::SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus)
    : SurfaceService(options, bus, VolumeToBeginWith(options)) {}

SurfaceService::SurfaceService(const SurfaceServiceOptions& options, dds::Bus& bus, StoredVolume start)
    : options_(options),
      bus_(bus),
      views_(bus, InfinityFor(options), options.continuity),
      live_(options.surface, std::move(start.volume)),
      session_(dds::MapLog::MakeSession()),
      file_(std::move(start.file)),
      updates_out_(bus.Advertise<topics::SurfaceUpdates>()),
      status_out_(bus.Advertise<topics::SurfaceStatus>()),
      rifts_out_(bus.Advertise<topics::SurfaceRifts>()),
      rift_markers_out_(bus.Advertise<topics::RiftMarkers>()) {
  if (live_.surface().volume().block_count() > 0) {
    resumed_.emplace(live_.surface().volume());
    PublishStatus();
    PublishRifts();
  }
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  if (options.reads_images) {
    bus.Subscribe<topics::DepthImage>([this](const auto& message) { OnDepth(message); });
    bus.Subscribe<topics::DepthCameraInfo>([this](const auto& message) { OnDepth(message); });
  } else {
    bus.Subscribe<topics::DepthPoints>([this](const auto& message) { OnDepth(message); });
  }
  bus.Subscribe<topics::SurfaceRequests>([this](const auto& message) { OnRequest(message); });
  bus.Subscribe<topics::OperatorCommands>([this](const auto& message) { OnCommand(message); });
  bus.EveryWall(options.publish_period, [this] {
    publish_due_ = true;
    BeginWork();
  });
  bus.EveryWall(options.full_copy_period, [this] { BeginWork(); });
  if (options.checkpoint_period > Duration::zero()) {
    bus.EveryWall(options.checkpoint_period, [this] {
      store_due_ = true;
      BeginWork();
    });
  }
}

const SurfaceMesh& SurfaceService::mesh() const {
  worker_.Wait();
  return live_.mesh();
}

const FusedSurface& SurfaceService::surface() const {
  worker_.Wait();
  return live_.surface();
}

std::uint64_t SurfaceService::updates() const {
  worker_.Wait();
  return number_;
}

void SurfaceService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const Result<dds::StampedPose> pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  views_.AddPose(*pose);
  TakePlaced();
}

template <class Message>
void SurfaceService::OnDepth(const Message& message) {
  views_.Add(message);
  TakePlaced();
}

void SurfaceService::TakePlaced() {
  for (PlacedCloud& cloud : views_.Take()) {
    if (to_fuse_.size() == kMaxWaiting) {
      bus_.health().Drop(cloud.topic, "clouds come faster than they are fused");
      to_fuse_.erase(to_fuse_.begin());
    }
    to_fuse_.push_back(std::move(cloud));
  }
  BeginWork();
}

void SurfaceService::OnRequest(const thalweg_msgs::msg::MapRequest& message) {
  const Result<Time> stamp = dds::FromIdl(message.header(), dds::kMapFrame);
  if (!stamp) return bus_.health().Reject<topics::SurfaceRequests>(stamp.error());
  full_copy_wanted_ = true;
  BeginWork();
}

void SurfaceService::OnCommand(const thalweg_msgs::msg::OperatorCommand& message) {
  if (message.kind() != thalweg_msgs::msg::COMMAND_SAVE_MAP) return;
  if (!commands_.Begin(dds::IdOf(message))) return;  // sent again, since the mapper has yet to answer
  save_due_ = true;
  BeginWork();
}

void SurfaceService::BeginWork() {
  if (working_) return;
  const double period_ms = Seconds(options_.full_copy_period) * 1e3;
  const bool copies =
      full_copy_wanted_ && !(since_full_copy_ && since_full_copy_->Milliseconds() < period_ms);
  const bool stores = store_due_ && !disk_.busy();
  const bool saves = save_due_ && !disk_.busy() && !stores;
  if (to_fuse_.empty() && !publish_due_ && !copies && !stores && !saves) return;
  auto task = std::make_shared<const Task>(Task{.clouds = std::exchange(to_fuse_, {}),
                                                .publish = std::exchange(publish_due_, false),
                                                .full_copy = copies,
                                                .store = stores,
                                                .save_mesh = saves});
  if (copies) full_copy_wanted_ = false;
  if (stores) store_due_ = false;
  if (saves) save_due_ = false;
  working_ = true;
  worker_.Run([this, task] {
    Outcome outcome;
    try {
      outcome = Do(*task);
    } catch (const std::exception& error) {
      outcome.error = error.what();
    }
    bus_.Post([this, outcome] {
      worker_.Wait();  // which is about to end
      working_ = false;
      Finish(outcome);
      BeginWork();
    });
  });
}

SurfaceService::Outcome SurfaceService::Do(const Task& task) {
  Outcome outcome;
  Stopwatch stopwatch;
  const auto lap = [&stopwatch] { return std::exchange(stopwatch, Stopwatch()).Milliseconds(); };
  for (const PlacedCloud& cloud : task.clouds) {
    if (resumed_) {
      outcome.error = ComparePlace(cloud);
      if (outcome.error) return outcome;
    }
    live_.Fuse(cloud.stamped.cloud, cloud.camera, cloud.T_WB * options_.T_BC);
    fused_stamp_ = cloud.stamped.stamp;
    ++fused_;
    outcome.fusions.push_back(lap());
  }
  if (task.publish && fused_ != fused_stated_) {
    if (PublishChanges()) outcome.mesh = lap();
    PublishStatus();
    rifts_due_ = true;
  }
  if (task.publish && rifts_due_ && since_rifts_.Milliseconds() >= kRiftPause * rifts_took_) {
    lap();
    PublishRifts();
    outcome.rifts = rifts_took_ = lap();
    since_rifts_ = Stopwatch();
  }
  if (task.publish) PublishRiftMarkers();
  if (task.full_copy) {
    PublishFullCopy();
    outcome.full_copy = lap();
  }
  // Until it is known that they are of the same place, clouds are not stored.
  outcome.store_withheld = task.store && resumed_;
  if (task.store && !resumed_) to_store_ = live_.TakeChanged();
  if (task.save_mesh) {
    live_.UpdateMesh();
    to_save_ = std::make_shared<const SurfaceMesh>(live_.mesh());
  }
  outcome.full = live_.surface().full();
  return outcome;
}

std::optional<std::string> SurfaceService::ComparePlace(const PlacedCloud& cloud) {
  // Farther away, the errors of sensor and pose are too large.
  constexpr double kFarthest = 4.0;  // [m]
  const MapAgreement agreement = resumed_->Compare(cloud.stamped.cloud, cloud.T_WB * options_.T_BC,
                                                   std::min(kFarthest, options_.surface.max_range));
  const PlaceJudge::Verdict verdict = place_judge_.Judge(agreement, cloud.T_WB * options_.T_BC);
  if (verdict == PlaceJudge::Verdict::kUndecided) return std::nullopt;
  const std::string file = (options_.out / kCheckpointFile).string();
  const MapAgreement& sum = place_judge_.sum();
  if (verdict == PlaceJudge::Verdict::kOther) return AnotherPlaceText(sum, file);
  if (sum.IsTelling()) spdlog::info("{} agrees with {} of {} rays", file, sum.agreeing, sum.known());
  resumed_.reset();
  return std::nullopt;
}

void SurfaceService::Finish(const Outcome& outcome) {
  if (outcome.error) throw std::runtime_error(*outcome.error);
  scans_ += outcome.fusions.size();
  for (const double milliseconds : outcome.fusions) bus_.health().Timed("fusion", milliseconds);
  if (outcome.mesh) bus_.health().Timed("mesh", *outcome.mesh);
  if (outcome.rifts) bus_.health().Timed("rifts", *outcome.rifts);
  if (outcome.full_copy) {
    bus_.health().Timed("full copy", *outcome.full_copy);
    since_full_copy_ = Stopwatch();
  }
  if (outcome.full && !std::exchange(was_full_, true)) {
    spdlog::warn("the surface takes surface.most_memory_mb: nothing new is added to it");
  }
  store_withheld_ = store_withheld_ || outcome.store_withheld;
  if (store_withheld_ && !resumed_) {
    store_due_ = true;
    store_withheld_ = false;
  }
  if (to_store_) Store();
  if (to_save_) SaveMesh();
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

/// Only the first update of a full copy says that it is one. The others follow as changes, which those who
/// have the mesh apply in vain.
void SurfaceService::Send(bool full, std::span<const VoxelIndex> blocks) {
  if (!full) ++number_;
  if (updates_out_.readers() == 0) return;
  const auto& meshes = live_.mesh().blocks();
  thalweg_msgs::msg::SurfaceUpdate update = NewUpdate(full);
  std::size_t bytes = 0;
  for (const VoxelIndex& block : blocks) {
    const auto found = meshes.find(block);
    auto message = ToIdl(block, found == meshes.end() ? nullptr : &found->second, options_.surface.limits);
    if (bytes > 0 && bytes + BytesOf(message) > options_.most_update_bytes) {
      updates_out_.Write(update);
      ++number_;
      update = NewUpdate(false);
      bytes = 0;
    }
    bytes += BytesOf(message);
    update.blocks().push_back(std::move(message));
  }
  updates_out_.Write(update);
}

bool SurfaceService::PublishChanges() {
  const std::vector<VoxelIndex> updated = live_.TakeUpdated();
  if (updated.empty()) return false;
  Send(false, updated);
  return true;
}

void SurfaceService::PublishFullCopy() {
  std::vector<VoxelIndex> blocks;
  blocks.reserve(live_.mesh().blocks().size());
  for (const auto& [block, mesh] : live_.mesh().blocks()) blocks.push_back(block);
  Send(true, blocks);
}

void SurfaceService::PublishStatus() {
  thalweg_msgs::msg::SurfaceStatus status;
  status.header() = NewUpdate(false).header();
  status.scans(fused_);
  const SurfaceArea& area = live_.mesh().area();
  status.area_m2(area.seen);
  status.inspected_m2(area.inspected);
  status.fine_m2(area.fine);
  const InspectionLimits& limits = options_.surface.limits;
  // As the scenario states them, without what single precision adds.
  const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6; };
  status.inspection_distance_m(rounded(static_cast<double>(limits.distance)));
  status.inspection_angle_deg(rounded(DegreesOf(limits.cosine)));
  status.sampling_m(rounded(static_cast<double>(limits.sampling)));
  status.bytes(live_.surface().volume().bytes());
  status.full(live_.surface().full());
  status_out_.Write(status);
  fused_stated_ = fused_;
}

void SurfaceService::PublishRifts() {
  rifts_due_ = false;
  thalweg_msgs::msg::SurfaceRifts rifts = ToIdl(live_.FindRifts());
  rifts.session(session_);
  if (rifts == rifts_stated_) return;
  rifts_stated_ = rifts;
  rifts.header() = NewUpdate(false).header();
  rifts_out_.Write(rifts);
  markers_due_ = true;
}

/// Also for somebody who begins to listen while nothing changes.
void SurfaceService::PublishRiftMarkers() {
  if (!markers_due_ || rift_markers_out_.readers() == 0) return;
  markers_due_ = false;
  rift_markers_out_.Write(MarkersOf(live_.rifts(), NewUpdate(false).header()));
}

void SurfaceService::Store() {
  auto changed = std::make_shared<const TruncatedVolume>(*std::exchange(to_store_, std::nullopt));
  if (changed->block_count() == 0 && !file_failed_) return;
  disk_.Run([this, changed] {
    const Stopwatch stopwatch;
    std::string error;
    try {
      file_.Put(*changed);
      WriteFile(options_.out / kCheckpointFile, file_.Bytes());
    } catch (const std::runtime_error& failure) {
      error = failure.what();
    }
    bus_.Post([this, error, took = stopwatch.Milliseconds()] {
      bus_.health().Timed("checkpoint, in background", took);
      if (error.empty()) {
        if (std::exchange(file_failed_, false)) spdlog::info("the checkpoint can be written again");
        return;
      }
      bus_.health().FileNotWritten(error);
      if (!std::exchange(file_failed_, true)) {
        spdlog::error("{}; what is on disk stays whole, the next attempt is in {} s", error,
                      Seconds(options_.checkpoint_period));
      }
    });
  });
}

void SurfaceService::SaveMesh() {
  disk_.Run([this, mesh = std::exchange(to_save_, nullptr)] {
    try {
      WriteFile(options_.out / kMeshFile, PlyOf(mesh->Joined()));
      spdlog::info("the mesh is saved in {}", options_.out.string());
    } catch (const std::runtime_error& failure) {
      bus_.Post([this, error = std::string(failure.what())] {
        bus_.health().FileNotWritten(error);
        spdlog::error("{}", error);
      });
    }
  });
}

void SurfaceService::Save() {
  worker_.Wait();
  disk_.Wait();
  Do({.clouds = std::exchange(to_fuse_, {}), .publish = true});
  PublishStatus();
  SeparateWrites writes;
  if (resumed_ && place_judge_.sum().IsOfAnotherPlace()) {
    spdlog::warn("{}; left as it is, and so is {}",
                 AnotherPlaceText(place_judge_.sum(), (options_.out / kCheckpointFile).string()), kMeshFile);
  } else {
    // The mesh first: of the checkpoint there is an earlier one.
    writes.Try([&] { WriteFile(options_.out / kMeshFile, PlyOf(live_.mesh().Joined())); });
    if (options_.checkpoint_period > Duration::zero()) {
      writes.Try([&] {
        if (to_store_) file_.Put(*to_store_);  // by a task that has outlived the spinning of the bus
        file_.Put(live_.TakeChanged());
        WriteFile(options_.out / kCheckpointFile, file_.Bytes());
      });
    }
  }
  const SurfaceArea& area = live_.mesh().area();
  spdlog::info(
      "surface: {:.1f} m2 seen, {:.1f} m2 of it inspected, {:.1f} m2 sampled at {} m, {} rifts, {} blocks",
      area.seen, area.inspected, area.fine, options_.surface.limits.sampling, live_.rifts().open().size(),
      live_.surface().volume().block_count());
  writes.ThrowErrors();
}

}  // namespace thalweg::surface
