#include "services/surface/evaluation/graph_ply.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/append_raw.h"
#include "common/files/ply.h"
#include "services/surface/evaluation/picture.h"

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;
using Edge = SurfaceGraph::Edge;

void AppendColor(std::string& bytes, const Rgb& color) {
  for (const std::uint8_t channel : {color.r, color.g, color.b}) AppendRaw(bytes, channel);
}

std::string Heading(const std::string& elements) {
  return "ply\nformat binary_little_endian 1.0\n" + elements + "end_header\n";
}

std::string VertexElement(std::size_t count) {
  return fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n{}", count,
                     kPlyColors);
}

std::string Vertices(const Surface& surface, std::size_t count) {
  const std::vector<Rgb> colors = VertexColors(surface);
  std::string bytes;
  bytes.reserve(count * 15);
  for (Vertex vertex = 0; vertex < count; ++vertex) {
    for (const float coordinate : surface.graph().Position(vertex)) AppendRaw(bytes, coordinate);
    AppendColor(bytes, colors[vertex]);
  }
  return bytes;
}

}  // namespace

std::string GraphPly(const Surface& surface) {
  const SurfaceGraph& graph = surface.graph();
  std::string edges;
  edges.reserve(graph.edge_count() * 11);
  for (Edge edge = 0; edge < graph.edge_numbers(); ++edge) {
    if (!graph.Exists(edge)) continue;
    for (const int side : {0, 1}) AppendRaw(edges, static_cast<std::int32_t>(graph.End(edge, side)));
    AppendColor(edges, WeightColor(graph.Weight(edge), surface.options().rift_edge));
  }
  return Heading(VertexElement(graph.vertex_count()) +
                 fmt::format("element edge {}\nproperty int vertex1\nproperty int vertex2\n{}",
                             graph.edge_count(), kPlyColors)) +
         Vertices(surface, graph.vertex_count()) + edges;
}

std::string MeshPly(const Surface& surface) {
  std::string faces;
  std::size_t count = 0;
  surface.ForEachCell([&](const Vertex(&corners)[4]) {
    const auto position = [&](int k) -> Eigen::Vector3d {
      return surface.graph().Position(corners[k]).template cast<double>();
    };
    for (const int k : {1, 2}) {
      Vertex face[3] = {corners[0], corners[k], corners[k + 1]};
      if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;  // merged corners
      const Eigen::Vector3d normal = (position(k) - position(0)).cross(position(k + 1) - position(0));
      const Eigen::Vector3d camera_W = surface.CameraOf(*std::max_element(face, face + 3));
      if (normal.dot(camera_W - position(0)) < 0.0) std::swap(face[1], face[2]);
      AppendRaw(faces, std::uint8_t{3});
      for (const Vertex vertex : face) AppendRaw(faces, static_cast<std::int32_t>(vertex));
      ++count;
    }
  });
  return Heading(VertexElement(surface.vertex_count()) +
                 fmt::format("element face {}\nproperty list uchar int vertex_indices\n", count)) +
         Vertices(surface, surface.vertex_count()) + faces;
}

}  // namespace thalweg::surface
