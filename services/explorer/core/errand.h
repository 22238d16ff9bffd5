#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// Something that an operator sends the robot to do.
struct Errand {
  enum class Kind : std::uint8_t {
    kGoTo,  ///< Go to the point.
    /// See the point, from here or from a place as near to it as possible; where nothing sees it, the
    /// frontier within 0.5 m that unknown space connects with it.
    kLookAt,
  };
  Kind kind = Kind::kGoTo;
  Eigen::Vector3d p_W{0, 0, 0};   ///< [m]
  std::optional<double> yaw_W{};  ///< [rad] Heading at the end of the path; empty = that of the path's end.
};

/// How to carry out an errand.
struct ErrandPath {
  std::vector<Eigen::Vector3d> path_W;  ///< [m] From the robot, voxel by voxel; one point = turn on the spot.
  Eigen::Matrix3d R_WB;                 ///< Orientation at its end.
};

struct ErrandOptions {
  double robot_radius;    ///< [m]
  double exemption;       ///< [m] See PathSearch::StartAt.
  double wide_exemption;  ///< [m] Used when no path leads there with the other.
  double sensor_range;    ///< [m] Farther away nothing is looked at.
};

/// Finds the shortest path on which the errand can be carried out. Error: the goal is not in known free
/// space, the body does not fit there, no known path leads there, or no reachable place sees the point nor a
/// frontier beside it.
Result<ErrandPath> FindErrandPath(const Errand& errand, const RigidTransform& T_WB,
                                  const Knowledge& knowledge, const GoalFinder& goal_finder,
                                  const ErrandOptions& options);

}  // namespace thalweg::explorer
