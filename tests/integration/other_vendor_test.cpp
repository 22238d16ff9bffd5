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
  const auto odometry_out = bus.Advertise<topics::Odometry>();
  const auto path_out = bus.Advertise<topics::Path>();
  const auto update_out = bus.Advertise<topics::MapUpdates>();
  const sensor_msgs::msg::PointCloud2 cloud = ToIdl(kStamp, LargeCloud());
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
    odometry_out.Write(odometry);
    path_out.Write(path);
    update_out.Write(update);
  });
  ASSERT_TRUE(bus.SpinUntil([&] { return listener_ended; }, std::chrono::seconds(50)));
  EXPECT_EQ(listener.Close(), 0);
  EXPECT_EQ(come.size(), 7U);
  for (const auto* topic : {topics::DepthPoints::kName, topics::Odometry::kName, topics::Path::kName,
                            topics::MapUpdates::kName}) {
    EXPECT_GE(come[topic], kCount) << topic;
  }
}

}  // namespace
}  // namespace thalweg::dds
