#include "services/link/core/cloud_codec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "common/base/check.h"
#include "common/base/zig_zag.h"

namespace thalweg::link {
namespace {

enum CloudKind : std::uint8_t { kOrganized = 0, kPoints = 1 };
constexpr std::uint8_t kHasColors = 0x80;

// A pixel is a byte: the difference from its prediction, as 0, -1, 1, -2, 2, ..., or one of these.
constexpr std::uint8_t kFar = 253;  // the depth follows behind all pixels
constexpr std::uint8_t kNothingReturned = 254;
constexpr std::uint8_t kNotMeasured = 255;
constexpr std::int64_t kMostDifference = 126;

constexpr std::int64_t kMostPredicted = (1 << 17) - 1;  // products of three stay below 2^51
constexpr double kMostSteps = 2e9;

/// Depths in steps; 0 where there is none.
class DepthImage {
 public:
  DepthImage(int width_px, int height_px)
      : width_(static_cast<std::size_t>(width_px)),
        depths_(width_ * static_cast<std::size_t>(height_px), 0) {}
  void Set(std::size_t pixel, std::int64_t depth) { depths_[pixel] = depth; }

  /// The expected depth of a pixel, from those before it in order.
  std::int64_t Predict(std::size_t pixel) {
    const bool has_left = pixel % width_ != 0;
    const bool has_above = pixel >= width_;
    const std::int64_t left = has_left ? depths_[pixel - 1] : 0;
    const std::int64_t above = has_above ? depths_[pixel - width_] : 0;
    const std::int64_t corner = has_left && has_above ? depths_[pixel - width_ - 1] : 0;
    if (left != 0 && above != 0 && corner != 0) {
      if (const auto plane = OnPlane(left, above, corner)) return *plane;
    }
    if (left != 0) return left;
    if (above != 0) return above;
    if (corner != 0) return corner;
    return last_;
  }
  void SetLast(std::int64_t depth) { last_ = depth; }

 private:
  static std::optional<std::int64_t> OnPlane(std::int64_t left, std::int64_t above, std::int64_t corner) {
    if (std::max({left, above, corner}) > kMostPredicted) return std::nullopt;
    const std::int64_t over = left * above * corner;
    const std::int64_t under = above * corner + left * corner - left * above;
    if (under <= 0) return std::nullopt;
    const std::int64_t depth = (2 * over + under) / (2 * under);
    const auto [least, most] = std::minmax({left, above, corner});
    if (depth < least / 2 || depth > 2 * most) return std::nullopt;
    return depth;
  }

  std::size_t width_;
  std::vector<std::int64_t> depths_;
  std::int64_t last_ = 1;
};

void PutStep(ByteWriter& out, double step) {
  out.U64(std::bit_cast<std::uint64_t>(step));
}

/// NaN if the bytes hold no sound step.
double TakeStep(ByteReader& in) {
  const auto step = std::bit_cast<double>(in.U64());
  return step >= 1e-6 && step <= 1e3 ? step : std::numeric_limits<double>::quiet_NaN();
}

/// Appends colors as differences, a channel at a time; `wanted` says which pixels have one.
template <class Wanted>
void PutColors(ByteWriter& out, const std::vector<Rgb>& colors, Wanted&& wanted) {
  for (const auto channel : {&Rgb::r, &Rgb::g, &Rgb::b}) {
    std::uint8_t last = 0;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      if (!wanted(k)) continue;
      out.U8(static_cast<std::uint8_t>(colors[k].*channel - last));
      last = colors[k].*channel;
    }
  }
}

template <class Wanted>
void TakeColors(ByteReader& in, std::vector<Rgb>& colors, Wanted&& wanted) {
  for (const auto channel : {&Rgb::r, &Rgb::g, &Rgb::b}) {
    std::uint8_t last = 0;
    for (std::size_t k = 0; k < colors.size(); ++k) {
      if (!wanted(k)) continue;
      last = static_cast<std::uint8_t>(last + in.U8());
      colors[k].*channel = last;
    }
  }
}

Buffer EncodeImage(const PointCloud& cloud, const RayTable& table, double step, bool colors) {
  const std::size_t count = cloud.points_C.size();
  ByteWriter pixels;
  ByteWriter far;
  DepthImage image(cloud.width_px, cloud.height_px);
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3f& p_C = cloud.points_C[k];
    if (IsNoReturn(p_C)) {
      pixels.U8(kNothingReturned);
      continue;
    }
    if (!p_C.allFinite() || double{p_C.z()} / step > kMostSteps) {
      pixels.U8(kNotMeasured);
      continue;
    }
    const std::int64_t depth = std::max<std::int64_t>(1, std::llround(double{p_C.z()} / step));
    const std::int64_t difference = depth - image.Predict(k);
    if (std::abs(difference) <= kMostDifference) {
      pixels.U8(static_cast<std::uint8_t>(ZigZag(difference)));
    } else {
      pixels.U8(kFar);
      far.U32(static_cast<std::uint32_t>(depth));
    }
    image.Set(k, depth);
    image.SetLast(depth);
  }
  ByteWriter out;
  out.U8(static_cast<std::uint8_t>(kOrganized | (colors ? kHasColors : 0)));
  PutStep(out, step);
  out.U64(table.hash());
  pixels.Append(far.bytes());
  if (colors) PutColors(pixels, cloud.colors, [&](std::size_t k) { return cloud.points_C[k].allFinite(); });
  out.Append(Pack(pixels.bytes()));
  return out.Take();
}

Result<PointCloud> DecodeImage(ByteReader in, const std::optional<RayTable>& table, bool colors) {
  const double step = TakeStep(in);
  const std::uint64_t hash = in.U64();
  if (!in.good() || std::isnan(step)) return Error{"a cloud with a step that is none"};
  if (!table || table->hash() != hash) return Error{"a cloud whose ray table has not arrived"};
  PointCloud cloud;
  cloud.width_px = table->width_px();
  cloud.height_px = table->height_px();
  const std::size_t count =
      static_cast<std::size_t>(cloud.width_px) * static_cast<std::size_t>(cloud.height_px);
  const Result<Buffer> unpacked = Unpack(in.rest(), {}, count * 8);
  if (!unpacked) return Error{"cloud: " + unpacked.error()};
  if (unpacked->size() < count) return Error{"a cloud with fewer pixels than its ray table"};
  const Bytes pixels = Bytes(*unpacked).first(count);
  ByteReader rest(Bytes(*unpacked).subspan(count));
  cloud.points_C.assign(count, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  DepthImage image(cloud.width_px, cloud.height_px);
  for (std::size_t k = 0; k < count; ++k) {
    if (pixels[k] == kNotMeasured) continue;
    if (pixels[k] == kNothingReturned) {
      cloud.points_C[k] = NoReturn();
      continue;
    }
    const std::int64_t depth =
        pixels[k] == kFar ? std::int64_t{rest.U32()} : image.Predict(k) + FromZigZag(pixels[k]);
    if (depth < 1) return Error{"a cloud with a depth of " + std::to_string(depth) + " steps"};
    image.Set(k, depth);
    image.SetLast(depth);
    const auto z = static_cast<float>(static_cast<double>(depth) * step);
    const Eigen::Vector2f xy = table->At(k) * z;
    cloud.points_C[k] = {xy.x(), xy.y(), z};
  }
  if (colors) {
    cloud.colors.resize(count);
    TakeColors(rest, cloud.colors, [&](std::size_t k) { return cloud.points_C[k].allFinite(); });
  }
  if (!rest.good() || !rest.rest().empty()) return Error{"a cloud of the wrong length"};
  return cloud;
}

/// A point in steps.
struct StepPoint {
  std::array<std::int64_t, 3> at;
  Rgb color;
};

Buffer EncodePoints(const PointCloud& cloud, double step, bool colors) {
  std::vector<StepPoint> points;
  for (std::size_t k = 0; k < cloud.points_C.size(); ++k) {
    const Eigen::Vector3f& p_C = cloud.points_C[k];
    if (!p_C.allFinite() || double{p_C.cwiseAbs().maxCoeff()} / step > kMostSteps) continue;
    StepPoint& point = points.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      point.at[static_cast<std::size_t>(axis)] = std::llround(double{p_C[axis]} / step);
    }
    if (colors) point.color = cloud.colors[k];
  }
  std::ranges::stable_sort(points, {}, &StepPoint::at);
  const auto is_same = [](const StepPoint& a, const StepPoint& b) { return a.at == b.at; };
  points.erase(std::unique(points.begin(), points.end(), is_same), points.end());
  ByteWriter values;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int64_t last = 0;
    for (const StepPoint& point : points) {
      values.Varint(ZigZag(point.at[axis] - last));
      last = point.at[axis];
    }
  }
  if (colors) {
    std::vector<Rgb> its_colors;
    for (const StepPoint& point : points) its_colors.push_back(point.color);
    PutColors(values, its_colors, [](std::size_t) { return true; });
  }
  ByteWriter out;
  out.U8(static_cast<std::uint8_t>(kPoints | (colors ? kHasColors : 0)));
  PutStep(out, step);
  out.Varint(points.size());
  out.Append(Pack(values.bytes()));
  return out.Take();
}

Result<PointCloud> DecodePoints(ByteReader in, bool colors) {
  const double step = TakeStep(in);
  const std::uint64_t count = in.Varint();
  if (!in.good() || std::isnan(step)) return Error{"a cloud with a step that is none"};
  if (count > kMostPoints) return Error{"a cloud of " + std::to_string(count) + " points"};
  const Result<Buffer> unpacked = Unpack(in.rest(), {}, count * 24);
  if (!unpacked) return Error{"cloud: " + unpacked.error()};
  // Each coordinate takes a byte at least.
  if (unpacked->size() < 3 * count) return Error{"a cloud of the wrong length"};
  ByteReader values(*unpacked);
  PointCloud cloud;
  cloud.width_px = static_cast<int>(std::max<std::uint64_t>(1, count));  // a cloud without points is invalid
  cloud.height_px = 1;
  cloud.points_C.assign(static_cast<std::size_t>(cloud.width_px),
                        Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (int axis = 0; axis < 3; ++axis) {
    std::uint64_t last = 0;  // unsigned, since a sum of what anybody sends may overflow
    for (std::uint64_t k = 0; k < count; ++k) {
      last += static_cast<std::uint64_t>(FromZigZag(values.Varint()));
      cloud.points_C[k][axis] =
          static_cast<float>(static_cast<double>(static_cast<std::int64_t>(last)) * step);
    }
  }
  if (colors) {
    cloud.colors.resize(cloud.points_C.size());
    TakeColors(values, cloud.colors, [&](std::size_t k) { return k < count; });
  }
  if (!values.good() || !values.rest().empty()) return Error{"a cloud of the wrong length"};
  return cloud;
}

}  // namespace

bool CloudEncoder::FindTable(const PointCloud& cloud) {
  const double tolerance = options_.depth_step / 4.0;
  if (cloud.height_px < 2) return false;
  if (table_ && table_->Fits(cloud, tolerance)) return true;
  auto table = RayTable::Of(cloud, tolerance, table_ ? &*table_ : nullptr);
  if (!table) return false;
  table_ = std::move(table);
  table_bytes_ = std::make_shared<const Buffer>(table_->Encode());
  return true;
}

CodedCloud CloudEncoder::Encode(const PointCloud& cloud) {
  THALWEG_CHECK(cloud.points_C.size() <= kMostPoints);
  const bool colors = options_.colors && !cloud.colors.empty();
  if (!FindTable(cloud)) return {nullptr, EncodePoints(cloud, options_.point_step, colors)};
  return {table_bytes_, EncodeImage(cloud, *table_, options_.depth_step, colors)};
}

std::optional<Error> CloudDecoder::SetTable(Bytes bytes) {
  Result<RayTable> table = RayTable::Decode(bytes);
  if (!table) return Error{table.error()};
  table_ = *std::move(table);
  return std::nullopt;
}

Result<PointCloud> CloudDecoder::Decode(Bytes bytes) const {
  ByteReader in(bytes);
  const std::uint8_t kind = in.U8();
  if (!in.good()) return Error{"an empty cloud"};
  const bool colors = (kind & kHasColors) != 0;
  switch (kind & ~kHasColors) {
    case kOrganized:
      return DecodeImage(in, table_, colors);
    case kPoints:
      return DecodePoints(in, colors);
    default:
      return Error{"a cloud of kind " + std::to_string(kind)};
  }
}

}  // namespace thalweg::link
