#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "common/base/angles.h"
#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "tests/support/places.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using nlohmann::json;

const Time kStamp{std::chrono::seconds(1234) + Duration(567'890'123)};
constexpr int kCount = 3;

/// The output of tests/integration/cyclone_listener.c: one JSON object per line.
class CycloneListener {
 public:
  explicit CycloneListener(const BusOptions& options)
      : pipe_(popen((test::BinFolder() + "/cyclone_listener " + std::to_string(options.domain) + ' ' +
                     options.partition + ' ' + std::to_string(kCount))
                        .c_str(),
                    "r")) {}
  ~CycloneListener() { Close(); }
  CycloneListener(const CycloneListener&) = delete;
  CycloneListener& operator=(const CycloneListener&) = delete;

  /// Returns the next line; empty at the end.
  std::string ReadLine() {
    std::string line;
    std::array<char, 4096> part{};
    while (std::fgets(part.data(), part.size(), pipe_) != nullptr) {
      line += part.data();
      if (line.ends_with('\n')) break;
    }
    return line;
  }
  /// Returns the exit status.
  int Close() {
    const int status = pipe_ == nullptr ? -1 : pclose(pipe_);
    pipe_ = nullptr;
    return status;
  }

 private:
  FILE* pipe_;
};

std::uint64_t Fnv1a(std::uint64_t hash, const void* bytes, std::size_t size) {
  const auto* const byte = static_cast<const std::uint8_t*>(bytes);
  for (std::size_t k = 0; k < size; ++k) hash = (hash ^ byte[k]) * 1'099'511'628'211ULL;
  return hash;
}
constexpr std::uint64_t kFnvStart = 14'695'981'039'346'656'037ULL;

/// A cloud larger than one UDP datagram, with holes and colors.
PointCloud LargeCloud() {
  PointCloud cloud{.width_px = 160, .height_px = 100, .points_C = {}, .colors = {}};
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-5.0F, 5.0F);
  for (int k = 0; k < 160 * 100; ++k) {
    cloud.points_C.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    if (k % 7 == 0) cloud.points_C.back().setConstant(std::nanf(""));
    cloud.colors.push_back({.r = static_cast<std::uint8_t>(k), .g = 2, .b = 3});
  }
  return cloud;
}

RigidTransform PoseAt(double x) {
  return MakeTransform(RotationFromYawPitch(0.3 * x, -0.1), {x, 2.0 * x, -0.5});
}

thalweg_msgs::msg::MapUpdate SomeUpdate() {
  MapLog log(0xFEDCBA9876543210ULL, 0.05);
  std::vector<VoxelChange> changes;
  for (std::int32_t k = -40; k < 40; ++k) changes.push_back({{k, -k, k / 3}, 0.1F * static_cast<float>(k)});
  changes.push_back({{0, 0, 0}, OccupancyGrid::kUnknown});
  MeasuredShares measured;
  for (std::size_t k = 0; k < measured.of_255.size(); ++k)
    measured.of_255[k] = static_cast<std::uint8_t>(4 * k);
  log.Add(kStamp, {.T_WC = PoseAt(1.5), .measured = measured}, changes);
  return log.TakeUpdate();
}

void ExpectHeader(const json& line, const char* frame) {
  EXPECT_EQ(line["sec"], 1234);
  EXPECT_EQ(line["nanosec"], 567'890'123);
  EXPECT_EQ(line["frame"], frame);
}

void ExpectPose(const json& line, const geometry_msgs::msg::Pose& pose) {
  const std::vector<double> expected = {
      pose.position().x(),    pose.position().y(),    pose.position().z(),   pose.orientation().x(),
      pose.orientation().y(), pose.orientation().z(), pose.orientation().w()};
  EXPECT_EQ(line.get<std::vector<double>>(), expected);
}

void ExpectCloud(const json& line, const sensor_msgs::msg::PointCloud2& cloud) {
  ExpectHeader(line, kCameraFrame);
  EXPECT_EQ(line["height"], cloud.height());
  EXPECT_EQ(line["width"], cloud.width());
  EXPECT_EQ(line["fields"], json::parse(R"([["x",0,7,1],["y",4,7,1],["z",8,7,1],["rgb",12,7,1]])"));
  EXPECT_EQ(line["is_bigendian"], 0);
  EXPECT_EQ(line["is_dense"], 0);
  EXPECT_EQ(line["point_step"], cloud.point_step());
  EXPECT_EQ(line["row_step"], cloud.row_step());
  EXPECT_EQ(line["bytes"], cloud.data().size());
  EXPECT_EQ(line["fnv1a"], Fnv1a(kFnvStart, cloud.data().data(), cloud.data().size()));
}

/// A camera's image that is larger than one UDP datagram.
sensor_msgs::msg::Image LargeImage() {
  std::mt19937 random(2);
  std::vector<std::uint8_t> bytes(640 * 480);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return ToIdl(kStamp, kCameraFrame, 640, 480, "mono8", std::move(bytes));
}

/// Depths in meters, as a robot with a depth camera publishes them, with a row that is padded.
sensor_msgs::msg::Image DepthMessage() {
  sensor_msgs::msg::Image image;
  image.header(MakeHeader(kStamp, kCameraFrame));
  image.width(100);
  image.height(80);
  image.encoding("32FC1");
  image.step(4 * image.width() + 8);
  std::mt19937 random(3);
  image.data().resize(std::size_t{image.step()} * image.height());
  for (std::uint8_t& byte : image.data()) byte = static_cast<std::uint8_t>(random());
  return image;
}

void ExpectImage(const json& line, const sensor_msgs::msg::Image& image) {
  ExpectHeader(line, kCameraFrame);
  EXPECT_EQ(line["height"], image.height());
  EXPECT_EQ(line["width"], image.width());
  EXPECT_EQ(line["encoding"], image.encoding());
  EXPECT_EQ(line["is_bigendian"], 0);
  EXPECT_EQ(line["step"], image.step());
  EXPECT_EQ(line["bytes"], image.data().size());
  EXPECT_EQ(line["fnv1a"], Fnv1a(kFnvStart, image.data().data(), image.data().size()));
}

void ExpectCamera(const json& line, const sensor_msgs::msg::CameraInfo& info) {
  ExpectHeader(line, kCameraFrame);
  EXPECT_EQ(line["height"], info.height());
  EXPECT_EQ(line["width"], info.width());
  EXPECT_EQ(line["model"], "plumb_bob");
  EXPECT_EQ(line["d"], 5);
  EXPECT_EQ(line["p"].get<std::vector<double>>(), std::vector<double>(info.p().begin(), info.p().end()));
}

void ExpectOdometry(const json& line, const nav_msgs::msg::Odometry& odometry) {
  ExpectHeader(line, kOdometryFrame);
  EXPECT_EQ(line["child"], kBodyFrame);
  ExpectPose(line["pose"], odometry.pose().pose());
  EXPECT_EQ(line["twist"].get<std::vector<double>>(), (std::vector<double>{0.5, 0.25, 0.125, -1, -2, -3}));
}

void ExpectPath(const json& line, const nav_msgs::msg::Path& path) {
  ExpectHeader(line, kMapFrame);
  ASSERT_EQ(line["poses"].size(), path.poses().size());
  for (std::size_t k = 0; k < path.poses().size(); ++k) {
    EXPECT_EQ(line["poses"][k]["frame"], kMapFrame);
    ExpectPose(line["poses"][k]["pose"], path.poses()[k].pose());
  }
}

void ExpectUpdate(const json& line, const thalweg_msgs::msg::MapUpdate& update) {
  ExpectHeader(line, kMapFrame);
  EXPECT_EQ(line["session"], update.session());
  EXPECT_EQ(line["number"], update.number());
  EXPECT_EQ(line["full"], 0);
  EXPECT_EQ(line["voxel_size_m"], 0.05);
  ASSERT_EQ(line["scans"].size(), 1U);
  EXPECT_EQ(line["scans"][0]["sec"], 1234);
  ExpectPose(line["scans"][0]["pose"], update.scans()[0].map_from_camera());
  const std::vector<std::uint8_t>& measured = update.scans()[0].measured();
  EXPECT_EQ(line["scans"][0]["measured"], 64);
  EXPECT_EQ(line["scans"][0]["fnv1a"], Fnv1a(kFnvStart, measured.data(), measured.size()));
  EXPECT_EQ(line["blocks"], update.blocks().size());
  std::uint64_t hash = kFnvStart;
  for (const thalweg_msgs::msg::MapBlock& block : update.blocks()) {
    hash = Fnv1a(hash, block.mask().data(), block.mask().size());
    hash = Fnv1a(hash, block.log_odds().data(), block.log_odds().size() * sizeof(float));
  }
  EXPECT_EQ(line["fnv1a"], hash);
  for (std::size_t k = 0; k < line["first_blocks"].size(); ++k) {
    const thalweg_msgs::msg::MapBlock& block = update.blocks()[k];
    EXPECT_EQ(line["first_blocks"][k]["index"], (json{block.x(), block.y(), block.z()}));
    EXPECT_EQ(line["first_blocks"][k]["voxels"], block.log_odds().size());
  }
}

visualization_msgs::msg::MarkerArray SomeMarkers() {
  visualization_msgs::msg::Marker marker;
  marker.header(MakeHeader(kStamp, kMapFrame));
  marker.ns("frontiers");
  marker.id(7);
  marker.pose(ToIdl(PoseAt(1.0)));
  marker.text("out of reach");
  marker.points().resize(2);
  marker.colors().resize(2);
  visualization_msgs::msg::MarkerArray array;
  array.markers() = {marker, marker};
  return array;
}

void ExpectMarkers(const json& line) {
  ASSERT_EQ(line["markers"].size(), 2U);
  for (const json& marker : line["markers"]) {
    EXPECT_EQ(marker["frame"], kMapFrame);
    EXPECT_EQ(marker["ns"], "frontiers");
    EXPECT_EQ(marker["id"], 7);
    EXPECT_EQ(marker["text"], "out of reach");
    ExpectPose(marker["pose"], ToIdl(PoseAt(1.0)));
  }
}

TEST(OtherVendor, CycloneInCReadsWhatRviz2DrawsAndMapUpdates) {
  const BusOptions options = test::BusOptionsForTest("robot");
  Bus bus(options);
  const auto cloud_out = bus.Advertise<topics::DepthPoints>();
  const auto image_out = bus.Advertise<topics::LeftImage>();
  const auto camera_out = bus.Advertise<topics::LeftCameraInfo>();
  const auto depth_out = bus.Advertise<topics::DepthImage>();
  const auto odometry_out = bus.Advertise<topics::Odometry>();
  const auto path_out = bus.Advertise<topics::Path>();
  const auto update_out = bus.Advertise<topics::MapUpdates>();
  const sensor_msgs::msg::PointCloud2 cloud = ToIdl(kStamp, LargeCloud());
  const sensor_msgs::msg::Image image = LargeImage();
  const sensor_msgs::msg::CameraInfo camera =
      ToIdl(kStamp, PinholeCamera::FromFieldOfView(640, 480, 75.0 * kDegree), 0.12);
  const sensor_msgs::msg::Image depth = DepthMessage();
  const nav_msgs::msg::Odometry odometry =
      OdometryToIdl(kStamp, PoseAt(0.7), {0.5, 0.25, 0.125}, {-1, -2, -3});
  const nav_msgs::msg::Path path = ToIdl(StampedPath{.stamp = kStamp, .T_WBs = {PoseAt(1.0), PoseAt(2.0)}});
  const thalweg_msgs::msg::MapUpdate update = SomeUpdate();
  const sensor_msgs::msg::PointCloud2 occupied =
      ToIdl(kStamp, std::vector<ColoredPoint>(1000, {{1, 2, 3}, {10, 20, 30}}));
  // Written once, before anybody listens.
  bus.Advertise<topics::StaticTransforms>().Write(StaticTransformsToIdl(kStamp, PoseAt(0.1)));
  bus.Advertise<topics::OccupiedPoints>().Write(occupied);
  bus.Advertise<topics::FrontierMarkers>().Write(SomeMarkers());

  CycloneListener listener(options);
  std::map<std::string, int> come;
  bool listener_ended = false;
  std::jthread reading([&] {
    for (std::string text = listener.ReadLine(); !text.empty(); text = listener.ReadLine()) {
      bus.Post([&, text] {
        const json line = json::parse(text);
        ++come[line["topic"]];
        if (line["topic"] == topics::DepthPoints::kName) ExpectCloud(line, cloud);
        if (line["topic"] == topics::LeftImage::kName) ExpectImage(line, image);
        if (line["topic"] == topics::LeftCameraInfo::kName) ExpectCamera(line, camera);
        if (line["topic"] == topics::DepthImage::kName) ExpectImage(line, depth);
        if (line["topic"] == topics::Odometry::kName) ExpectOdometry(line, odometry);
        if (line["topic"] == topics::Path::kName) ExpectPath(line, path);
        if (line["topic"] == topics::MapUpdates::kName) ExpectUpdate(line, update);
        if (line["topic"] == topics::FrontierMarkers::kName) ExpectMarkers(line);
        if (line["topic"] == topics::OccupiedPoints::kName) {
          ExpectHeader(line, kMapFrame);
          EXPECT_EQ(line["width"], 1000);
          EXPECT_EQ(line["fnv1a"], Fnv1a(kFnvStart, occupied.data().data(), occupied.data().size()));
        }
        if (line["topic"] == topics::StaticTransforms::kName) {
          EXPECT_EQ(line["transforms"], json::array({json::array({kMapFrame, kOdometryFrame}),
                                                     json::array({kBodyFrame, kCameraFrame})}));
        }
      });
    }
    bus.Post([&] { listener_ended = true; });
  });
  bus.EveryWall(std::chrono::milliseconds(50), [&] {
    cloud_out.Write(cloud);
    image_out.Write(image);
    camera_out.Write(camera);
    depth_out.Write(depth);
    odometry_out.Write(odometry);
    path_out.Write(path);
    update_out.Write(update);
  });
  ASSERT_TRUE(bus.SpinUntil([&] { return listener_ended; }, std::chrono::seconds(50)));
  EXPECT_EQ(listener.Close(), 0);
  EXPECT_EQ(come.size(), 10U);
  for (const auto* topic :
       {topics::DepthPoints::kName, topics::LeftImage::kName, topics::LeftCameraInfo::kName,
        topics::DepthImage::kName, topics::Odometry::kName, topics::Path::kName, topics::MapUpdates::kName}) {
    EXPECT_GE(come[topic], kCount) << topic;
  }
}

}  // namespace
}  // namespace thalweg::dds
