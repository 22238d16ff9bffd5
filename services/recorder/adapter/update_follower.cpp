#include "services/recorder/adapter/update_follower.h"

#include <map>
#include <tuple>
#include <utility>

#include "common/dds/map_log.h"
#include "common/dds/map_replica.h"
#include "common/dds/topic_table.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;

/// What is the same for both topics: their updates have a session, a number and `full`.
template <class Topic>
class Follower : public UpdateFollower {
 public:
  using Update = dds::MessageOf<Topic>;

  void Follow(std::span<const std::uint8_t> sample, std::uint64_t token) final {
    std::optional<Update> update = dds::Decode<Topic>(sample);
    if (!update) return;
    update->session(RenamedSession(update->session(), token));
    std_msgs::msg::Header header = update->header();
    update->header().frame_id(dds::kMapFrame);  // whatever it is called on the wire
    if (Apply(*update)) header_ = std::move(header);
  }
  std::optional<Sample> FullCopy() const final {
    Update copy;
    if (!Fill(copy)) return std::nullopt;
    copy.header(header_);
    copy.full(true);
    return dds::Encode<Topic>(copy);
  }
  std::optional<Sample> Nothing(std::span<const std::uint8_t> like, std::uint64_t session) const final {
    const std::optional<Update> update = dds::Decode<Topic>(like);
    if (!update) return std::nullopt;
    Update nothing;
    nothing.header(update->header());
    nothing.session(session);
    nothing.full(true);
    nothing.voxel_size_m(update->voxel_size_m());
    return dds::Encode<Topic>(nothing);
  }
  Sample Renamed(std::span<const std::uint8_t> sample, std::uint64_t token) const final {
    std::optional<Update> update = dds::Decode<Topic>(sample);
    if (!update || token == 0) return {sample.begin(), sample.end()};
    update->session(RenamedSession(update->session(), token));
    return dds::Encode<Topic>(*update);
  }

 private:
  /// Returns whether the update was used.
  virtual bool Apply(const Update& update) = 0;
  /// Fills in session, number, voxel size and blocks; false if there is nothing yet.
  virtual bool Fill(Update& copy) const = 0;

  std_msgs::msg::Header header_;  ///< The last update's.
};

class MapFollower final : public Follower<topics::MapUpdates> {
  bool Apply(const Update& update) override {
    const auto applied = replica_.Apply(update);
    return applied && applied->has_value();
  }
  bool Fill(Update& copy) const override {
    if (!replica_.has_map()) return false;
    copy.session(replica_.session());
    copy.number(replica_.number());
    copy.voxel_size_m(replica_.grid().voxel_size());
    copy.blocks(dds::BlocksOf(replica_.grid()));
    return true;
  }

  dds::MapReplica replica_;
};

class SurfaceFollower final : public Follower<topics::SurfaceUpdates> {
  using Block = thalweg_msgs::msg::SurfaceBlock;

  bool Apply(const Update& update) override {
    if (update.blocks().size() > dds::MapReplica::kMostBlocks) return false;
    const bool next = session_ != 0 && update.session() == session_ && update.number() == number_ + 1;
    if (!update.full() && !next) return false;
    if (update.full()) blocks_.clear();
    session_ = update.session();
    number_ = update.number();
    voxel_size_ = update.voxel_size_m();
    for (const Block& block : update.blocks()) {
      const auto place = std::tuple(block.x(), block.y(), block.z());
      if (block.points_m().empty()) {
        blocks_.erase(place);
      } else if (blocks_.contains(place) || blocks_.size() < dds::MapReplica::kMostBlocks) {
        blocks_[place] = block;
      }
    }
    return true;
  }
  bool Fill(Update& copy) const override {
    if (session_ == 0) return false;
    copy.session(session_);
    copy.number(number_);
    copy.voxel_size_m(voxel_size_);
    for (const auto& [place, block] : blocks_) copy.blocks().push_back(block);
    return true;
  }

  std::uint64_t session_ = 0;
  std::uint64_t number_ = 0;
  double voxel_size_ = 0.0;
  std::map<std::tuple<std::int32_t, std::int32_t, std::int32_t>, Block> blocks_;
};

}  // namespace

std::unique_ptr<UpdateFollower> MakeUpdateFollower(std::string_view topic) {
  if (topic == topics::MapUpdates::kName) return std::make_unique<MapFollower>();
  if (topic == topics::SurfaceUpdates::kName) return std::make_unique<SurfaceFollower>();
  return nullptr;
}

}  // namespace thalweg::recorder
