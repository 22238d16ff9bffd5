#include "services/surface/adapter/mesh_ply.h"

#include <fmt/format.h>

#include "common/base/append_raw.h"
#include "common/files/ply.h"

namespace thalweg::surface {
std::string PlyOf(const TriangleMesh& mesh) {
  constexpr std::size_t kVertexBytes = 6 * sizeof(float) + 3;
  constexpr std::size_t kFaceBytes = 1 + 3 * sizeof(std::int32_t);
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment meters in the frame map\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "{}element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices_W.size(), kPlyColors, mesh.faces.size());
  bytes.reserve(bytes.size() + kVertexBytes * mesh.vertices_W.size() + kFaceBytes * mesh.faces.size());
  for (std::size_t i = 0; i < mesh.vertices_W.size(); ++i) {
    for (const float coordinate : mesh.vertices_W[i]) AppendRaw(bytes, coordinate);
    for (const float coordinate : mesh.normals_W[i]) AppendRaw(bytes, coordinate);
    const auto [r, g, b] = mesh.colors[i];
    for (const std::uint8_t channel : {r, g, b}) AppendRaw(bytes, channel);
  }
  for (const auto& face : mesh.faces) {
    AppendRaw(bytes, std::uint8_t{3});
    for (const std::uint32_t vertex : face) AppendRaw(bytes, static_cast<std::int32_t>(vertex));
  }
  return bytes;
}

}  // namespace thalweg::surface
