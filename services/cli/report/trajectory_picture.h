#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/geometry/rigid_transform.h"

namespace thalweg::cli {

/// Two paths of the same camera in one frame; true_path is empty when it is not known.
struct TrajectoryPicture {
  std::string title;
  std::vector<std::string> lines;  ///< Of text, under the title.
  std::vector<Eigen::Vector3d> path;
  std::vector<Eigen::Vector3d> true_path;
};

/// The two paths seen along the axis in which they extend least, to scale, the true one under the other.
cv::Mat Draw(const TrajectoryPicture& picture);

}  // namespace thalweg::cli
