#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "services/gateway/core/block_feed.h"

namespace thalweg::gateway {

/// The map as tools draw it that know nothing of thalweg: the centers of the occupied voxels as
/// sensor_msgs/PointCloud2, colored by height (fields x, y, z, rgb).
class MapPointsFeed final : public Feed {
 public:
  /// @param frame  What the map's frame is called on the wire.
  explicit MapPointsFeed(std::string frame) : frame_(std::move(frame)) {}

  static constexpr std::string_view kTopic = "thalweg/map_points";

  /// Makes the cloud of the map as it is, unless it has not changed, or the last one is less than a second
  /// old.
  void Refresh(const BlockFeed& map, Duration now);
  std::optional<Message> Next(std::uint64_t& cursor) const override;

 private:
  std::string frame_;
  Message message_;
  std::uint64_t version_ = 0;  ///< The map's; 0 = none yet.
  Duration made_ = {};
};

/// The cloud's message in CDR.
std::vector<std::uint8_t> MapPoints(const BlockFeed& map, std::string_view frame);

}  // namespace thalweg::gateway
