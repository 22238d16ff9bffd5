#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/time.h"
#include "services/explorer/core/outcome.h"
#include "services/explorer/core/path/home_paths.h"

namespace thalweg::explorer {

/// What the robot was sent for: how far it went and for how long, what its budgets allow, when it must turn
/// back, and whether it is on its way home.
/// Threading: one thread owns it.
class Mission {
 public:
  struct Options {
    Duration time_budget = Duration::zero();  ///< 0 = none
    double distance_budget = 0.0;             ///< [m] 0 = none
    bool return_home = false;                 ///< The budgets then cover the path home, too.
    HomePaths::Options home_paths;
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit Mission(const Options& options);

  /// The robot is there: adds to the distance travelled.
  void Move(const Eigen::Vector3d& p_W);
  double distance() const { return distance_; }  ///< [m]
  /// The clock went back by that much.
  void ShiftTimes(Duration back);

  /// Which budget is used up, if one is. Time counts from the first call.
  std::optional<Budget> Spent(Time now);

  bool returns_home() const { return options_.return_home; }
  /// Finds the paths home from everywhere; the first call is made at home. Does nothing for a robot that need
  /// not return.
  void FindPathsHome(const PlanningMap& map, const Eigen::Vector3d& p_W);
  const HomePaths& home_paths() const { return home_paths_; }
  /// Which budget leaves no more than the path home from there needs, if one does.
  std::optional<Budget> HomeIsDue(const PlanningMap& map, const Eigen::Vector3d& p_W, Time now) const;
  /// Which budget does not allow a path of that length [m] to a place, and home from there.
  std::optional<Budget> TooFar(const PlanningMap& map, double length, const Eigen::Vector3d& end_W,
                               Time now) const;

  /// From now on the robot goes home, since its exploration ended that way.
  void TurnHome(Ending why);
  /// Why the robot is on its way home; nothing when it is not.
  std::optional<Outcome> homeward() const {
    return homeward_ ? std::optional(homeward_->outcome) : std::nullopt;
  }
  /// How a robot that is on its way home ends once it is there; nothing before.
  std::optional<Ending> EndingAtHome(const Eigen::Vector3d& p_W) const;

 private:
  Options options_;
  HomePaths home_paths_;
  std::optional<Time> started_;
  std::optional<Eigen::Vector3d> last_position_W_;
  double distance_ = 0.0;
  std::optional<Ending> homeward_;
};

}  // namespace thalweg::explorer
