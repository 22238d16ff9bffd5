#include "services/surface/evaluation/mesh_picture.h"

#include <gtest/gtest.h>

namespace thalweg::surface {
namespace {

/// A square of 1 m in a plane of constant height. @param up  Whether it faces the sky.
void AddSquare(float z, const Rgb& color, bool up, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_W.size());
  for (const auto& [x, y] : {std::pair(0.0F, 0.0F), {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
    mesh.vertices_W.emplace_back(x, y, z);
    mesh.normals_W.emplace_back(0.0F, 0.0F, up ? 1.0F : -1.0F);
    mesh.colors.push_back(color);
  }
  if (up) {
    mesh.faces.push_back({first, first + 1, first + 2});
    mesh.faces.push_back({first, first + 2, first + 3});
  } else {
    mesh.faces.push_back({first, first + 2, first + 1});
    mesh.faces.push_back({first, first + 3, first + 2});
  }
}

TEST(DrawMesh, ShowsTheFloorThroughTheCeilingAndATableBeforeTheFloor) {
  TriangleMesh mesh;
  AddSquare(0.0F, {200, 0, 0}, true, mesh);   // floor
  AddSquare(0.6F, {0, 0, 200}, false, mesh);  // ceiling, which is seen from its back
  const cv::Mat_<cv::Vec3b> room = DrawMesh(mesh);
  std::size_t red = 0;
  std::size_t blue = 0;
  for (const cv::Vec3b& pixel : room) {
    red += pixel[2] > 100 && pixel[0] < 50 ? 1U : 0U;
    blue += pixel[0] > 100 && pixel[2] < 50 ? 1U : 0U;
  }
  EXPECT_GT(red, room.total() / 10);
  EXPECT_EQ(blue, 0U);
  AddSquare(0.3F, {0, 200, 0}, true, mesh);  // a table top over all of the floor
  std::size_t green = 0;
  std::size_t red_below = 0;
  for (const cv::Vec3b& pixel : cv::Mat_<cv::Vec3b>(DrawMesh(mesh))) {
    green += pixel[1] > 100 && pixel[2] < 50 ? 1U : 0U;
    red_below += pixel[2] > 100 && pixel[1] < 50 ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(green), static_cast<double>(red), 0.01 * static_cast<double>(red))
      << "all of it";
  EXPECT_LT(red_below, red) << "partly hidden";
}

TEST(DrawMesh, AnEmptyMeshIsWhitePaper) {
  const cv::Mat_<cv::Vec3b> picture = DrawMesh({});
  EXPECT_EQ(picture.rows, 900);
  for (const cv::Vec3b& pixel : picture) ASSERT_EQ(pixel, cv::Vec3b(255, 255, 255));
}

}  // namespace
}  // namespace thalweg::surface
