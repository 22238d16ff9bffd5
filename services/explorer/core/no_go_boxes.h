#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// The boxes that the robot stays out of: those of the scenario, and those that an operator draws while the
/// robot explores. A drawn box in which the robot stands is not in the map until the robot has left it, since
/// no path would lead out of it otherwise.
/// Threading: one thread owns them.
class NoGoBoxes {
 public:
  static constexpr std::size_t kMostDrawn = 64;

  struct Options {
    std::vector<Eigen::AlignedBox3d> fixed;  ///< [m] Always in the map.
    double robot_radius;                     ///< [m]
    double exemption;                        ///< [m] See PathSearch::StartAt.
    double wide_exemption;                   ///< [m] Used when no path leads out with the other.
  };
  explicit NoGoBoxes(const Options& options) : options_(options) {}

  /// Puts all boxes into the map, except for drawn ones that the robot at `p_W` still has to leave.
  void PutUp(const Eigen::Vector3d& p_W, Knowledge& knowledge);

  /// Puts all boxes into the map, even around the robot.
  void PutUpAll(Knowledge& knowledge) const;
  /// Whether a body at `p_W` would touch a drawn box.
  bool DrawnTouch(const PlanningMap& map, const Eigen::Vector3d& p_W) const;

  /// Adds a drawn box, or removes the one that was added last; in force once they are put up.
  void Draw(const Eigen::AlignedBox3d& box_W) { drawn_.push_back(box_W); }
  void Undraw() { drawn_.pop_back(); }
  /// Removes all drawn boxes, from the map, too.
  void ClearDrawn(Knowledge& knowledge);
  /// Takes over the drawn boxes of another.
  void TakeOverFrom(const NoGoBoxes& other) { drawn_ = other.drawn_; }
  const std::vector<Eigen::AlignedBox3d>& drawn() const { return drawn_; }

  /// Whether the robot has yet to leave a box.
  bool robot_inside() const { return !lifted_.empty(); }
  /// Whether a body in a voxel would reach into a box that the robot has yet to leave.
  bool ReachIntoLifted(const PlanningMap& map, const VoxelIndex& i) const;
  /// The shortest path out of the boxes that the robot has yet to leave [m]; empty when there is none.
  /// @param may_end  Whether the path may end in a voxel that lies outside the boxes.
  std::vector<Eigen::Vector3d> PathOut(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                       const std::function<bool(const VoxelIndex&)>& may_end) const;

 private:
  Options options_;
  std::vector<Eigen::AlignedBox3d> drawn_;   ///< [m]
  std::vector<Eigen::AlignedBox3d> lifted_;  ///< [m] Those of them that the robot has yet to leave.
};

}  // namespace thalweg::explorer
