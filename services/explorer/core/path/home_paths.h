#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// The paths back to the robot's start, and their cost.
/// Threading: one thread owns it.
class HomePaths {
 public:
  struct Options {
    double margin = 0.15;  ///< Share of the length, for what a real path adds to the shortest one.
    double reserve = 0.5;  ///< [m] Added to every path.
    double robot_radius = RobotModel{}.radius;         ///< [m]
    double exemption = PathSearch::Exemption{}.reach;  ///< [m] See PathSearch::StartAt.
    double wide_exemption = 1.0;  ///< [m] Used when most places have no path home with the other.
    double max_speed = RobotModel{}.max_speed;          ///< [m/s]
    double max_turn_rate = RobotModel{}.max_turn_rate;  ///< [rad/s]
  };
  explicit HomePaths(const Options& options) : options_(options) {}

  /// @param home_W  [m] Position to return to.
  void SetOut(const Eigen::Vector3d& home_W) { home_W_ = home_W; }
  const std::optional<Eigen::Vector3d>& home_W() const { return home_W_; }
  /// Finds the paths from everywhere; SetOut must come first.
  /// @param robot_W  [m] A position from which there should be a path.
  void Find(const PlanningMap& map, const Eigen::Vector3d& robot_W);

  /// Forgets the paths, because the map was replaced; the home stays.
  void Forget() { search_ = {}; }
  /// Costs of the paths home from everywhere, by the last Find; see PathSearch.
  const DenseGrid<std::uint32_t>& costs() const { return search_.costs(); }

  /// [m] Length of the shortest path found by the last Find; empty when there is none.
  std::optional<double> LengthFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const;
  /// [m] The path, from p_W to home, voxel by voxel; empty when there is none.
  std::vector<Eigen::Vector3d> PathFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const;
  /// [m] Distance that the budget must leave for a path of this length.
  double Needed(double length) const { return (1.0 + options_.margin) * length + options_.reserve; }
  /// Time needed to travel that length after a turn.
  Duration TimeFor(double length) const;

 private:
  struct Exit {
    VoxelIndex voxel;     ///< Reached from home.
    double length = 0.0;  ///< [m] From the position via the voxel to home.
  };
  std::optional<Exit> ExitFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const;

  Options options_;
  std::optional<Eigen::Vector3d> home_W_;
  PathSearch search_;                ///< Flooded from home.
  PathSearch::Exemption exemption_;  ///< What the last Find used.
};

}  // namespace thalweg::explorer
