#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {

/// The ways back to where the robot set out, and what they cost.
/// Threading: one thread owns it.
class WayHome {
 public:
  struct Options {
    double margin = 0.15;         ///< Of the way's length, added for what a path adds to the shortest one.
    double reserve = 0.5;         ///< [m] Added to every way.
    double robot_radius = 0.1;    ///< [m]
    double exemption = 0.3;       ///< [m] See PathSearch::StartAt.
    double wide_exemption = 1.0;  ///< [m] When with the other most places have no way to home.
    double max_speed = 0.5;       ///< [m/s]
    double max_turn_rate = 1.6;   ///< [rad/s]
  };
  explicit WayHome(const Options& options) : options_(options) {}

  /// @param home_W  [m] Where to come back to.
  void SetOut(const Eigen::Vector3d& home_W) { home_W_ = home_W; }
  const std::optional<Eigen::Vector3d>& home_W() const { return home_W_; }
  /// Finds the ways from everywhere; after SetOut. @param robot_W  [m] From where there must be one.
  void Find(const PlanningMap& map, const Eigen::Vector3d& robot_W);

  /// [m] Of the shortest way by the last Find; nothing where there is none.
  std::optional<double> LengthFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const;
  /// [m] That way, from p_W to home, voxel by voxel; empty where there is none.
  std::vector<Eigen::Vector3d> PathFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const;
  /// [m] That must be left to go a way of that length.
  double Needed(double length) const { return (1.0 + options_.margin) * length + options_.reserve; }
  /// That going so far takes, with a turn before it.
  Duration TimeFor(double length) const;

 private:
  struct Exit {
    VoxelIndex voxel;     ///< Reached from home.
    double length = 0.0;  ///< [m] From the place over it to home.
  };
  std::optional<Exit> ExitFrom(const PlanningMap& map, const Eigen::Vector3d& p_W) const;

  Options options_;
  std::optional<Eigen::Vector3d> home_W_;
  PathSearch search_;                ///< Flooded from home.
  PathSearch::Exemption exemption_;  ///< Of the last Find.
};

}  // namespace thalweg::explorer
