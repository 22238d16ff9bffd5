#include "services/stereo/adapter/convert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/base/size_text.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr int kLeastBayer = 4;         // [px]
constexpr float kInvalid = -1.0F;      // [px]
constexpr float kStep = 1.0F / 16.0F;  // [px] resolution of a parabola on 8-bit images
constexpr double kSame = 1e-6;         // [px], and for the elements of a rotation
constexpr std::array<std::string_view, 3> kModels = {"plumb_bob", "rational_polynomial", ""};

/// OpenCV's code for the conversion to RGB; -1 if none is needed.
int ConversionOf(std::string_view encoding) {
  if (encoding == "bgr8") return cv::COLOR_BGR2RGB;
  if (encoding == "bayer_rggb8") return cv::COLOR_BayerRGGB2RGB;
  if (encoding == "bayer_bggr8") return cv::COLOR_BayerBGGR2RGB;
  if (encoding == "bayer_gbrg8") return cv::COLOR_BayerGBRG2RGB;
  if (encoding == "bayer_grbg8") return cv::COLOR_BayerGRBG2RGB;
  return -1;
}

template <int kRows, int kColumns>
Eigen::Matrix<double, kRows, kColumns> ToMatrix(
    const std::array<double, std::size_t{kRows} * std::size_t{kColumns}>& values) {
  return Eigen::Map<const Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor>>(values.data());
}

bool IsRectified(const sensor_msgs::msg::CameraInfo& info) {
  const Eigen::Matrix3d K = ToMatrix<3, 3>(info.k());
  const Eigen::Matrix3d K_rectified = ToMatrix<3, 4>(info.p()).leftCols<3>();
  return std::all_of(info.d().begin(), info.d().end(), [](double value) { return value == 0.0; }) &&
         (K - K_rectified).cwiseAbs().maxCoeff() <= kSame && ToMatrix<3, 3>(info.r()).isIdentity(kSame);
}

Result<Rectification> RectificationFrom(const sensor_msgs::msg::CameraInfo& info, const std::string& name) {
  const std::string& model = info.distortion_model();
  if (!info.d().empty() && std::find(kModels.begin(), kModels.end(), model) == kModels.end()) {
    return Error{name + ": distortion_model is \"" + model + "\", must be plumb_bob or rational_polynomial"};
  }
  Rectification from;
  from.raw = {static_cast<int>(info.width()), static_cast<int>(info.height()), ToMatrix<3, 3>(info.k()),
              info.d()};
  from.R_rectified_raw = ToMatrix<3, 3>(info.r());
  if (const auto mistake = MistakeIn(from, name)) return Error{*mistake};
  return from;
}

}  // namespace

Result<ByteImage> ToByteImage(const dds::ImageView& view) {
  const bool is_gray = view.encoding == "mono8";
  const bool is_bayer = view.encoding.starts_with("bayer");
  if (is_bayer && (view.width_px < kLeastBayer || view.height_px < kLeastBayer)) {
    return Error{"a Bayer image of " + SizeText(view.width_px, view.height_px) +
                 " is too small to have colors"};
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

Result<StereoInfo> FromIdl(const sensor_msgs::msg::CameraInfo& left,
                           const sensor_msgs::msg::CameraInfo& right) {
  const Result<dds::StampedCamera> from_left = dds::FromIdl(left);
  if (!from_left) return Error{"left: " + from_left.error()};
  const Result<dds::StampedCamera> from_right = dds::FromIdl(right);
  if (!from_right) return Error{"right: " + from_right.error()};
  const PinholeCamera& a = from_left->camera;
  const PinholeCamera& b = from_right->camera;
  if (a.width_px != b.width_px || a.height_px != b.height_px || std::abs(a.fx - b.fx) > kSame ||
      std::abs(a.fy - b.fy) > kSame || std::abs(a.cy - b.cy) > kSame || std::abs(a.cx - b.cx) > kSame) {
    return Error{"the two cameras differ in size or p, so they are not a rectified pair"};
  }
  if (!(from_right->baseline > 0.0)) return Error{"right: baseline in p is 0"};
  StereoInfo info{{a, from_right->baseline}, std::nullopt};
  if (IsRectified(left) && IsRectified(right)) return info;
  const Result<Rectification> raw_left = RectificationFrom(left, "left");
  if (!raw_left) return Error{raw_left.error()};
  const Result<Rectification> raw_right = RectificationFrom(right, "right");
  if (!raw_right) return Error{raw_right.error()};
  info.rectifications = {*raw_left, *raw_right};
  return info;
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
