#include "services/link/adapter/map_bridge.h"

#include <utility>

#include "common/dds/convert.h"

namespace thalweg::link {

std::optional<std::string> MapSender::OnUpdate(const thalweg_msgs::msg::MapUpdate& update) {
  const auto applied = replica_.Apply(update);
  if (!applied) return applied.error();
  if (!*applied) return std::nullopt;
  if (const auto stamp = dds::FromIdl(update.header(), dds::kMapFrame)) stamp_ = *stamp;
  if ((*applied)->replaced || !feed_) {
    feed_.emplace(replica_.grid().voxel_size());
    feed_->Restart(stamp_, replica_.grid());
  } else {
    feed_->Note(stamp_, (*applied)->changes, (*applied)->scans);
  }
  return std::nullopt;
}

std::optional<thalweg_msgs::msg::MapRequest> MapSender::Request(Time now) const {
  if (!replica_.missing()) return std::nullopt;
  return replica_.MakeRequest(now, "link");
}

std::optional<Buffer> MapSender::Next(std::uint64_t session) {
  if (!feed_) return std::nullopt;
  if (std::exchange(session_, session) != session) feed_->Restart(stamp_, replica_.grid());
  const auto change = feed_->Next(replica_.grid());
  if (!change) return std::nullopt;
  return Encode(*change);
}

Result<thalweg_msgs::msg::MapUpdate> MapReceiver::OnChange(Bytes bytes) {
  const Result<MapChange> change = DecodeMapChange(bytes);
  if (!change) return Error{change.error()};
  if (change->reset || !grid_ || grid_->voxel_size() != change->voxel_size) {
    grid_.emplace(change->voxel_size);
    log_.emplace(dds::MapLog::MakeSession(), change->voxel_size);
  }
  // A message has few blocks, so that the limit is exceeded by few.
  if (grid_->block_count() > dds::MapReplica::kMostBlocks) {
    return Error{"the map has more than " + std::to_string(dds::MapReplica::kMostBlocks) + " blocks"};
  }
  for (const VoxelChange& voxel : change->voxels) grid_->Set(voxel.voxel, voxel.log_odds);
  for (const ScanView& scan : change->scans) log_->Add(change->stamp, scan, {});
  log_->Add(change->stamp, change->voxels);
  return log_->TakeUpdate();
}

std::optional<thalweg_msgs::msg::MapUpdate> MapReceiver::FullCopy() const {
  if (!log_) return std::nullopt;
  return log_->FullCopy(*grid_);
}

}  // namespace thalweg::link
