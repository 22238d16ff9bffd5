#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "common/base/time.h"
#include "services/explorer/core/path/way_home.h"

namespace thalweg::explorer {

/// How far the robot went and for how long, what its budgets allow, and when it must turn back.
/// Threading: one thread owns it.
class Journey {
 public:
  struct Options {
    Duration time_budget = Duration::zero();  ///< 0 = none
    double distance_budget = 0.0;             ///< [m] 0 = none
    bool return_home = false;                 ///< The budgets are for the way there and back.
    WayHome::Options way_home;
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit Journey(const Options& options);

  /// The robot is there: sums up the distance travelled.
  void Move(const Eigen::Vector3d& p_W);
  double distance() const { return distance_; }  ///< [m]
  /// The clock went back by that much.
  void ShiftTimes(Duration back);

  /// Which budget is used up, when one is. Time counts from the first call.
  std::optional<std::string> Spent(Time now);
  /// Whether a reason to end is that of a budget.
  static bool IsBudget(const std::string& reason);

  /// Finds the ways home from everywhere; the first call is made from home. Nothing to do for a robot that
  /// need not return.
  void FindWaysHome(const PlanningMap& map, const Eigen::Vector3d& p_W);
  const WayHome& way_home() const { return way_home_; }
  /// Which budget leaves no more than the way home from there needs, when one does.
  std::optional<std::string> HomeIsDue(const PlanningMap& map, const Eigen::Vector3d& p_W, Time now) const;
  /// Which budget does not allow a way of that length [m] to a place, and home from there.
  std::optional<std::string> TooFar(const PlanningMap& map, double length, const Eigen::Vector3d& end_W,
                                    Time now) const;

 private:
  Options options_;
  WayHome way_home_;
  std::optional<Time> started_;
  std::optional<Eigen::Vector3d> last_position_W_;
  double distance_ = 0.0;
};

}  // namespace thalweg::explorer
