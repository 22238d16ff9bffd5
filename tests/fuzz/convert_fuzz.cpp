// libFuzzer target: for any bytes received as an image, camera_info or cloud, the conversions return a value
// or an error that names what is wrong, and access no memory beyond their own.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "common/dds/convert.h"
#include "services/stereo/adapter/convert.h"

namespace {

using namespace thalweg;

/// Takes fields from the front of the fuzzer's bytes; zeros once they are used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  template <class T>
  T Take() {
    T value{};
    const std::size_t count = size_ < sizeof(T) ? size_ : sizeof(T);
    std::memcpy(&value, data_, count);
    Skip(count);
    return value;
  }
  /// Mostly a small number, so that sizes sometimes agree with the data.
  std::uint32_t TakeSize() {
    const auto kind = Take<std::uint8_t>();
    return kind < 250 ? kind % 24U : Take<std::uint32_t>();
  }
  std::vector<std::uint8_t> TakeBytes(std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    const std::size_t there = size_ < count ? size_ : count;
    if (there > 0) std::memcpy(bytes.data(), data_, there);
    Skip(there);
    return bytes;
  }

 private:
  void Skip(std::size_t count) {
    data_ += count;
    size_ -= count;
  }
  const std::uint8_t* data_;
  std::size_t size_;
};

void Require(bool good) {
  if (!good) __builtin_trap();
}

std_msgs::msg::Header TakeHeader(Input& input) {
  std_msgs::msg::Header header = dds::MakeHeader(Time{}, dds::kCameraFrame);
  header.stamp().sec(input.Take<std::int32_t>());
  header.stamp().nanosec(input.Take<std::uint32_t>());
  if (input.Take<std::uint8_t>() == 0) header.frame_id("elsewhere");
  return header;
}

void FuzzImage(Input& input) {
  static const char* const kEncodings[] = {
      "mono8",       "rgb8",   "bgr8", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8",
      "bayer_grbg8", "mono16", "",     "bayer_"};
  sensor_msgs::msg::Image image;
  image.header(TakeHeader(input));
  image.encoding(kEncodings[input.Take<std::uint8_t>() % 10]);
  image.width(input.TakeSize());
  image.height(input.TakeSize());
  const bool honest = input.Take<std::uint8_t>() > 40;
  const std::uint64_t row = 3ULL * image.width();
  image.step(honest && row < 4096 ? static_cast<std::uint32_t>(row) : input.TakeSize());
  const std::uint64_t bytes = std::uint64_t{image.step()} * image.height();
  image.data(input.TakeBytes(honest && bytes < 65536 ? bytes : input.TakeSize() % 4096U));
  const auto view = dds::FromIdl(image);
  if (!view) return Require(!view.error().empty());
  const auto pixels = stereo::ToByteImage(*view);
  if (!pixels) return Require(!pixels.error().empty());
  Require(pixels->width() == static_cast<int>(image.width()));
  Require(pixels->data().size() ==
          std::size_t{image.width()} * image.height() * static_cast<std::size_t>(pixels->channels()));
}

sensor_msgs::msg::CameraInfo TakeInfo(Input& input) {
  sensor_msgs::msg::CameraInfo info = dds::ToIdl(Time{}, {32, 24, 40, 40, 15.5, 11.5}, 0.1);
  info.header(TakeHeader(input));
  info.width(input.TakeSize());
  for (int i = 0; i < 3; ++i) {
    info.p()[input.Take<std::uint8_t>() % 12] = input.Take<double>();
    info.k()[input.Take<std::uint8_t>() % 9] = input.Take<double>();
    info.r()[input.Take<std::uint8_t>() % 9] = input.Take<double>();
  }
  if (input.Take<std::uint8_t>() < 40) info.d().assign(input.Take<std::uint8_t>(), input.Take<double>());
  return info;
}

void FuzzInfo(Input& input) {
  const auto left = TakeInfo(input);
  const auto info = stereo::FromIdl(left, TakeInfo(input));
  if (!info) return Require(!info.error().empty());
  const StereoGeometry& geometry = info->geometry;
  Require(geometry.baseline > 0.0 && geometry.camera.fx > 0.0);
  constexpr int kSmall = 256;  // px: for larger images, computing the tables only takes time
  if (!info->rectifications || geometry.camera.width_px > kSmall || geometry.camera.height_px > kSmall)
    return;
  const auto& [from_left, from_right] = *info->rectifications;
  const StereoRectifier rectifier(from_left, from_right, geometry);
  Require(rectifier.geometry().baseline > 0.0);
}

void FuzzCloud(Input& input) {
  sensor_msgs::msg::PointCloud2 cloud;
  cloud.header(TakeHeader(input));
  cloud.width(input.TakeSize());
  cloud.height(input.TakeSize());
  cloud.point_step(input.TakeSize());
  const bool honest = input.Take<std::uint8_t>() > 40;
  const std::uint64_t row = std::uint64_t{cloud.point_step()} * cloud.width();
  cloud.row_step(honest && row < 4096 ? static_cast<std::uint32_t>(row) : input.TakeSize());
  static const char* const kNames[] = {"x", "y", "z", "rgb", "intensity"};
  for (const char* const name : kNames) {
    sensor_msgs::msg::PointField field;
    field.name(name);
    field.offset(input.TakeSize());
    field.datatype(input.Take<std::uint8_t>() < 200 ? 7 : 2);
    field.count(1);
    cloud.fields().push_back(field);
  }
  const std::uint64_t bytes = std::uint64_t{cloud.row_step()} * cloud.height();
  cloud.data(input.TakeBytes(honest && bytes < 65536 ? bytes : input.TakeSize() % 4096U));
  for (const auto infinity : {dds::Infinity::kNoMeasurement, dds::Infinity::kNoReturn}) {
    const auto points = dds::FromIdl(cloud, infinity);
    if (!points) return Require(!points.error().empty());
    Require(points->cloud.points_C.size() == std::size_t{cloud.width()} * cloud.height());
    for (const Eigen::Vector3f& p_C : points->cloud.points_C) {
      const bool no_return = infinity == dds::Infinity::kNoReturn && IsNoReturn(p_C) && p_C.x() == 0.0F;
      Require(p_C.allFinite() || p_C.array().isNaN().all() || no_return);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  switch (input.Take<std::uint8_t>() % 3) {
    case 0:
      FuzzImage(input);
      break;
    case 1:
      FuzzInfo(input);
      break;
    default:
      FuzzCloud(input);
      break;
  }
  return 0;
}
