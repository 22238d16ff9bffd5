#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/geometry/rigid_transform.h"

namespace thalweg::cli {

/// Two paths of the same camera in one frame; true_path is empty if unknown.
struct TrajectoryPicture {
  std::string title;
  std::vector<std::string> lines;  ///< Lines of text under the title.
  std::vector<Eigen::Vector3d> path;
  std::vector<Eigen::Vector3d> true_path;
};

/// Draws the two paths to scale, seen along the axis in which they extend least, the true one below the
/// other.
cv::Mat Draw(const TrajectoryPicture& picture);

}  // namespace thalweg::cli
