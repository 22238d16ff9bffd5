#include "services/surface/evaluation/graph_ply.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

/// A reader of just this format, which checks that the file ends where it must.
struct Ply {
  explicit Ply(const std::string& bytes) {
    std::istringstream in(bytes);
    std::string word;
    std::size_t edge_count = 0;
    std::size_t face_count = 0;
    std::size_t vertex_count = 0;
    while (in >> word && word != "end_header") {
      if (word != "element") continue;
      std::size_t count = 0;
      in >> word >> count;
      (word == "vertex" ? vertex_count : word == "edge" ? edge_count : face_count) = count;
    }
    at = bytes.data() + static_cast<std::ptrdiff_t>(in.tellg()) + 1;
    for (std::size_t i = 0; i < vertex_count; ++i) {
      vertices.push_back({Take<float>(), Take<float>(), Take<float>()});
      colors.push_back({Take<std::uint8_t>(), Take<std::uint8_t>(), Take<std::uint8_t>()});
    }
    for (std::size_t i = 0; i < edge_count; ++i) {
      edges.push_back({Take<std::int32_t>(), Take<std::int32_t>()});
      edge_colors.push_back({Take<std::uint8_t>(), Take<std::uint8_t>(), Take<std::uint8_t>()});
    }
    for (std::size_t i = 0; i < face_count; ++i) {
      EXPECT_EQ(Take<std::uint8_t>(), 3);
      faces.push_back({Take<std::int32_t>(), Take<std::int32_t>(), Take<std::int32_t>()});
    }
    EXPECT_EQ(at, bytes.data() + bytes.size());
  }
  template <class T>
  T Take() {
    T value;
    std::memcpy(&value, at, sizeof value);
    at += sizeof value;
    return value;
  }
  std::vector<std::array<float, 3>> vertices;
  std::vector<Rgb> colors;
  std::vector<std::array<std::int32_t, 2>> edges;
  std::vector<Rgb> edge_colors;
  std::vector<std::array<std::int32_t, 3>> faces;
  const char* at = nullptr;
};

Surface Step() {
  View view = test::ViewOf(test::Rig(60, 40, 60.0), RigidTransform::Identity(), test::StepAt);
  view.colors.assign(60 * 40, {10, 20, 30});
  Surface surface({});
  surface.Add(std::move(view));
  return surface;
}

TEST(GraphPly, HasEveryVertexAndEdgeOfTheGraph) {
  Surface surface = Step();
  surface.PlanMove();  // adds a rift vertex
  const SurfaceGraph& graph = surface.graph();
  const Ply ply(GraphPly(surface));
  ASSERT_EQ(ply.vertices.size(), graph.vertex_count());
  ASSERT_EQ(ply.edges.size(), graph.edge_count());
  for (std::size_t i = 0; i < ply.vertices.size(); ++i) {
    const auto& [x, y, z] = ply.vertices[i];
    EXPECT_EQ(graph.Position(static_cast<SurfaceGraph::Vertex>(i)), Eigen::Vector3f(x, y, z));
  }
  for (const auto& [a, b] : ply.edges) {
    EXPECT_TRUE(graph.AreNeighbors(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)));
  }
  EXPECT_EQ(ply.colors.front(), (Rgb{10, 20, 30}));
  EXPECT_TRUE(ply.faces.empty());
  // The edges of the rift, and those that join its vertex to it, are 1 m and longer: as red as it gets.
  std::size_t red = 0;
  for (const Rgb& color : ply.edge_colors) red += color.r > 200 && color.g < 40 ? 1U : 0U;
  EXPECT_EQ(red, 40U + 80U);
}

TEST(GraphPly, HasTwoTrianglesForEachCellThatFaceTheCamera) {
  const Surface surface = Step();
  const Ply ply(MeshPly(surface));
  EXPECT_EQ(ply.vertices.size(), 60U * 40U);
  EXPECT_EQ(ply.faces.size(), 2U * (59U * 39U - 39U)) << "none across the rift";
  double area = 0.0;
  for (const auto& face : ply.faces) {
    Eigen::Vector3d p[3];
    for (int k = 0; k < 3; ++k) {
      const auto& [x, y, z] = ply.vertices.at(static_cast<std::size_t>(face[static_cast<std::size_t>(k)]));
      p[k] = Eigen::Vector3d(x, y, z);
    }
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
    EXPECT_LT(normal.z(), 0.0) << "the camera looks along z";
    area += 0.5 * normal.norm();
  }
  EXPECT_NEAR(area, surface.Area(), 1e-6);
}

}  // namespace
}  // namespace thalweg::surface
