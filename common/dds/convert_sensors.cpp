#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "common/base/check.h"
#include "common/base/size_text.h"
#include "common/base/text.h"
#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr float kFarthestReturn = 1e6F;   // [m]
constexpr std::uint32_t kWidest = 65536;  // [px]
constexpr std::uint64_t kLongestRow = 1U << 30U;
constexpr std::uint8_t kUint32 = 6;  // as defined by sensor_msgs/PointField
constexpr std::uint8_t kFloat32 = 7;

std::string Text(std::uint64_t value) {
  return std::to_string(value);
}

sensor_msgs::msg::PointField FieldToIdl(const char* name, std::uint32_t offset) {
  sensor_msgs::msg::PointField field;
  field.name(name);
  field.offset(offset);
  field.datatype(kFloat32);
  field.count(1);
  return field;
}

/// Checks the size fields of an image or an organized cloud against the actual number of bytes.
std::optional<Error> CheckSizes(std::uint32_t width, std::uint32_t height, std::uint64_t element_bytes,
                                std::uint64_t row_bytes, std::uint64_t bytes) {
  if (width == 0 || height == 0 || width > kWidest || height > kWidest) {
    return Error{"size is " + SizeText(width, height) + ", must be 1 to 65536"};
  }
  if (row_bytes > kLongestRow) return Error{"row of " + Text(row_bytes) + " bytes is too long"};
  if (row_bytes < width * element_bytes) {
    return Error{"row of " + Text(row_bytes) + " bytes is too short for " + Text(width) + " x " +
                 Text(element_bytes) + " bytes"};
  }
  if (bytes != row_bytes * height) {
    return Error{"data has " + Text(bytes) + " bytes, must be " + Text(height) + " rows x " +
                 Text(row_bytes)};
  }
  return std::nullopt;
}

/// Offsets of x, y, z and rgb within a point.
struct PointLayout {
  std::array<std::uint32_t, 3> xyz;
  std::optional<std::uint32_t> rgb;
};

Result<PointLayout> LayoutOf(const sensor_msgs::msg::PointCloud2& cloud) {
  std::array<std::optional<std::uint32_t>, 4> offsets;
  for (const sensor_msgs::msg::PointField& field : cloud.fields()) {
    const std::string& name = field.name();
    const bool is_color = name == "rgb" || name == "rgba";
    if (!is_color && name != "x" && name != "y" && name != "z") continue;
    const std::size_t slot = is_color ? 3 : static_cast<std::size_t>(name[0] - 'x');
    if (offsets[slot]) return Error{"field " + name + " occurs twice"};
    if (field.datatype() != kFloat32 && !(is_color && field.datatype() == kUint32)) {
      return Error{"field " + name + " has datatype " + Text(field.datatype()) + ", must be 7 (float32)"};
    }
    if (field.count() != 1)
      return Error{"field " + name + " has count " + Text(field.count()) + ", must be 1"};
    if (std::uint64_t{field.offset()} + sizeof(float) > cloud.point_step()) {
      return Error{"field " + name + " at offset " + Text(field.offset()) + " is beyond point_step " +
                   Text(cloud.point_step())};
    }
    offsets[slot] = field.offset();
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!offsets[axis]) return Error{std::string("field ") + "xyz"[axis] + " is missing"};
  }
  return PointLayout{.xyz = {*offsets[0], *offsets[1], *offsets[2]}, .rgb = offsets[3]};
}

Eigen::Vector3f PointAt(const std::uint8_t* bytes, const PointLayout& layout, Infinity infinity) {
  Eigen::Vector3f point;
  for (int axis = 0; axis < 3; ++axis) {
    std::memcpy(&point[axis], bytes + layout.xyz[static_cast<std::size_t>(axis)], sizeof(float));
  }
  // & instead of &&: no branch per coordinate
  const bool measured = static_cast<int>(std::abs(point.x()) <= kFarthestReturn) &
                        static_cast<int>(std::abs(point.y()) <= kFarthestReturn) &
                        static_cast<int>(std::abs(point.z()) <= kFarthestReturn);
  if (measured) return point;
  if (infinity == Infinity::kNoReturn && IsNoReturn(point)) return NoReturn();
  return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
}

int ChannelsOf(std::string_view encoding) {
  if (encoding == "mono8" || encoding == "bayer_rggb8" || encoding == "bayer_bggr8" ||
      encoding == "bayer_gbrg8" || encoding == "bayer_grbg8") {
    return 1;
  }
  return encoding == "rgb8" || encoding == "bgr8" ? 3 : 0;
}

constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();

float DepthOfMillimeters(const std::uint8_t* pixel) {
  std::uint16_t millimeters = 0;
  std::memcpy(&millimeters, pixel, sizeof millimeters);
  return millimeters == 0 ? kNotMeasured : 1e-3F * static_cast<float>(millimeters);
}

float DepthOfMeters(const std::uint8_t* pixel, Infinity infinity) {
  float meters = 0.0F;
  std::memcpy(&meters, pixel, sizeof meters);
  const bool no_return = meters == std::numeric_limits<float>::infinity() && infinity == Infinity::kNoReturn;
  return no_return || (meters > 0.0F && meters <= kFarthestReturn) ? meters : kNotMeasured;
}

}  // namespace

sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const PointCloud& cloud) {
  const bool has_colors = !cloud.colors.empty();
  const std::size_t count = cloud.points_C.size();
  THALWEG_CHECK(static_cast<std::size_t>(cloud.width_px) * static_cast<std::size_t>(cloud.height_px) ==
                count);
  THALWEG_CHECK(!has_colors || cloud.colors.size() == count);

  sensor_msgs::msg::PointCloud2 message;
  message.header(MakeHeader(stamp, kCameraFrame));
  message.width(static_cast<std::uint32_t>(cloud.width_px));
  message.height(static_cast<std::uint32_t>(cloud.height_px));
  message.fields({FieldToIdl("x", 0), FieldToIdl("y", 4), FieldToIdl("z", 8)});
  if (has_colors) message.fields().push_back(FieldToIdl("rgb", 12));
  message.is_bigendian(false);
  const std::size_t point_step = has_colors ? 16 : 12;
  message.point_step(static_cast<std::uint32_t>(point_step));
  message.row_step(static_cast<std::uint32_t>(point_step) * message.width());
  message.data().resize(count * point_step);
  std::uint8_t* to = message.data().data();
  bool is_dense = true;
  for (std::size_t k = 0; k < count; ++k, to += point_step) {
    const Eigen::Vector3f& point = cloud.points_C[k];
    is_dense = is_dense && point.allFinite();
    std::memcpy(to, point.data(), 12);
    if (has_colors) {
      const Rgb& color = cloud.colors[k];
      const std::array<std::uint8_t, 4> packed = {color.b, color.g, color.r, 0};
      std::memcpy(to + 12, packed.data(), packed.size());
    }
  }
  message.is_dense(is_dense);
  return message;
}

sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const std::vector<ValuedPoint>& points) {
  sensor_msgs::msg::PointCloud2 message;
  message.header(MakeHeader(stamp, kMapFrame));
  message.height(1);
  message.width(static_cast<std::uint32_t>(points.size()));
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "intensity"}) {
    message.fields().push_back(FieldToIdl(name, offset));
    offset += sizeof(float);
  }
  message.is_bigendian(false);
  message.is_dense(true);
  message.point_step(offset);
  message.row_step(message.width() * offset);
  message.data().resize(std::size_t{message.row_step()});
  std::uint8_t* out = message.data().data();
  for (const ValuedPoint& point : points) {
    const float values[4] = {point.p_W.x(), point.p_W.y(), point.p_W.z(), point.value};
    std::memcpy(out, values, sizeof values);
    out += sizeof values;
  }
  return message;
}

sensor_msgs::msg::PointCloud2 ToIdl(Time stamp, const std::vector<ColoredPoint>& points) {
  PointCloud cloud{.width_px = static_cast<int>(points.size()), .height_px = 1, .points_C = {}, .colors = {}};
  for (const ColoredPoint& point : points) {
    cloud.points_C.push_back(point.p_W);
    cloud.colors.push_back(point.color);
  }
  sensor_msgs::msg::PointCloud2 message = ToIdl(stamp, cloud);
  message.header().frame_id(kMapFrame);
  return message;
}

Result<StampedCloud> FromIdl(const sensor_msgs::msg::PointCloud2& cloud, Infinity infinity) {
  const Result<Time> stamp = FromIdl(cloud.header(), kCameraFrame);
  if (!stamp) return Error{stamp.error()};
  if (cloud.is_bigendian()) return Error{"is_bigendian is true, must be false"};
  if (const auto error = CheckSizes(cloud.width(), cloud.height(), cloud.point_step(), cloud.row_step(),
                                    cloud.data().size())) {
    return *error;
  }
  const Result<PointLayout> layout = LayoutOf(cloud);
  if (!layout) return Error{layout.error()};

  StampedCloud result{.stamp = *stamp, .cloud = {}};
  result.cloud.width_px = static_cast<int>(cloud.width());
  result.cloud.height_px = static_cast<int>(cloud.height());
  const std::size_t count = std::size_t{cloud.width()} * cloud.height();
  result.cloud.points_C.resize(count);
  if (layout->rgb) result.cloud.colors.resize(count);
  std::size_t k = 0;
  for (std::uint32_t row = 0; row < cloud.height(); ++row) {
    const std::uint8_t* from = cloud.data().data() + std::size_t{row} * cloud.row_step();
    for (std::uint32_t column = 0; column < cloud.width(); ++column, ++k, from += cloud.point_step()) {
      result.cloud.points_C[k] = PointAt(from, *layout, infinity);
      if (!layout->rgb) continue;
      const std::uint8_t* const packed = from + *layout->rgb;
      result.cloud.colors[k] = {.r = packed[2], .g = packed[1], .b = packed[0]};
    }
  }
  return result;
}

Result<StampedDepth> DepthFromIdl(const sensor_msgs::msg::Image& image, Infinity infinity) {
  const Result<Time> stamp = FromIdl(image.header(), kCameraFrame);
  if (!stamp) return Error{stamp.error()};
  const bool millimeters = image.encoding() == "16UC1";
  if (!millimeters && image.encoding() != "32FC1")
    return Error{"encoding is \"" + image.encoding() + "\", must be 16UC1 (millimeters) or 32FC1 (meters)"};
  if (image.is_bigendian() != 0) return Error{"is_bigendian is true, must be false"};
  const std::size_t pixel_bytes = millimeters ? sizeof(std::uint16_t) : sizeof(float);
  if (const auto error =
          CheckSizes(image.width(), image.height(), pixel_bytes, image.step(), image.data().size())) {
    return *error;
  }
  StampedDepth result{.stamp = *stamp,
                      .image = {.width_px = static_cast<int>(image.width()),
                                .height_px = static_cast<int>(image.height()),
                                .depths = {}}};
  result.image.depths.reserve(std::size_t{image.width()} * image.height());
  for (std::size_t v = 0; v < image.height(); ++v) {
    const std::uint8_t* pixel = image.data().data() + v * image.step();
    for (std::size_t u = 0; u < image.width(); ++u, pixel += pixel_bytes)
      result.image.depths.push_back(millimeters ? DepthOfMillimeters(pixel) : DepthOfMeters(pixel, infinity));
  }
  return result;
}

Result<ImageView> FromIdl(const sensor_msgs::msg::Image& image) {
  const Result<Time> stamp = FromIdl(image.header(), kCameraFrame);
  if (!stamp) return Error{stamp.error()};
  const int channels = ChannelsOf(image.encoding());
  if (channels == 0)
    return Error{"encoding is \"" + image.encoding() + "\", must be mono8, rgb8, bgr8, bayer_*8"};
  if (const auto error = CheckSizes(image.width(), image.height(), static_cast<std::uint64_t>(channels),
                                    image.step(), image.data().size())) {
    return *error;
  }
  return ImageView{.stamp = *stamp,
                   .width_px = static_cast<int>(image.width()),
                   .height_px = static_cast<int>(image.height()),
                   .step_bytes = static_cast<int>(image.step()),
                   .encoding = image.encoding(),
                   .data = image.data().data()};
}

sensor_msgs::msg::Image ToIdl(Time stamp, std::string_view frame, int width_px, int height_px,
                              std::string_view encoding, std::vector<std::uint8_t> bytes) {
  THALWEG_CHECK(height_px > 0 && bytes.size() == static_cast<std::size_t>(height_px) *
                                                     static_cast<std::size_t>(width_px) *
                                                     static_cast<std::size_t>(ChannelsOf(encoding)));
  sensor_msgs::msg::Image message;
  message.header(MakeHeader(stamp, frame));
  message.width(static_cast<std::uint32_t>(width_px));
  message.height(static_cast<std::uint32_t>(height_px));
  message.encoding(std::string(encoding));
  message.is_bigendian(0);
  message.step(static_cast<std::uint32_t>(width_px * ChannelsOf(encoding)));
  message.data(std::move(bytes));
  return message;
}

sensor_msgs::msg::CameraInfo ToIdl(Time stamp, const PinholeCamera& camera, double baseline) {
  sensor_msgs::msg::CameraInfo info;
  info.header(MakeHeader(stamp, kCameraFrame));
  info.width(static_cast<std::uint32_t>(camera.width_px));
  info.height(static_cast<std::uint32_t>(camera.height_px));
  info.distortion_model("plumb_bob");
  info.d({0.0, 0.0, 0.0, 0.0, 0.0});
  info.k({camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0});
  info.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  info.p({camera.fx, 0.0, camera.cx, -camera.fx * baseline,  //
          0.0, camera.fy, camera.cy, 0.0,                    //
          0.0, 0.0, 1.0, 0.0});
  return info;
}

Result<StampedCamera> FromIdl(const sensor_msgs::msg::CameraInfo& info) {
  const Result<Time> stamp = FromIdl(info.header(), kCameraFrame);
  if (!stamp) return Error{stamp.error()};
  if (const auto error = CheckSizes(info.width(), info.height(), 0, 0, 0)) return *error;
  const std::array<double, 12>& p = info.p();
  for (const double value : p) {
    if (!std::isfinite(value)) return Error{"p contains a non-finite value"};
  }
  if (p[0] <= 0.0 || p[5] <= 0.0) {
    return Error{"focal lengths are " + NumberText(p[0]) + " and " + NumberText(p[5]) + ", must be > 0"};
  }
  if (p[3] > 0.0) return Error{"baseline is " + NumberText(-p[3] / p[0]) + " m, must be >= 0"};
  return StampedCamera{.stamp = *stamp,
                       .camera = {.width_px = static_cast<int>(info.width()),
                                  .height_px = static_cast<int>(info.height()),
                                  .fx = p[0],
                                  .fy = p[5],
                                  .cx = p[2],
                                  .cy = p[6]},
                       .baseline = std::abs(p[3]) / p[0]};
}

}  // namespace thalweg::dds
