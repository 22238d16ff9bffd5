#include "common/files/ply.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

namespace thalweg {
namespace {

using testing::HasSubstr;
using testing::Not;

PointCloud CloudOfThree() {
  PointCloud cloud;
  cloud.width_px = 3;
  cloud.height_px = 1;
  cloud.points_C = {{1, 2, 3}, {NAN, 0, 0}, NoReturn()};
  return cloud;
}

std::string PointsIn(const std::string& ply) {
  return ply.substr(ply.find("end_header\n") + 11);
}

TEST(Ply, HasThePointsThatAreFinite) {
  const std::string ply = PlyOf(CloudOfThree());
  EXPECT_THAT(ply, HasSubstr("element vertex 1\n"));
  EXPECT_THAT(ply, Not(HasSubstr("red")));
  const std::string points = PointsIn(ply);
  ASSERT_EQ(points.size(), 12U);
  float z = 0.0F;
  std::memcpy(&z, points.data() + 8, 4);
  EXPECT_EQ(z, 3.0F);
}

TEST(Ply, HasColorsIfTheCloudHasThem) {
  PointCloud cloud = CloudOfThree();
  cloud.colors = {{10, 20, 30}, {}, {}};
  const std::string ply = PlyOf(cloud);
  EXPECT_THAT(ply, HasSubstr("property uchar red\nproperty uchar green\nproperty uchar blue\n"));
  EXPECT_EQ(PointsIn(ply).substr(12), "\x0a\x14\x1e");
}

}  // namespace
}  // namespace thalweg
