#include "common/files/ply.h"

#include <fmt/format.h>

#include "common/base/append_raw.h"

namespace thalweg {
std::string PlyOf(const PointCloud& cloud) {
  const bool has_colors = !cloud.colors.empty();
  std::string points;
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.points_C.size(); ++i) {
    if (!cloud.points_C[i].allFinite()) continue;
    ++count;
    for (const float value : cloud.points_C[i]) AppendRaw(points, value);
    if (!has_colors) continue;
    const auto [r, g, b] = cloud.colors[i];
    for (const std::uint8_t channel : {r, g, b}) AppendRaw(points, channel);
  }
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
             "property float x\nproperty float y\nproperty float z\n{}end_header\n",
             count, has_colors ? kPlyColors : "") +
         points;
}

}  // namespace thalweg
