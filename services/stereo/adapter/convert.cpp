#include "services/stereo/adapter/convert.h"

#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>

#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr int kLeastBayer = 4;         // [px]
constexpr float kInvalid = -1.0F;      // [px]
constexpr float kStep = 1.0F / 16.0F;  // [px] of a parabola on 8-bit images
constexpr double kSame = 1e-6;         // [px]

/// OpenCV's code to RGB; -1: there is none to be applied.
int ConversionOf(std::string_view encoding) {
  if (encoding == "bgr8") return cv::COLOR_BGR2RGB;
  if (encoding == "bayer_rggb8") return cv::COLOR_BayerRGGB2RGB;
  if (encoding == "bayer_bggr8") return cv::COLOR_BayerBGGR2RGB;
  if (encoding == "bayer_gbrg8") return cv::COLOR_BayerGBRG2RGB;
  if (encoding == "bayer_grbg8") return cv::COLOR_BayerGRBG2RGB;
  return -1;
}

/// Why the images would have to be rectified first; none when they are.
std::optional<Error> IsRaw(const sensor_msgs::msg::CameraInfo& info) {
  for (const double value : info.d()) {
    if (value != 0.0) return Error{"d is not 0: raw images need stereo.calibration_file"};
  }
  const std::array<double, 9>& k = info.k();
  const std::array<double, 12>& p = info.p();
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      if (!(std::abs(k[3 * row + column] - p[4 * row + column]) <= kSame)) {
        return Error{"k is not the left part of p: raw images need stereo.calibration_file"};
      }
    }
  }
  return std::nullopt;
}

}  // namespace

Result<ByteImage> ToByteImage(const dds::ImageView& view) {
  const bool is_gray = view.encoding == "mono8";
  const bool is_bayer = view.encoding.starts_with("bayer");
  if (is_bayer && (view.width_px < kLeastBayer || view.height_px < kLeastBayer)) {
    return Error{"a Bayer image of " + std::to_string(view.width_px) + " x " +
                 std::to_string(view.height_px) + " is too small to have colours"};
  }
  const int type = is_gray || is_bayer ? CV_8UC1 : CV_8UC3;
  const cv::Mat from(view.height_px, view.width_px, type,
                     const_cast<std::uint8_t*>(view.data),  // NOLINT: only read
                     static_cast<std::size_t>(view.step_bytes));
  ByteImage image(view.width_px, view.height_px, is_gray ? 1 : 3);
  cv::Mat to(view.height_px, view.width_px, is_gray ? CV_8UC1 : CV_8UC3, image.data().data());
  const int conversion = ConversionOf(view.encoding);
  if (conversion < 0) {
    from.copyTo(to);
  } else {
    cv::cvtColor(from, to, conversion);
  }
  return image;
}

Result<StereoGeometry> ToStereoGeometry(const sensor_msgs::msg::CameraInfo& left,
                                        const sensor_msgs::msg::CameraInfo& right) {
  const Result<dds::StampedCamera> from_left = dds::FromIdl(left);
  if (!from_left) return Error{"left: " + from_left.error()};
  const Result<dds::StampedCamera> from_right = dds::FromIdl(right);
  if (!from_right) return Error{"right: " + from_right.error()};
  if (const auto error = IsRaw(left)) return Error{"left: " + error->text};
  const PinholeCamera& a = from_left->camera;
  const PinholeCamera& b = from_right->camera;
  if (a.width_px != b.width_px || a.height_px != b.height_px || std::abs(a.fx - b.fx) > kSame ||
      std::abs(a.fy - b.fy) > kSame || std::abs(a.cy - b.cy) > kSame || std::abs(a.cx - b.cx) > kSame) {
    return Error{"the two cameras differ: no rectified pair"};
  }
  if (!(from_right->baseline > 0.0)) return Error{"right: baseline in p is 0"};
  return StereoGeometry{a, from_right->baseline};
}

stereo_msgs::msg::DisparityImage ToIdl(Time stamp, const DisparityMap& disparity,
                                       const StereoGeometry& camera, int max_disparity) {
  stereo_msgs::msg::DisparityImage message;
  message.header(dds::MakeHeader(stamp, dds::kCameraFrame));
  sensor_msgs::msg::Image& image = message.image();
  image.header(message.header());
  image.width(static_cast<std::uint32_t>(disparity.width()));
  image.height(static_cast<std::uint32_t>(disparity.height()));
  image.encoding("32FC1");
  image.is_bigendian(0);
  image.step(static_cast<std::uint32_t>(sizeof(float)) * image.width());
  std::vector<std::uint8_t>& bytes = image.data();
  bytes.resize(disparity.data().size() * sizeof(float));
  std::uint8_t* to = bytes.data();
  for (const float d : disparity.data()) {
    const float value = std::isnan(d) ? kInvalid : d;
    std::memcpy(to, &value, sizeof(float));
    to += sizeof(float);
  }
  message.f(static_cast<float>(camera.camera.fx));
  message.t(static_cast<float>(camera.baseline));
  message.min_disparity(0.0F);
  message.max_disparity(static_cast<float>(max_disparity - 1));
  message.delta_d(kStep);
  return message;
}

}  // namespace thalweg::stereo
