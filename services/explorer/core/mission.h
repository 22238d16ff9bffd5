#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/time.h"
#include "services/explorer/core/outcome.h"
#include "services/explorer/core/path/home_paths.h"
#include "services/explorer/core/saved_exploration.h"

namespace thalweg::explorer {

/// Tracks the robot's mission: distance traveled and time used, what the budgets still allow, when the robot
/// must turn back, and whether it is on its way home.
/// Threading: one thread owns it.
class Mission {
 public:
  struct Options {
    Duration time_budget = Duration::zero();  ///< 0 = none.
    double distance_budget = 0.0;             ///< [m] 0 = none.
    bool return_home = false;                 ///< Budgets then include the path home.
    HomePaths::Options home_paths;
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit Mission(const Options& options);

  /// Updates the robot's position, which adds to the distance traveled, in steps of 5 mm or more.
  void Move(const Eigen::Vector3d& p_W);
  double distance() const { return distance_; }  ///< [m]
  /// Time used of the budget.
  Duration Elapsed(Time now) const { return started_ ? now - *started_ : elapsed_before_; }
  /// Continues the mission of an earlier process.
  void Restore(const SavedExploration& saved);
  /// Adjusts remembered times after the clock jumped back by `back`.
  void ShiftTimes(Duration back);

  /// The budget that is used up, if any. Time counts from the first call.
  std::optional<Budget> Spent(Time now);

  bool returns_home() const { return options_.return_home; }
  /// Finds the paths home from everywhere, for a robot that returns or is on its way; the first call must be
  /// made at home.
  void FindPathsHome(const PlanningMap& map, const Eigen::Vector3d& p_W);
  const HomePaths& home_paths() const { return home_paths_; }
  /// Forgets the paths home, because the map was replaced.
  void ForgetPaths() { home_paths_.Forget(); }
  /// The budget that leaves no more than the path home from `p_W` needs, if any.
  std::optional<Budget> HomeIsDue(const PlanningMap& map, const Eigen::Vector3d& p_W, Time now) const;
  /// The budget that does not allow a path of `length` [m] to `end_W` and the path home from there, if any.
  /// If the map knows no path home from there, that is the way back along the path, and on along the way by
  /// which the robot came since the map knew one from where it was.
  std::optional<Budget> TooFar(const PlanningMap& map, double length, const Eigen::Vector3d& end_W,
                               Time now) const;

  /// Whether the mission ends at home, or the robot is on its way there.
  bool must_return() const { return returns_home() || homeward_; }
  /// Whether the map knows a path home from `p_W`, also for a robot that need not return.
  bool KnowsPathHome(const PlanningMap& map, const Eigen::Vector3d& p_W);
  /// Sends the robot home, because its exploration ended for this reason.
  void TurnHome(Ending why);
  /// Why the robot is on its way home; empty when it is not.
  std::optional<Outcome> homeward() const {
    return homeward_ ? std::optional(homeward_->outcome) : std::nullopt;
  }
  /// The final ending of a robot on its way home, once it is there; empty before.
  std::optional<Ending> EndingAtHome(const Eigen::Vector3d& p_W) const;

 private:
  Options options_;
  HomePaths home_paths_;
  Duration elapsed_before_ = Duration::zero();  ///< In an earlier process.
  std::optional<Time> started_;
  std::optional<Eigen::Vector3d> last_position_W_;
  double distance_ = 0.0;
  /// [m] The path home when the map last knew one, and what the robot has traveled since.
  double way_back_ = 0.0;
  std::optional<Ending> homeward_;
};

}  // namespace thalweg::explorer
