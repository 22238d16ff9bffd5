#include "common/dds/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace thalweg::dds {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();
const Time kStamp{std::chrono::seconds(1234) + Duration(567'890'123)};

RigidTransform RandomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-50.0, 50.0);
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
  return MakeTransform(q.toRotationMatrix(), {coordinate(random), coordinate(random), coordinate(random)});
}

PointCloud RandomCloud(std::mt19937& random, bool with_colors) {
  PointCloud cloud{.width_px = 17, .height_px = 9, .points_C = {}, .colors = {}};
  std::uniform_real_distribution<float> coordinate(-8.0F, 8.0F);
  std::uniform_int_distribution<int> gray(0, 255);
  for (int k = 0; k < 17 * 9; ++k) {
    cloud.points_C.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    if (k % 5 == 0) cloud.points_C.back().setConstant(std::numeric_limits<float>::quiet_NaN());
    if (!with_colors) continue;
    const auto channel = [&] { return static_cast<std::uint8_t>(gray(random)); };
    cloud.colors.push_back({.r = channel(), .g = channel(), .b = channel()});
  }
  return cloud;
}

void ExpectSame(const PointCloud& a, const PointCloud& b) {
  EXPECT_EQ(a.width_px, b.width_px);
  EXPECT_EQ(a.height_px, b.height_px);
  EXPECT_EQ(a.colors, b.colors);
  ASSERT_EQ(a.points_C.size(), b.points_C.size());
  for (std::size_t k = 0; k < a.points_C.size(); ++k) {
    if (a.points_C[k].hasNaN()) {
      EXPECT_TRUE(b.points_C[k].hasNaN());
    } else {
      EXPECT_EQ(a.points_C[k], b.points_C[k]);
    }
  }
}

/// A message made invalid in one way, and what the error must name.
template <class Message>
struct Lie {
  const char* what;
  std::function<void(Message&)> tell;
  const char* named;
};

template <class Message>
void ExpectAllRefused(const Message& honest, const std::vector<Lie<Message>>& lies) {
  ASSERT_TRUE(FromIdl(honest)) << FromIdl(honest).error();
  for (const Lie<Message>& lie : lies) {
    Message message = honest;
    lie.tell(message);
    const auto result = FromIdl(message);
    ASSERT_FALSE(result) << lie.what;
    EXPECT_NE(result.error().find(lie.named), std::string::npos) << lie.what << ": " << result.error();
  }
}

TEST(Convert, TimeComesBackToTheNanosecond) {
  EXPECT_EQ(*FromIdl(ToIdl(kStamp)), kStamp);
  EXPECT_EQ(ToIdl(kStamp).sec(), 1234);
  EXPECT_EQ(ToIdl(kStamp).nanosec(), 567'890'123U);
  EXPECT_EQ(*FromIdl(ToIdl(Time{})), Time{});
}

TEST(Convert, TimeThatIsNoneIsRefused) {
  builtin_interfaces::msg::Time time;
  time.nanosec(1'000'000'000);
  EXPECT_FALSE(FromIdl(time));
  time.nanosec(0);
  time.sec(-1);
  EXPECT_FALSE(FromIdl(time));
}

TEST(Convert, PosesComeBack) {
  std::mt19937 random(1);
  for (int k = 0; k < 200; ++k) {
    const RigidTransform T = RandomPose(random);
    EXPECT_TRUE(FromIdl(ToIdl(T))->isApprox(T, 1e-12));
    const Result<StampedPose> odometry = FromIdl(OdometryToIdl(kStamp, T, {1, 2, 3}, {4, 5, 6}));
    EXPECT_TRUE(odometry->T.isApprox(T, 1e-12));
    EXPECT_EQ(odometry->stamp, kStamp);
    const Result<StampedPose> command = FromIdl(PoseStampedToIdl(kStamp, T));
    EXPECT_TRUE(command->T.isApprox(T, 1e-12));
  }
}

TEST(Convert, OdometrySaysTheVelocityInTheBody) {
  const auto message = OdometryToIdl(kStamp, RigidTransform::Identity(), {1, 2, 3}, {4, 5, 6});
  EXPECT_EQ(message.twist().twist().linear().y(), 2.0);
  EXPECT_EQ(message.twist().twist().angular().z(), 6.0);
}

TEST(Convert, ALittleOffUnitLengthIsNormalized) {
  geometry_msgs::msg::Pose pose = ToIdl(RigidTransform::Identity());
  pose.orientation().w(1.009);
  EXPECT_TRUE(FromIdl(pose)->isApprox(RigidTransform::Identity(), 1e-12));
}

TEST(Convert, PosesThatLieAreRefused) {
  using Pose = geometry_msgs::msg::Pose;
  ExpectAllRefused<Pose>(ToIdl(RigidTransform::Identity()),
                         {{"x NaN", [](Pose& p) { p.position().x(kNan); }, "position"},
                          {"y NaN", [](Pose& p) { p.position().y(kNan); }, "position"},
                          {"z infinite", [](Pose& p) { p.position().z(-kInfinite); }, "position"},
                          {"too far", [](Pose& p) { p.position().z(1.1e6); }, "position"},
                          {"no rotation", [](Pose& p) { p.orientation().w(0.0); }, "orientation"},
                          {"too long", [](Pose& p) { p.orientation().w(1.02); }, "orientation"},
                          {"too short", [](Pose& p) { p.orientation().w(0.98); }, "orientation"},
                          {"NaN", [](Pose& p) { p.orientation().y(kNan); }, "orientation"},
                          {"infinite", [](Pose& p) { p.orientation().z(kInfinite); }, "orientation"}});
}

TEST(Convert, OdometryAndCommandsThatLieAreRefused) {
  using nav_msgs::msg::Odometry;
  const auto odometry = OdometryToIdl(kStamp, RigidTransform::Identity(), {0, 0, 0}, {0, 0, 0});
  ExpectAllRefused<Odometry>(
      odometry, {{"frame", [](Odometry& o) { o.header().frame_id("map"); }, "frame_id"},
                 {"child", [](Odometry& o) { o.child_frame_id("wheel"); }, "wheel"},
                 {"stamp", [](Odometry& o) { o.header().stamp().nanosec(1'000'000'000); }, "nanosec"},
                 {"pose", [](Odometry& o) { o.pose().pose().position().x(kNan); }, "position"}});
  using geometry_msgs::msg::PoseStamped;
  ExpectAllRefused<PoseStamped>(
      PoseStampedToIdl(kStamp, RigidTransform::Identity()),
      {{"frame", [](PoseStamped& p) { p.header().frame_id("odom"); }, "odom"},
       {"stamp", [](PoseStamped& p) { p.header().stamp().sec(-5); }, "sec"},
       {"pose", [](PoseStamped& p) { p.pose().orientation().w(kNan); }, "orientation"}});
}

TEST(Convert, PathsComeBackAndEmptyOnesToo) {
  std::mt19937 random(2);
  StampedPath path{.stamp = kStamp, .T_WBs = {}};
  EXPECT_TRUE(FromIdl(ToIdl(path))->T_WBs.empty());
  for (int k = 0; k < 20; ++k) path.T_WBs.push_back(RandomPose(random));
  const Result<StampedPath> back = FromIdl(ToIdl(path));
  EXPECT_EQ(back->stamp, kStamp);
  ASSERT_EQ(back->T_WBs.size(), 20U);
  for (std::size_t k = 0; k < 20; ++k) EXPECT_TRUE(back->T_WBs[k].isApprox(path.T_WBs[k], 1e-12));
}

TEST(Convert, PathsThatLieAreRefused) {
  using nav_msgs::msg::Path;
  const std::vector<RigidTransform> two(2, RigidTransform::Identity());
  ExpectAllRefused<Path>(
      ToIdl(StampedPath{.stamp = kStamp, .T_WBs = two}),
      {{"frame", [](Path& p) { p.header().frame_id(""); }, "frame_id"},
       {"inner frame", [](Path& p) { p.poses()[1].header().frame_id("odom"); }, "poses[1]"},
       {"inner pose", [](Path& p) { p.poses()[1].pose().position().z(kNan); }, "poses[1]"}});
}

TEST(Convert, ViewsOfScansComeBack) {
  std::mt19937 random(9);
  for (const bool measured : {false, true}) {
    ScanView scan{.T_WC = RandomPose(random)};
    if (measured) {
      scan.measured.emplace();
      for (std::uint8_t& share : scan.measured->of_255) share = static_cast<std::uint8_t>(random());
    }
    const thalweg_msgs::msg::ScanView message = ToIdl(kStamp, scan);
    EXPECT_EQ(message.measured().size(), measured ? 64U : 0U);
    EXPECT_EQ(*FromIdl(message.stamp()), kStamp);
    const Result<ScanView> back = FromIdl(message);
    ASSERT_TRUE(back) << back.error();
    EXPECT_TRUE(back->T_WC.isApprox(scan.T_WC, 1e-9));
    ASSERT_EQ(back->measured.has_value(), measured);
    if (!measured) continue;
    EXPECT_EQ(back->measured->of_255, scan.measured->of_255);
  }
}

TEST(Convert, ViewsOfScansThatLieAreRefused) {
  for (const std::size_t length : {1U, 63U, 65U, 128U, 1U << 20U}) {
    thalweg_msgs::msg::ScanView scan = ToIdl(kStamp, ScanView{.T_WC = RigidTransform::Identity()});
    scan.measured(std::vector<std::uint8_t>(length, 255));
    const Result<ScanView> result = FromIdl(scan);
    ASSERT_FALSE(result) << length;
    EXPECT_EQ(result.error(), "length of measured is " + std::to_string(length) + ", must be 0 or 64");
  }
  thalweg_msgs::msg::ScanView scan = ToIdl(kStamp, ScanView{.T_WC = RigidTransform::Identity()});
  scan.map_from_camera().position().y(kNan);
  const Result<ScanView> result = FromIdl(scan);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().find("position"), std::string::npos);
}

TEST(Convert, TransformsLeadFromTheMapToTheCamera) {
  std::mt19937 random(3);
  const RigidTransform T_WB = RandomPose(random);
  const RigidTransform T_BC = RandomPose(random);
  const tf2_msgs::msg::TFMessage message = TransformsToIdl(kStamp, T_WB, T_BC);
  RigidTransform T_WC = RigidTransform::Identity();
  std::string frame = kMapFrame;
  for (const auto& link : message.transforms()) {
    EXPECT_EQ(link.header().frame_id(), frame);
    frame = link.child_frame_id();
    const auto& t = link.transform().translation();
    const auto& r = link.transform().rotation();
    T_WC = T_WC * MakeTransform(Eigen::Quaterniond(r.w(), r.x(), r.y(), r.z()).toRotationMatrix(),
                                {t.x(), t.y(), t.z()});
  }
  EXPECT_EQ(frame, kCameraFrame);
  EXPECT_TRUE(T_WC.isApprox(T_WB * T_BC, 1e-12));
}

TEST(Convert, CloudsComeBackWithAndWithoutColors) {
  std::mt19937 random(4);
  for (const bool with_colors : {false, true}) {
    const PointCloud cloud = RandomCloud(random, with_colors);
    const Result<StampedCloud> back = FromIdl(ToIdl(kStamp, cloud));
    ASSERT_TRUE(back) << back.error();
    EXPECT_EQ(back->stamp, kStamp);
    ExpectSame(cloud, back->cloud);
  }
}

TEST(Convert, ColorIsPackedAsPclDoes) {
  PointCloud cloud{
      .width_px = 1, .height_px = 1, .points_C = {{1, 2, 3}}, .colors = {{.r = 1, .g = 2, .b = 3}}};
  const auto message = ToIdl(kStamp, cloud);
  std::uint32_t packed = 0;
  std::memcpy(&packed, message.data().data() + 12, 4);
  EXPECT_EQ(packed, 0x00010203U);
  EXPECT_TRUE(message.is_dense());
}

TEST(Convert, CloudsOfOtherMakersAreRead) {
  // A layout that PCL uses: 32 bytes per point, fields in another order, padded rows, an additional
  // intensity.
  sensor_msgs::msg::PointCloud2 message;
  message.header(MakeHeader(kStamp, kCameraFrame));
  message.width(2);
  message.height(2);
  message.point_step(32);
  message.row_step(80);
  const auto add = [&](const char* name, std::uint32_t offset, std::uint8_t datatype) {
    sensor_msgs::msg::PointField field;
    field.name(name);
    field.offset(offset);
    field.datatype(datatype);
    field.count(1);
    message.fields().push_back(field);
  };
  add("intensity", 20, 4);
  add("z", 8, 7);
  add("x", 0, 7);
  add("y", 4, 7);
  add("rgba", 16, 6);
  message.data().resize(160);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto number = static_cast<float>(k);
    const float xyz[3] = {number, 10.0F * number, 100.0F * number};
    const std::uint32_t color = 0xFF000000U + static_cast<std::uint32_t>(k);
    std::uint8_t* const at = message.data().data() + (k / 2) * 80 + (k % 2) * 32;
    std::memcpy(at, xyz, sizeof xyz);
    std::memcpy(at + 16, &color, sizeof color);
  }
  const Result<StampedCloud> cloud = FromIdl(message);
  ASSERT_TRUE(cloud) << cloud.error();
  for (std::size_t k = 0; k < 4; ++k) {
    const auto number = static_cast<float>(k);
    EXPECT_EQ(cloud->cloud.points_C[k], Eigen::Vector3f(number, 10.0F * number, 100.0F * number));
    EXPECT_EQ(cloud->cloud.colors[k], (Rgb{.r = 0, .g = 0, .b = static_cast<std::uint8_t>(k)}));
  }
}

TEST(Convert, PointsThatAreNoMeasurementBecomeNan) {
  PointCloud cloud{.width_px = 4, .height_px = 1, .points_C = {}, .colors = {}};
  cloud.points_C = {{1.0F, 2.0F, std::numeric_limits<float>::quiet_NaN()},
                    {std::numeric_limits<float>::infinity(), 0.0F, 1.0F},
                    {0.0F, -1e30F, 1.0F},
                    {1.0F, 2.0F, 3.0F}};
  const Result<StampedCloud> back = FromIdl(ToIdl(kStamp, cloud));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(back->cloud.points_C[k].array().isNaN().all());
  EXPECT_EQ(back->cloud.points_C[3], Eigen::Vector3f(1, 2, 3));
}

TEST(Convert, WhatIsInfinitelyFarIsNoReturnOnlyWhereThatIsAskedFor) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  PointCloud cloud{.width_px = 5, .height_px = 2, .points_C = {}, .colors = {}};
  cloud.points_C = {NoReturn(),
                    {kInfinity, -kInfinity, kInfinity},  // as results from multiplying out a depth image
                    {kNaN, kNaN, kInfinity},             // 0 times infinity at the image center
                    {0.0F, 0.0F, -kInfinity},            // too near
                    {kInfinity, 0.0F, 1.0F},
                    {0.0F, kInfinity, kNaN},
                    {0.0F, 0.0F, 1e30F},
                    {0.0F, 0.0F, -1e30F},
                    {kNaN, 0.0F, 1.0F},
                    {1.0F, 2.0F, 3.0F}};
  const auto message = ToIdl(kStamp, cloud);
  const Result<StampedCloud> plain = FromIdl(message);
  const Result<StampedCloud> asked = FromIdl(message, Infinity::kNoReturn);
  for (std::size_t k = 0; k < 9; ++k) {
    EXPECT_TRUE(plain->cloud.points_C[k].array().isNaN().all()) << k;
    if (k < 3) {
      EXPECT_EQ(asked->cloud.points_C[k], NoReturn()) << k;
    } else {
      EXPECT_TRUE(asked->cloud.points_C[k].array().isNaN().all()) << k;
    }
  }
  EXPECT_EQ(asked->cloud.points_C[9], Eigen::Vector3f(1, 2, 3));
  cloud.points_C.assign(10, Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(ToIdl(kStamp, cloud).is_dense());
  cloud.points_C[4] = NoReturn();
  EXPECT_FALSE(ToIdl(kStamp, cloud).is_dense()) << "others must not take it for a point";
}

TEST(Convert, CloudsThatLieAreRefused) {
  using Cloud = sensor_msgs::msg::PointCloud2;
  std::mt19937 random(5);
  ExpectAllRefused<Cloud>(
      ToIdl(kStamp, RandomCloud(random, true)),
      {{"no rows", [](Cloud& c) { c.height(0); }, "0"},
       {"0 x 0", [](Cloud& c) { c.width(0), c.height(0), c.row_step(0), c.data().clear(); }, "0 x 0"},
       {"huge", [](Cloud& c) { c.width(0xFFFFFFFF), c.height(0xFFFFFFFF); }, "4294967295"},
       {"too wide", [](Cloud& c) { c.width(18); }, "row"},
       {"too high", [](Cloud& c) { c.height(10); }, "data"},
       {"a byte short", [](Cloud& c) { c.data().pop_back(); }, "data"},
       {"a byte long", [](Cloud& c) { c.data().push_back(0); }, "data"},
       {"row too short", [](Cloud& c) { c.row_step(100); }, "row"},
       {"row too long", [](Cloud& c) { c.row_step(0x7FFFFFFF); }, "row"},
       {"point_step 0", [](Cloud& c) { c.point_step(0); }, "point_step"},
       {"point_step huge", [](Cloud& c) { c.point_step(0xFFFFFFFF); }, "row"},
       {"big-endian", [](Cloud& c) { c.is_bigendian(true); }, "is_bigendian"},
       {"no fields", [](Cloud& c) { c.fields().clear(); }, "field x"},
       {"no z", [](Cloud& c) { c.fields()[2].name("range"); }, "field z"},
       {"x twice", [](Cloud& c) { c.fields()[1].name("x"); }, "field x"},
       {"double", [](Cloud& c) { c.fields()[0].datatype(8); }, "datatype"},
       {"two a field", [](Cloud& c) { c.fields()[0].count(2); }, "count"},
       {"beyond the point", [](Cloud& c) { c.fields()[0].offset(13); }, "offset"},
       {"offset overflows", [](Cloud& c) { c.fields()[0].offset(0xFFFFFFFE); }, "offset"},
       {"rgb beyond", [](Cloud& c) { c.fields()[3].offset(14); }, "rgb"},
       {"frame", [](Cloud& c) { c.header().frame_id("lidar"); }, "lidar"},
       {"stamp", [](Cloud& c) { c.header().stamp().sec(-1); }, "sec"}});
}

TEST(Convert, ImagesComeBackWithoutBeingCopied) {
  std::vector<std::uint8_t> bytes(4 * 3 * 3);
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(k);
  const sensor_msgs::msg::Image message = ToIdl(kStamp, kCameraFrame, 4, 3, "rgb8", bytes);
  const Result<ImageView> view = FromIdl(message);
  ASSERT_TRUE(view) << view.error();
  EXPECT_EQ(view->stamp, kStamp);
  EXPECT_EQ(view->width_px, 4);
  EXPECT_EQ(view->height_px, 3);
  EXPECT_EQ(view->step_bytes, 12);
  EXPECT_EQ(view->encoding, "rgb8");
  EXPECT_EQ(view->data, message.data().data());
}

TEST(Convert, ImagesThatLieAreRefused) {
  using Image = sensor_msgs::msg::Image;
  ExpectAllRefused<Image>(
      ToIdl(kStamp, kCameraFrame, 4, 3, "mono8", std::vector<std::uint8_t>(12)),
      {{"0 x 0", [](Image& i) { i.width(0), i.height(0), i.step(0), i.data().clear(); }, "0 x 0"},
       {"encoding", [](Image& i) { i.encoding("yuv422"); }, "yuv422"},
       {"three channels", [](Image& i) { i.encoding("bgr8"); }, "row"},
       {"too wide", [](Image& i) { i.width(5); }, "row"},
       {"huge", [](Image& i) { i.width(0x80000000), i.height(0x80000000); }, "2147483648"},
       {"data", [](Image& i) { i.data().resize(11); }, "data"},
       {"step", [](Image& i) { i.step(0xFFFFFFFF); }, "row"},
       {"frame", [](Image& i) { i.header().frame_id("kinect"); }, "kinect"}});
}

/// @param pixels  Pixels of one row.
template <class Pixel>
sensor_msgs::msg::Image DepthMessage(const std::string& encoding, const std::vector<Pixel>& pixels) {
  sensor_msgs::msg::Image message;
  message.header(MakeHeader(kStamp, kCameraFrame));
  message.width(static_cast<std::uint32_t>(pixels.size()));
  message.height(1);
  message.encoding(encoding);
  message.step(static_cast<std::uint32_t>(pixels.size() * sizeof(Pixel)));
  message.data().resize(message.step());
  std::memcpy(message.data().data(), pixels.data(), message.step());
  return message;
}

TEST(Convert, DepthImagesInMillimetersBecomeMetersAndZeroIsNoMeasurement) {
  const auto depth = DepthFromIdl(DepthMessage<std::uint16_t>("16UC1", {0, 1, 1500, 65535}));
  ASSERT_TRUE(depth) << depth.error();
  EXPECT_EQ(depth->stamp, kStamp);
  EXPECT_EQ(depth->image.width_px, 4);
  EXPECT_EQ(depth->image.height_px, 1);
  EXPECT_TRUE(std::isnan(depth->image.depths[0]));
  EXPECT_FLOAT_EQ(depth->image.depths[1], 0.001F);
  EXPECT_FLOAT_EQ(depth->image.depths[2], 1.5F);
  EXPECT_FLOAT_EQ(depth->image.depths[3], 65.535F);
}

TEST(Convert, DepthImagesInMetersKeepOnlyWhatIsMeasured) {
  const float nan = std::nanf("");
  const auto message = DepthMessage<float>("32FC1", {nan, 0.0F, -1.0F, 2.5F, INFINITY, -INFINITY, 1e9F});
  for (const Infinity infinity : {Infinity::kNoMeasurement, Infinity::kNoReturn}) {
    const auto depth = DepthFromIdl(message, infinity);
    ASSERT_TRUE(depth) << depth.error();
    for (const std::size_t k : {0, 1, 2, 5, 6}) EXPECT_TRUE(std::isnan(depth->image.depths[k])) << k;
    EXPECT_EQ(depth->image.depths[3], 2.5F);
    EXPECT_EQ(std::isnan(depth->image.depths[4]), infinity == Infinity::kNoMeasurement);
  }
}

TEST(Convert, RowsOfDepthImagesMayBePadded) {
  sensor_msgs::msg::Image message = DepthMessage<std::uint16_t>("16UC1", {1000, 9999, 2000, 9999});
  message.width(1);
  message.height(2);
  message.step(4);
  const auto depth = DepthFromIdl(message);
  ASSERT_TRUE(depth) << depth.error();
  EXPECT_THAT(depth->image.depths, testing::ElementsAre(testing::FloatEq(1.0F), testing::FloatEq(2.0F)));
}

TEST(Convert, DepthImagesThatLieAreRefused) {
  using Image = sensor_msgs::msg::Image;
  const Image good = DepthMessage<std::uint16_t>("16UC1", {1, 2, 3, 4});
  const std::vector<std::pair<std::function<void(Image&)>, std::string>> lies = {
      {[](Image& i) { i.encoding("mono8"); }, "encoding is \"mono8\""},
      {[](Image& i) { i.encoding("32FC1"); }, "row"},
      {[](Image& i) { i.is_bigendian(1); }, "is_bigendian"},
      {[](Image& i) { i.width(0); }, "0 x 1"},
      {[](Image& i) { i.data().pop_back(); }, "data"},
      {[](Image& i) { i.header().frame_id("lidar"); }, "lidar"}};
  for (const auto& [lie, word] : lies) {
    Image message = good;
    lie(message);
    const auto depth = DepthFromIdl(message);
    ASSERT_FALSE(depth) << word;
    EXPECT_NE(depth.error().find(word), std::string::npos) << depth.error();
  }
}

TEST(Convert, ColoredPointsAreACloudOfOneRowInTheMap) {
  const sensor_msgs::msg::PointCloud2 message =
      ToIdl(kStamp, std::vector<ColoredPoint>{{{1, 2, 3}, {10, 20, 30}}, {{4, 5, 6}, {40, 50, 60}}});
  EXPECT_EQ(message.header().frame_id(), kMapFrame);
  EXPECT_EQ(message.height(), 1U);
  EXPECT_EQ(message.width(), 2U);
  EXPECT_TRUE(message.is_dense());
  sensor_msgs::msg::PointCloud2 in_camera = message;
  in_camera.header().frame_id(kCameraFrame);
  const auto back = FromIdl(in_camera);
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->cloud.points_C[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(back->cloud.colors[1], (Rgb{40, 50, 60}));
}

TEST(Convert, StaticTransformsSayWhereTheCameraIsOnlyWhereThatIsKnown) {
  const auto all = StaticTransformsToIdl(kStamp, RigidTransform::Identity());
  ASSERT_EQ(all.transforms().size(), 2U);
  EXPECT_EQ(all.transforms()[0].header().frame_id(), kMapFrame);
  EXPECT_EQ(all.transforms()[0].child_frame_id(), kOdometryFrame);
  EXPECT_EQ(all.transforms()[1].header().frame_id(), kBodyFrame);
  EXPECT_EQ(all.transforms()[1].child_frame_id(), kCameraFrame);
  EXPECT_EQ(StaticTransformsToIdl(kStamp, std::nullopt).transforms().size(), 1U);
}

TEST(Convert, CamerasComeBack) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(512, 384, 1.15);
  const Result<StampedCamera> back = FromIdl(ToIdl(kStamp, camera, 0.12));
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->camera.width_px, 512);
  EXPECT_EQ(back->camera.height_px, 384);
  EXPECT_EQ(back->camera.fx, camera.fx);
  EXPECT_EQ(back->camera.cy, camera.cy);
  EXPECT_NEAR(back->baseline, 0.12, 1e-12);
  EXPECT_EQ(FromIdl(ToIdl(kStamp, camera, 0.0))->baseline, 0.0);
}

TEST(Convert, CamerasThatLieAreRefused) {
  using Info = sensor_msgs::msg::CameraInfo;
  ExpectAllRefused<Info>(ToIdl(kStamp, PinholeCamera::FromFieldOfView(64, 48, 1.0), 0.1),
                         {{"0 x 0", [](Info& i) { i.width(0); }, "0 x 48"},
                          {"focal length 0", [](Info& i) { i.p()[0] = 0.0; }, "focal"},
                          {"focal length NaN", [](Info& i) { i.p()[5] = kNan; }, "p contains"},
                          {"baseline", [](Info& i) { i.p()[3] = 1.0; }, "baseline"},
                          {"frame", [](Info& i) { i.header().frame_id("x"); }, "frame_id"}});
}

}  // namespace
}  // namespace thalweg::dds
