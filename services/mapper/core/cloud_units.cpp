#include "services/mapper/core/cloud_units.h"

#include <cstddef>

namespace thalweg::mapper {

bool IsOfOtherUnits(const PointCloud& cloud, double max_range) {
  constexpr std::size_t kFewest = 10;  // of which a share says something
  constexpr double kShare = 0.9;
  const auto farthest = static_cast<float>(FarthestPlausible(max_range));
  std::size_t measured = 0;
  std::size_t beyond = 0;
  for (const Eigen::Vector3f& p_C : cloud.points_C) {
    if (!p_C.allFinite()) continue;
    ++measured;
    beyond += p_C.norm() > farthest ? 1 : 0;
  }
  return measured >= kFewest && static_cast<double>(beyond) > kShare * static_cast<double>(measured);
}

}  // namespace thalweg::mapper
