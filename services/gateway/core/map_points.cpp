#include "services/gateway/core/map_points.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "common/geometry/height_color.h"
#include "services/gateway/core/cdr_writer.h"

namespace thalweg::gateway {
namespace {

constexpr std::uint32_t kPointBytes = 16;

struct Point {
  float x, y, z;
};

std::vector<Point> OccupiedCenters(const BlockFeed& map) {
  std::vector<Point> points;
  const double size = map.voxel_size();
  constexpr int kEdge = OccupancyGrid::kBlockEdge;
  map.ForEachBlock([&](const VoxelIndex& block, const BlockFeed::Octets& octets) {
    for (int k = 0; k < OccupancyGrid::kBlockVoxels; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if ((octets[at / 4] >> (2 * (at % 4)) & 3) != 2) continue;
      const auto center = [&](int of_block, int within) {
        return static_cast<float>((of_block * kEdge + within + 0.5) * size);
      };
      points.push_back({center(block.x, k % kEdge), center(block.y, k / kEdge % kEdge),
                        center(block.z, k / (kEdge * kEdge))});
    }
  });
  return points;
}

/// As rviz packs it: B, G, R.
std::uint32_t ColorOf(float share) {
  const Rgb color = HeightColor(share);
  return std::uint32_t{color.r} << 16U | std::uint32_t{color.g} << 8U | color.b;
}

std::vector<float> Packed(const std::vector<Point>& points) {
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  for (const Point& point : points) {
    low = std::min(low, point.z);
    high = std::max(high, point.z);
  }
  const float span = std::max(high - low, 1e-3F);
  std::vector<float> packed;
  packed.reserve(points.size() * kPointBytes / sizeof(float));
  for (const Point& point : points) {
    const float color = std::bit_cast<float>(ColorOf((point.z - low) / span));
    packed.insert(packed.end(), {point.x, point.y, point.z, color});
  }
  return packed;
}

void PutText(CdrWriter& cdr, std::string_view text) {
  std::vector<std::uint8_t> characters(text.begin(), text.end());
  characters.push_back(0);
  cdr.PutSequence(characters);
}

}  // namespace

std::vector<std::uint8_t> MapPoints(const BlockFeed& map, std::string_view frame) {
  const std::vector<Point> points = OccupiedCenters(map);
  const auto count = static_cast<std::uint32_t>(points.size());
  CdrWriter cdr;
  const auto since_epoch = map.stamp().time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
  cdr.Put(static_cast<std::int32_t>(seconds.count()));
  cdr.Put(static_cast<std::uint32_t>((since_epoch - seconds).count()));
  PutText(cdr, frame);
  cdr.Put(std::uint32_t{1});  // height
  cdr.Put(count);             // width
  constexpr std::array<std::string_view, 4> kFields = {"x", "y", "z", "rgb"};
  cdr.Put(static_cast<std::uint32_t>(kFields.size()));
  for (std::size_t k = 0; k < kFields.size(); ++k) {
    PutText(cdr, kFields[k]);
    cdr.Put(static_cast<std::uint32_t>(k * sizeof(float)));
    cdr.Put(std::uint8_t{7});   // FLOAT32
    cdr.Put(std::uint32_t{1});  // values of it in a point
  }
  cdr.Put(std::uint8_t{0});  // is_bigendian
  cdr.Put(kPointBytes);
  cdr.Put(count * kPointBytes);  // row_step
  const std::vector<float> packed = Packed(points);
  std::vector<std::uint8_t> data(packed.size() * sizeof(float));
  const auto* const first = reinterpret_cast<const std::uint8_t*>(packed.data());
  std::copy(first, first + data.size(), data.begin());
  cdr.PutSequence(data);
  cdr.Put(std::uint8_t{1});  // is_dense
  return cdr.Take();
}

void MapPointsFeed::Refresh(const BlockFeed& map, Duration now) {
  constexpr Duration kPeriod = std::chrono::seconds(1);
  if (map.version() == version_ || (version_ != 0 && now < made_ + kPeriod)) return;
  version_ = map.version();
  made_ = now;
  message_ = {map.stamp(), std::make_shared<const std::vector<std::uint8_t>>(MapPoints(map, frame_))};
}

std::optional<Feed::Message> MapPointsFeed::Next(std::uint64_t& cursor) const {
  if (cursor == version_) return std::nullopt;
  cursor = version_;
  return message_;
}

}  // namespace thalweg::gateway
