#include "services/inspector/core/one_line.h"

#include <gtest/gtest.h>

#include "services/inspector/core/yaml.h"
#include "tests/services/inspector/core/known_schema.h"

namespace thalweg::inspector {
namespace {

std::string Line(const std::string& type, const std::string& yaml) {
  const Schema schema = SchemaOf(type);
  return ToLine(schema, schema.root(), *ParseYaml(schema, yaml, {}));
}

TEST(OneLine, AnOdometryIsAPlaceAndAHeading) {
  EXPECT_EQ(Line("nav_msgs/msg/Odometry",
                 "{header: {stamp: {sec: 12, nanosec: 345000000}, frame_id: odom}, child_frame_id: base_link,"
                 " pose: {pose: {position: {x: 1.25, y: -0.5}, orientation: {z: 0.7071067811865476,"
                 " w: 0.7071067811865476}}}}"),
            "12.345 odom  child_frame_id=base_link  pose.position=(1.25, -0.5, 0)  "
            "pose.orientation=yaw 90 deg  pose.covariance=[36 float64]  twist.linear=(0, 0, 0)  "
            "twist.angular=(0, 0, 0)  twist.covariance=[36 float64]");
}

TEST(OneLine, StatesAreNamedListsCountedAndEmptyTextsLeftOut) {
  EXPECT_EQ(
      Line("thalweg_msgs/msg/FrontierList", "{header: {frame_id: map}, frontiers: [{}, {}, {}, {}, {}]}"),
      "0.000 map  frontiers=[5 Frontier]");
  EXPECT_EQ(Line("thalweg_msgs/msg/Frontier", "{center: {x: .nan}, fate: FRONTIER_CHOSEN, doubtful: true}"),
            "center=(nan, 0, 0)  voxels=0  path_length_m=0  score=0  fate=CHOSEN  reason=NONE  doubtful=yes");
  EXPECT_EQ(Line("thalweg_msgs/msg/Counter", "{name: \"a\\nb\"}"), "name=\"a b\"  count=0");
  EXPECT_EQ(Line("thalweg_msgs/msg/Frontier", "{fate: 9}").find("fate=9") != std::string::npos, true);
}

TEST(OneLine, FewMessagesOfAListAreShownWhereTheyAreShort) {
  const std::string link = "{header: {frame_id: map}, child_frame_id: odom}";
  EXPECT_EQ(Line("tf2_msgs/msg/TFMessage", "{transforms: [" + link + ", " + link + "]}"),
            "transforms=[0.000 map  child_frame_id=odom  transform.translation=(0, 0, 0)  "
            "transform.rotation=yaw 0 deg; 0.000 map  child_frame_id=odom  transform.translation=(0, 0, 0)  "
            "transform.rotation=yaw 0 deg]");
  const std::string text(100, 'x');
  std::string lines;
  for (int k = 0; k < 4; ++k) lines += (k == 0 ? "" : ", ") + ("{name: " + text + "}");
  EXPECT_EQ(Line("thalweg_msgs/msg/ServiceHealth", "{dropped: [" + lines + "]}").find("x"),
            std::string::npos);
}

TEST(OneLine, AnOrientationThatTiltsHasAllItsAngles) {
  EXPECT_EQ(Line("geometry_msgs/msg/Pose", "{orientation: {x: 0.7071067811865476, w: 0.7071067811865476}}"),
            "position=(0, 0, 0)  orientation=roll 90 pitch 0 yaw 0 deg");
}

TEST(OneLine, CsvHoldsEachValueAndQuotesWhatNeedsIt) {
  const Schema schema = SchemaOf("thalweg_msgs/msg/Counter");
  const auto value = ParseYaml(schema, "{name: 'too \"small\", far', count: 2, last: near}", {});
  ASSERT_TRUE(value);
  EXPECT_EQ(ToCsv(schema, schema.root(), *value, Arrays::kWhole), "\"too \"\"small\"\", far\",2,near");
  const Schema pose = SchemaOf("geometry_msgs/msg/Point");
  EXPECT_EQ(ToCsv(pose, pose.root(), *ParseYaml(pose, "{x: .nan, y: -.inf, z: 1}", {}), Arrays::kWhole),
            "nan,-inf,1.0");
}

TEST(OneLine, ARowOfCsvHasWholeArraysOrNone) {
  const Schema cloud = SchemaOf("sensor_msgs/msg/PointCloud2");
  std::string data;
  for (int k = 0; k < 1000; ++k) data += (k == 0 ? "" : ", ") + std::to_string(k % 250);
  const auto value = ParseYaml(cloud, "{data: [" + data + "]}", {});
  ASSERT_TRUE(value);
  const std::string whole = ToCsv(cloud, cloud.root(), *value, Arrays::kWhole);
  EXPECT_EQ(std::count(whole.begin(), whole.end(), ','), 3 + 5 + 1000 + 1 - 1)
      << "header, sizes, data, is_dense";
  EXPECT_TRUE(whole.ends_with(",248,249,False")) << whole;
  EXPECT_EQ(ToCsv(cloud, cloud.root(), *value, Arrays::kLeftOut), "0,0,,0,0,False,0,0,False");
}

}  // namespace
}  // namespace thalweg::inspector
