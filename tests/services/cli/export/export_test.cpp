#include "services/cli/export/export.h"

#include <gmock/gmock.h>

#include <bit>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "common/dds/schema.h"
#include "services/inspector/core/cdr.h"
#include "services/inspector/core/yaml.h"
#include "services/recorder/core/mcap_writer.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// A recording of messages that are written in YAML, and the folder of its export.
class ExportTest : public testing::Test {
 protected:
  ExportTest() : folder_(fs::path(testing::TempDir()) / fs::path("export-" + Name())) {
    fs::remove_all(folder_);
  }
  ~ExportTest() override { fs::remove_all(folder_); }
  static std::string Name() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }

  std::vector<std::uint8_t> Cdr(const std::string& type, const std::string& yaml) {
    const auto schema = inspector::Schema::Parse(type, dds::Ros2MsgSchema(type));
    const auto value = inspector::ParseYaml(*schema, yaml, Time());
    EXPECT_TRUE(value) << (value ? "" : value.error());
    return inspector::EncodeCdr(*schema, *value);
  }
  void Record(const std::string& topic, const std::string& type, const std::string& yaml) {
    RecordBytes(topic, type, Cdr(type, yaml));
  }
  void RecordBytes(const std::string& topic, const std::string& type, const std::vector<std::uint8_t>& bytes,
                   const std::string& encoding = "cdr") {
    recorder::Channel channel{.topic = topic, .type = type, .schema = std::string(dds::Ros2MsgSchema(type))};
    channel.message_encoding = encoding;
    const Time now{std::chrono::milliseconds(1500 + 100 * sequence_)};
    writer_.Write(writer_.AddChannel(channel), sequence_++, now, now, bytes);
  }
  Exported ExportAll(const recorder::Selection& selection = {}) {
    writer_.Close();
    const auto reader = recorder::McapReader::Open(file_);
    return Export(*reader, selection, folder_);
  }
  std::string Text(const std::string& file) const {
    std::ifstream in(folder_ / file, std::ios::binary);
    EXPECT_TRUE(in) << file;
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }

  fs::path folder_;
  std::vector<std::uint8_t> file_;
  std::uint32_t sequence_ = 0;
  recorder::McapWriter writer_{
      {}, [this](Bytes bytes) { file_.insert(file_.end(), bytes.begin(), bytes.end()); }};
};

TEST_F(ExportTest, PosesBecomeATrajectoryAsEvoReadsIt) {
  for (const int second : {7, 8}) {
    Record("/odometry", "nav_msgs/msg/Odometry",
           "{header: {stamp: {sec: " + std::to_string(second) +
               ", nanosec: 250000000}}, pose: {pose: {position: {x: 1.5, y: -2, z: 0.25},"
               " orientation: {x: 0, y: 0, z: 0.6, w: 0.8}}}}");
  }
  Record("/outside/pose", "geometry_msgs/msg/PoseStamped", "{pose: {orientation: {w: 1}}}");
  const Exported exported = ExportAll();
  ASSERT_EQ(exported.topics.size(), 2U);
  EXPECT_EQ(exported.topics[0].files, "odometry.tum");
  EXPECT_EQ(exported.topics[0].messages, 2U);
  EXPECT_EQ(exported.topics[1].files, "outside_pose.tum");
  std::istringstream lines(Text("odometry.tum"));
  std::string line;
  std::getline(lines, line);
  EXPECT_THAT(line, StartsWith("#"));
  std::vector<double> numbers;
  for (double number = 0.0; lines >> number;) numbers.push_back(number);
  EXPECT_THAT(numbers, ElementsAre(7.25, 1.5, -2, 0.25, 0, 0, 0.6, 0.8, 8.25, 1.5, -2, 0.25, 0, 0, 0.6, 0.8));
}

/// Points of x, y, z and rgb, 16 bytes each, as a list of YAML.
std::string CloudYaml(const std::vector<std::array<float, 3>>& points, std::uint32_t rgb) {
  std::string data;
  for (const auto& [x, y, z] : points) {
    for (const std::uint32_t word : {std::bit_cast<std::uint32_t>(x), std::bit_cast<std::uint32_t>(y),
                                     std::bit_cast<std::uint32_t>(z), rgb}) {
      for (unsigned k = 0; k < 4; ++k) data += std::to_string((word >> 8 * k) & 0xffU) + ", ";
    }
  }
  const std::string count = std::to_string(points.size());
  return "{header: {stamp: {sec: 3}}, height: 1, width: " + count +
         ", fields: [{name: x, offset: 0, datatype: 7, count: 1}, {name: y, offset: 4, datatype: 7, count: "
         "1}, "
         "{name: z, offset: 8, datatype: 7, count: 1}, {name: rgb, offset: 12, datatype: 7, count: 1}], "
         "point_step: 16, row_step: " +
         std::to_string(16 * points.size()) + ", data: [" + data + "]}";
}

TEST_F(ExportTest, CloudsBecomeFilesThatHoldTheirFinitePointsWithColors) {
  Record("/depth/points", "sensor_msgs/msg/PointCloud2",
         CloudYaml({{1, 2, 3}, {NAN, 0, 0}, {0, 0, INFINITY}}, 0x0a141e));
  Record("/depth/points", "sensor_msgs/msg/PointCloud2", CloudYaml({{4, 5, 6}}, 0));
  const Exported exported = ExportAll();
  EXPECT_EQ(exported.topics.at(0).files, "depth_points/*.ply");
  const std::string ply = Text("depth_points/3.000000000.ply");
  EXPECT_THAT(ply, HasSubstr("element vertex 1\n"));
  const std::string points = ply.substr(ply.find("end_header\n") + 11);
  ASSERT_EQ(points.size(), 15U);
  float z = 0.0F;
  std::memcpy(&z, points.data() + 8, 4);
  EXPECT_EQ(z, 3.0F);
  EXPECT_EQ(points.substr(12), "\x0a\x14\x1e");
  EXPECT_TRUE(fs::exists(folder_ / "depth_points/3.000000000_2.ply")) << "of the same stamp";
}

std::string ImageYaml(const std::string& encoding, std::int64_t width, int step, const std::string& data) {
  return "{header: {stamp: {sec: 5, nanosec: 7}}, height: 1, width: " + std::to_string(width) +
         ", encoding: '" + encoding + "', step: " + std::to_string(step) + ", data: [" + data + "]}";
}

TEST_F(ExportTest, ImagesBecomePngsWithAListOfTheirStamps) {
  const std::string type = "sensor_msgs/msg/Image";
  Record("/rgb", type, ImageYaml("rgb8", 2, 8, "1, 2, 3, 4, 5, 6, 0, 0"));
  Record("/gray", type, ImageYaml("mono8", 3, 3, "7, 8, 9"));
  Record("/mm", type, ImageYaml("16UC1", 1, 2, "210, 4"));  // 1234
  // 1.5, NaN, 100 and -1 m
  Record("/m", type,
         ImageYaml("32FC1", 4, 16, "0, 0, 192, 63, 0, 0, 192, 127, 0, 0, 200, 66, 0, 0, 128, 191"));
  EXPECT_EQ(ExportAll().topics.size(), 4U);
  const auto read = [&](const std::string& file) {
    return cv::imread((folder_ / file).string(), cv::IMREAD_UNCHANGED);
  };
  const cv::Mat rgb = read("rgb/5.000000007.png");
  ASSERT_EQ(rgb.type(), CV_8UC3);
  EXPECT_EQ(rgb.at<cv::Vec3b>(0, 1), cv::Vec3b(6, 5, 4)) << "blue, green, red";
  const cv::Mat gray = read("gray/5.000000007.png");
  ASSERT_EQ(gray.type(), CV_8UC1);
  EXPECT_EQ(gray.at<std::uint8_t>(0, 2), 9);
  EXPECT_EQ(read("mm/5.000000007.png").at<std::uint16_t>(0, 0), 1234);
  const cv::Mat depth = read("m/5.000000007.png");
  ASSERT_EQ(depth.type(), CV_16UC1);
  EXPECT_EQ(std::vector<std::uint16_t>(depth.begin<std::uint16_t>(), depth.end<std::uint16_t>()),
            (std::vector<std::uint16_t>{1500, 0, 0, 0}));
  EXPECT_EQ(Text("rgb.txt"), "5.000000007 rgb/5.000000007.png\n");
}

TEST_F(ExportTest, AllElseBecomesLinesOfJson) {
  Record("/health", "thalweg_msgs/msg/ServiceHealth", "{service: mapper, process_id: 12}");
  Record("/image", "stereo_msgs/msg/DisparityImage", "{f: .nan, image: {data: [255, 0]}}");
  ExportAll();
  const json line = json::parse(Text("health.jsonl"));
  EXPECT_EQ(line["log_time"], 1.5);
  EXPECT_EQ(line["message"]["service"], "mapper");
  EXPECT_EQ(line["message"]["process_id"], 12);
  const json image = json::parse(Text("image.jsonl"))["message"];
  EXPECT_TRUE(image["f"].is_null());
  EXPECT_EQ(image["image"]["data"], "/wA=");
}

TEST_F(ExportTest, WhatCannotBeExportedIsCountedWithItsReason) {
  const std::string type = "sensor_msgs/msg/Image";
  Record("/a", type, ImageYaml("yuv422", 1, 2, "1, 2"));
  Record("/a", type, ImageYaml("mono8", 9, 9, "1, 2"));
  Record("/a", type, ImageYaml("mono8", 4'000'000'000, 9, "1, 2"));
  Record("/a", type, ImageYaml("mono8", 1, 1, "1"));
  RecordBytes("/b", "nav_msgs/msg/Odometry", {0, 1, 0, 0, 1});
  Record("/b", "nav_msgs/msg/Odometry", "{pose: {pose: {orientation: {w: 3}}}}");
  RecordBytes("/c", "nav_msgs/msg/Odometry", {1}, "json");
  Record("/d", "sensor_msgs/msg/PointCloud2", "{height: 1, width: 1, point_step: 4, row_step: 4, data: [1]}");
  const Exported exported = ExportAll();
  ASSERT_EQ(exported.topics.size(), 4U);
  EXPECT_EQ(exported.topics[0].messages, 1U);
  EXPECT_EQ(exported.topics[0].left_out, 3U);
  EXPECT_EQ(exported.topics[0].reason, "PNG has no encoding yuv422");
  EXPECT_EQ(exported.topics[1].left_out, 2U);
  EXPECT_EQ(exported.topics[1].messages, 0U);
  EXPECT_EQ(exported.topics[2].left_out, 1U);
  EXPECT_THAT(exported.topics[2].reason, HasSubstr("not CDR"));
  EXPECT_THAT(exported.topics[3].reason, HasSubstr("do not fit"));
}

TEST_F(ExportTest, TopicsWhoseFilesWouldHaveTheSameNamesAreNumbered) {
  const std::string type = "geometry_msgs/msg/PoseStamped";
  for (const auto& [topic, seconds] : {std::pair{"/a/b", 1}, {"/a_b", 2}, {"/a_b_2", 3}, {"/a_b", 4}}) {
    Record(topic, type,
           "{header: {stamp: {sec: " + std::to_string(seconds) + "}}, pose: {orientation: {w: 1}}}");
  }
  const Exported exported = ExportAll();
  std::map<std::string, std::string> files;
  for (const ExportedTopic& topic : exported.topics) files[topic.topic] = topic.files;
  const std::map<std::string, std::string> expected = {
      {"/a/b", "a_b.tum"}, {"/a_b", "a_b_3.tum"}, {"/a_b_2", "a_b_2.tum"}};
  EXPECT_EQ(files, expected) << "no topic loses its own name to a number";
  EXPECT_THAT(Text("a_b.tum"), HasSubstr("\n1.0"));
  EXPECT_THAT(Text("a_b_3.tum"), testing::AllOf(HasSubstr("\n2.0"), HasSubstr("\n4.0")));
}

TEST_F(ExportTest, ATopicOfWhichNothingIsExportedLeavesNoFile) {
  Record("/image", "sensor_msgs/msg/Image", ImageYaml("yuv422", 1, 2, "1, 2"));
  RecordBytes("/odometry", "nav_msgs/msg/Odometry", {0, 1, 0, 0, 1});
  RecordBytes("/health", "thalweg_msgs/msg/Health", {0, 1, 0, 0, 1});
  Record("/pose", "geometry_msgs/msg/PoseStamped", "{pose: {orientation: {w: 1}}}");
  const Exported exported = ExportAll();
  ASSERT_EQ(exported.topics.size(), 4U);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
  EXPECT_THAT(names, ElementsAre("pose.tum"));
  EXPECT_EQ(exported.topics[0].files, "");
  EXPECT_EQ(exported.topics[3].files, "pose.tum");
}

TEST_F(ExportTest, AFieldOfAnotherTypeThanItsNameStandsForLeavesTheMessageOut) {
  recorder::Channel channel{.topic = "/a", .type = "sensor_msgs/msg/PointCloud2", .schema = "string width"};
  writer_.Write(writer_.AddChannel(channel), 0, Time(), Time(),
                std::vector<std::uint8_t>{0, 1, 0, 0, 2, 0, 0, 0, 'a', 0});
  const Exported exported = ExportAll();
  EXPECT_EQ(exported.topics.at(0).left_out, 1U);
  EXPECT_THAT(exported.topics[0].reason, HasSubstr("not of the type"));
}

TEST_F(ExportTest, WhatIsThereIsNotReplaced) {
  Record("/a", "geometry_msgs/msg/PoseStamped", "{pose: {orientation: {w: 1}}}");
  fs::create_directory(folder_);
  std::ofstream(folder_ / "a.tum") << "of another export";
  try {
    ExportAll();
    FAIL() << "replaced";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("a.tum"), HasSubstr("exists")));
  }
  EXPECT_EQ(Text("a.tum"), "of another export");
}

TEST_F(ExportTest, OnlySelectedTopicsAreWritten) {
  Record("/a", "geometry_msgs/msg/PoseStamped", "{pose: {orientation: {w: 1}}}");
  Record("/b", "geometry_msgs/msg/PoseStamped", "{pose: {orientation: {w: 1}}}");
  ASSERT_EQ(ExportAll({.topics = {"b"}}).topics.size(), 1U);
  EXPECT_FALSE(fs::exists(folder_ / "a.tum"));
}

TEST_F(ExportTest, AFolderThatCannotBeWrittenIsNamed) {
  std::ofstream(folder_) << "a file";
  Record("/a", "sensor_msgs/msg/Image", ImageYaml("mono8", 1, 1, "1"));
  try {
    ExportAll();
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder_.filename().string()));
  }
}

}  // namespace
}  // namespace thalweg::cli
