#include "services/stereo/adapter/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <string>

#include "tests/support/random_images.h"

namespace thalweg::stereo {
namespace {

using testing::HasSubstr;

const Time kStamp{std::chrono::seconds(3)};
const PinholeCamera kSmallCamera{32, 24, 40.0, 40.0, 15.5, 11.5};

Result<ByteImage> Convert(const sensor_msgs::msg::Image& message) {
  const Result<dds::ImageView> view = dds::FromIdl(message);
  if (!view) return Error{view.error()};
  return ToByteImage(*view);
}

TEST(ToByteImage, TakesGrayAndBothOrdersOfColor) {
  const std::vector<std::uint8_t> bytes = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(Convert(dds::ToIdl(kStamp, dds::kCameraFrame, 3, 2, "mono8", bytes))->data(), bytes);
  EXPECT_EQ(Convert(dds::ToIdl(kStamp, dds::kCameraFrame, 2, 1, "rgb8", bytes))->data(), bytes);
  EXPECT_THAT(Convert(dds::ToIdl(kStamp, dds::kCameraFrame, 2, 1, "bgr8", bytes))->data(),
              testing::ElementsAre(3, 2, 1, 6, 5, 4));
}

TEST(ToByteImage, LeavesOutThePaddingOfRows) {
  sensor_msgs::msg::Image message = dds::ToIdl(kStamp, dds::kCameraFrame, 3, 2, "mono8", {1, 2, 3, 4, 5, 6});
  message.step(4);
  message.data({1, 2, 3, 99, 4, 5, 6, 99});
  EXPECT_THAT(Convert(message)->data(), testing::ElementsAre(1, 2, 3, 4, 5, 6));
}

/// A mosaic of a single color must give that color, in each of the four arrangements.
TEST(ToByteImage, DemosaicsEveryBayerPattern) {
  const std::map<char, std::uint8_t> color = {{'r', 200}, {'g', 120}, {'b', 40}};
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    std::vector<std::uint8_t> bytes;
    for (int v = 0; v < 8; ++v) {
      for (int u = 0; u < 8; ++u)
        bytes.push_back(color.at(pattern[static_cast<std::size_t>(2 * (v % 2) + u % 2)]));
    }
    const auto image = Convert(dds::ToIdl(kStamp, dds::kCameraFrame, 8, 8, "bayer_" + pattern + "8", bytes));
    ASSERT_TRUE(image) << image.error();
    const std::uint8_t* const pixel = &(*image)(4, 4);
    EXPECT_EQ((std::array{pixel[0], pixel[1], pixel[2]}), (std::array<std::uint8_t, 3>{200, 120, 40}))
        << pattern;
  }
}

TEST(ToByteImage, RefusesWhatItCannotBe) {
  const auto error = [](auto&& change) {
    sensor_msgs::msg::Image message =
        dds::ToIdl(kStamp, dds::kCameraFrame, 3, 2, "mono8", {1, 2, 3, 4, 5, 6});
    change(message);
    const auto image = Convert(message);
    return image ? std::string("none") : image.error();
  };
  EXPECT_THAT(error([](auto& m) { m.encoding("mono16"); }), HasSubstr("mono16"));
  EXPECT_THAT(error([](auto& m) { m.width(0); }), HasSubstr("0 x 2"));
  EXPECT_THAT(error([](auto& m) { m.data().pop_back(); }), HasSubstr("5 bytes"));
  EXPECT_THAT(error([](auto& m) { m.encoding("bayer_rggb8"); }), HasSubstr("3 x 2"));
}

TEST(StereoInfo, TakesThePinholeOfARectifiedPair) {
  const auto info = FromIdl(dds::ToIdl(kStamp, kSmallCamera, 0.0), dds::ToIdl(kStamp, kSmallCamera, 0.12));
  ASSERT_TRUE(info) << info.error();
  EXPECT_NEAR(info->geometry.baseline, 0.12, 1e-12);
  EXPECT_EQ(info->geometry.camera.cx, 15.5);
  EXPECT_FALSE(info->rectifications);
}

TEST(StereoInfo, ReportsHowRawImagesBecomeRectified) {
  sensor_msgs::msg::CameraInfo left = dds::ToIdl(kStamp, kSmallCamera, 0.0);
  sensor_msgs::msg::CameraInfo right = dds::ToIdl(kStamp, kSmallCamera, 0.12);
  right.k({41.0, 0.0, 16.0, 0.0, 42.0, 12.0, 0.0, 0.0, 1.0});
  right.d({0.1, 0.2, 0.3, 0.4, 0.5});
  right.r({0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 1.0});
  const auto info = FromIdl(left, right);
  ASSERT_TRUE(info) << info.error();
  ASSERT_TRUE(info->rectifications);
  const Rectification& from = (*info->rectifications)[1];
  EXPECT_EQ(from.raw.K(1, 1), 42.0);
  EXPECT_EQ(from.raw.K(0, 2), 16.0);
  EXPECT_EQ(from.R_rectified_raw(0, 1), 0.6);
  EXPECT_EQ(from.raw.distortion, right.d());
  EXPECT_EQ(info->geometry.camera.fx, 40.0) << "that of p";
}

TEST(StereoInfo, AnyOfDistortionRotationOrOtherKMakesItRaw) {
  const auto is_raw = [](auto&& change) {
    sensor_msgs::msg::CameraInfo left = dds::ToIdl(kStamp, kSmallCamera, 0.0);
    change(left);
    const auto info = FromIdl(left, dds::ToIdl(kStamp, kSmallCamera, 0.12));
    EXPECT_TRUE(info) << info.error();
    return info && info->rectifications;
  };
  EXPECT_FALSE(is_raw([](auto&) {}));
  EXPECT_TRUE(is_raw([](auto& l) { l.d()[4] = 0.01; }));
  EXPECT_TRUE(is_raw([](auto& l) { l.r({0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 1.0}); }));
  EXPECT_TRUE(is_raw([](auto& l) { l.k()[0] = 41.0; }));
}

TEST(StereoInfo, NamesWhatIsWrong) {
  const auto error = [](auto&& change) {
    sensor_msgs::msg::CameraInfo left = dds::ToIdl(kStamp, kSmallCamera, 0.0);
    sensor_msgs::msg::CameraInfo right = dds::ToIdl(kStamp, kSmallCamera, 0.12);
    change(left, right);
    const auto info = FromIdl(left, right);
    return info ? std::string("none") : info.error();
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error([](auto& l, auto&) { l.k()[0] = kNan; }), "left K contains a non-finite value");
  EXPECT_EQ(error([](auto&, auto& r) { r.d()[0] = kNan; }), "right D contains a non-finite value");
  EXPECT_EQ(error([](auto&, auto& r) {
              r.d({0.1, 0.2, 0.3});
            }),
            "right D has 3 numbers, must have 0, 4, 5, 8, 12 or 14");
  EXPECT_EQ(error([](auto& l, auto&) { l.r()[0] = 2.0; }), "left R is not a rotation");
  EXPECT_THAT(error([](auto& l, auto&) {
                l.distortion_model("equidistant");
                l.d()[0] = 0.1;
              }),
              HasSubstr("left: distortion_model is \"equidistant\""));
  EXPECT_THAT(error([](auto&, auto& r) { r.p()[0] = kNan; }), HasSubstr("right: p"));
  EXPECT_THAT(error([](auto&, auto& r) { r.p()[3] = 0.0; }), HasSubstr("right: baseline in p is 0"));
  EXPECT_THAT(error([](auto&, auto& r) { r.width(33); }), HasSubstr("differ in size or p"));
}

TEST(DisparityMessage, SaysWhatItsPixelsMean) {
  DisparityMap disparity(2, 1);
  disparity.data() = {4.5F, kNoDisparity};
  const auto message = ToIdl(kStamp, disparity, {kSmallCamera, 0.12}, 64);
  ASSERT_EQ(message.image().data().size(), 8U);
  float values[2];
  std::memcpy(values, message.image().data().data(), 8);
  EXPECT_EQ(values[0], 4.5F);
  EXPECT_LT(values[1], message.min_disparity());
  EXPECT_EQ(message.f(), 40.0F);
  EXPECT_FLOAT_EQ(message.t(), 0.12F);
  EXPECT_EQ(message.max_disparity(), 63.0F);
}

}  // namespace
}  // namespace thalweg::stereo
