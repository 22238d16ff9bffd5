#include "services/surface/adapter/mesh_message.h"

#include <cmath>

namespace thalweg::surface {

thalweg_msgs::msg::SurfaceBlock ToIdl(const VoxelIndex& block, const BlockMesh* mesh,
                                      const InspectionLimits& limits) {
  thalweg_msgs::msg::SurfaceBlock message;
  message.x(block.x);
  message.y(block.y);
  message.z(block.z);
  if (!mesh) return message;
  for (const BlockMesh::Vertex& vertex : mesh->vertices) {
    for (const float coordinate : vertex.p_W) message.points_m().push_back(coordinate);
    for (const float part : vertex.normal_W) {
      message.normals().push_back(static_cast<std::uint8_t>(std::lround((part + 1.0F) * 127.0F)));
    }
    for (const std::uint8_t channel : {vertex.color.r, vertex.color.g, vertex.color.b}) {
      message.colors().push_back(channel);
    }
    const bool fine = vertex.best.seen() && vertex.best.sampling() <= limits.sampling;
    message.views().push_back(static_cast<std::uint8_t>((vertex.best.inspected() ? 1 : 0) | (fine ? 2 : 0)));
  }
  for (const auto& face : mesh->faces)
    message.faces().insert(message.faces().end(), face.begin(), face.end());
  return message;
}

}  // namespace thalweg::surface
