#include "services/link/core/ray_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "common/base/check.h"
#include "common/base/hash.h"
#include "common/base/size_text.h"

namespace thalweg::link {
namespace {

enum RayTableKind : std::uint8_t { kPinhole = 0, kEachPixel = 1 };

constexpr std::uint64_t kWidest = 1U << 16U;  // [px]

std::size_t CountOf(int width_px, int height_px) {
  return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
}

/// A straight line through y(k) for k = 0, 1, ..., by least squares.
class Line {
 public:
  void Add(double k, double y) {
    count_ += 1.0;
    k_ += k;
    y_ += y;
    kk_ += k * k;
    ky_ += k * y;
  }
  /// y(0) and the slope; nothing for points of a single k.
  std::optional<std::pair<double, double>> Fit() const {
    const double spread = count_ * kk_ - k_ * k_;
    if (!(spread > 0.5)) return std::nullopt;  // of whole numbers
    const double slope = (count_ * ky_ - k_ * y_) / spread;
    return std::pair{(y_ - slope * k_) / count_, slope};
  }

 private:
  double count_ = 0.0, k_ = 0.0, y_ = 0.0, kk_ = 0.0, ky_ = 0.0;
};

std::optional<RayTable::Pinhole> FitPinhole(const PointCloud& cloud) {
  Line columns;
  Line rows;
  std::size_t pixel = 0;
  for (int v = 0; v < cloud.height_px; ++v) {
    for (int u = 0; u < cloud.width_px; ++u, ++pixel) {
      const Eigen::Vector3f& p_C = cloud.points_C[pixel];
      if (!p_C.allFinite()) continue;
      columns.Add(u, double{p_C.x()} / double{p_C.z()});
      rows.Add(v, double{p_C.y()} / double{p_C.z()});
    }
  }
  const auto column = columns.Fit();
  const auto row = rows.Fit();
  if (!column || !row) return std::nullopt;
  return RayTable::Pinhole{column->first, column->second, row->first, row->second};
}

}  // namespace

RayTable::RayTable(int width_px, int height_px, const Pinhole& pinhole)
    : width_px_(width_px), height_px_(height_px), pinhole_(pinhole) {
  const Buffer bytes = Encode();
  hash_ = HashOf({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) | 1U;
}

RayTable::RayTable(int width_px, int height_px, std::vector<Eigen::Vector2f> xy)
    : width_px_(width_px), height_px_(height_px), xy_(std::move(xy)) {
  THALWEG_CHECK(xy_.size() == CountOf(width_px, height_px));
  const Buffer bytes = Encode();
  hash_ = HashOf({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) | 1U;
}

std::optional<RayTable> RayTable::Of(const PointCloud& cloud, double tolerance, const RayTable* before) {
  const auto is_behind = [](const Eigen::Vector3f& p_C) { return p_C.allFinite() && !(p_C.z() > 0.0F); };
  if (std::ranges::any_of(cloud.points_C, is_behind)) return std::nullopt;
  if (const auto pinhole = FitPinhole(cloud)) {
    RayTable table(cloud.width_px, cloud.height_px, *pinhole);
    if (table.Fits(cloud, tolerance)) return table;
  }
  const bool same_size =
      before != nullptr && before->width_px_ == cloud.width_px && before->height_px_ == cloud.height_px;
  std::vector<Eigen::Vector2f> xy(cloud.points_C.size(),
                                  Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (std::size_t k = 0; k < xy.size(); ++k) {
    const Eigen::Vector3f& p_C = cloud.points_C[k];
    if (p_C.allFinite()) {
      xy[k] = p_C.head<2>() / p_C.z();
    } else if (same_size && !before->pinhole_) {
      xy[k] = before->At(k);
    }
  }
  return RayTable(cloud.width_px, cloud.height_px, std::move(xy));
}

Eigen::Vector2f RayTable::At(std::size_t pixel) const {
  if (!pinhole_) return xy_[pixel];
  const auto width = static_cast<std::size_t>(width_px_);
  const auto u = static_cast<double>(pixel % width);
  const auto v = static_cast<double>(pixel / width);
  return Eigen::Vector2d(pinhole_->x0 + u * pinhole_->dx, pinhole_->y0 + v * pinhole_->dy).cast<float>();
}

bool RayTable::Fits(const PointCloud& cloud, double tolerance) const {
  if (cloud.width_px != width_px_ || cloud.height_px != height_px_) return false;
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    const Eigen::Vector3f& p_C = cloud.points_C[k];
    if (!p_C.allFinite()) continue;
    if (!(p_C.z() > 0.0F)) return false;
    const Eigen::Vector2f off = At(k) * p_C.z() - p_C.head<2>();
    // The points themselves are rounded to 24 bits.
    const double rounding = 1e-6 * double{p_C.cwiseAbs().maxCoeff()};
    if (!(double{off.cwiseAbs().maxCoeff()} <= tolerance + rounding)) return false;
  }
  return true;
}

Buffer RayTable::Encode() const {
  ByteWriter out;
  out.U8(pinhole_ ? kPinhole : kEachPixel);
  out.Varint(static_cast<std::uint64_t>(width_px_));
  out.Varint(static_cast<std::uint64_t>(height_px_));
  if (pinhole_) {
    for (const double value : {pinhole_->x0, pinhole_->dx, pinhole_->y0, pinhole_->dy}) {
      out.U64(std::bit_cast<std::uint64_t>(value));
    }
    return out.Take();
  }
  ByteWriter values;
  for (const int axis : {0, 1}) {
    std::uint32_t last = 0;  // neighbors agree in sign, exponent and the first bits of the rest
    for (const Eigen::Vector2f& xy : xy_) {
      const auto value = std::bit_cast<std::uint32_t>(xy[axis]);
      values.U32(value ^ last);
      last = value;
    }
  }
  out.Append(Pack(values.bytes()));
  return out.Take();
}

Result<RayTable> RayTable::Decode(Bytes bytes) {
  ByteReader in(bytes);
  const std::uint8_t kind = in.U8();
  const std::uint64_t width = in.Varint();
  const std::uint64_t height = in.Varint();
  if (!in.good() || width == 0 || height == 0 || width > kWidest || height > kWidest ||
      width * height > kMostPoints) {
    return Error{"a ray table of " + SizeText(width, height) + " pixels"};
  }
  const int width_px = static_cast<int>(width);
  const int height_px = static_cast<int>(height);
  if (kind == kPinhole) {
    std::array<double, 4> values{};
    for (double& value : values) value = std::bit_cast<double>(in.U64());
    const auto is_sound = [](double value) { return std::abs(value) < 1e3; };
    if (!in.good() || !in.rest().empty() || !std::ranges::all_of(values, is_sound)) {
      return Error{"a ray table whose pinhole camera is none"};
    }
    return RayTable(width_px, height_px, Pinhole{values[0], values[1], values[2], values[3]});
  }
  if (kind != kEachPixel) return Error{"a ray table of kind " + std::to_string(kind)};
  const std::size_t count = CountOf(width_px, height_px);
  const Result<Buffer> unpacked = Unpack(in.rest(), {}, 8 * count);
  if (!unpacked) return Error{"ray table: " + unpacked.error()};
  if (unpacked->size() != 8 * count) return Error{"a ray table of the wrong length"};
  ByteReader values(*unpacked);
  std::vector<Eigen::Vector2f> xy(count);
  for (const int axis : {0, 1}) {
    std::uint32_t last = 0;
    for (Eigen::Vector2f& direction : xy) {
      last ^= values.U32();
      direction[axis] = std::bit_cast<float>(last);
    }
  }
  return RayTable(width_px, height_px, std::move(xy));
}

}  // namespace thalweg::link
