#include "common/geometry/point_text.h"

#include <array>
#include <cstdio>

namespace thalweg {

std::string PointText(const Eigen::Vector3d& p) {
  std::array<char, 1024> text{};  // the largest numbers have more than 300 digits
  std::snprintf(text.data(), text.size(), "(%.2f, %.2f, %.2f)", p.x(), p.y(), p.z());
  return text.data();
}

}  // namespace thalweg
