#include "services/explorer/core/mission.h"

#include <stdexcept>
#include <utility>

#include "common/base/check.h"

namespace thalweg::explorer {
namespace {

constexpr double kAtHome = 0.15;      // [m]
constexpr double kLeastMove = 0.005;  // [m] Odometry trembles by less.

}  // namespace

Mission::Mission(const Options& options) : options_(options), home_paths_(options.home_paths) {
  if (!(options.home_paths.margin >= 0.0)) throw std::invalid_argument("home_margin must be >= 0");
}

void Mission::Move(const Eigen::Vector3d& p_W) {
  const double moved = last_position_W_ ? (p_W - *last_position_W_).norm() : 0.0;
  if (last_position_W_ && moved < kLeastMove) return;
  distance_ += moved;
  way_back_ += moved;
  last_position_W_ = p_W;
}

void Mission::Restore(const SavedExploration& saved) {
  if (saved.home_W) home_paths_.SetOut(*saved.home_W);
  distance_ = saved.distance;
  way_back_ = saved.distance;
  elapsed_before_ = saved.elapsed;
  if (saved.homeward) homeward_ = Ending{.outcome = *saved.homeward};
}

void Mission::ShiftTimes(Duration back) {
  if (started_) *started_ -= back;
}

std::optional<Budget> Mission::Spent(Time now) {
  if (!started_) started_ = now - elapsed_before_;
  if (options_.time_budget > Duration::zero() && now - *started_ >= options_.time_budget)
    return Budget::kTime;
  if (options_.distance_budget > 0.0 && distance_ >= options_.distance_budget) return Budget::kDistance;
  return std::nullopt;
}

void Mission::FindPathsHome(const PlanningMap& map, const Eigen::Vector3d& p_W) {
  if (!home_paths_.home_W()) home_paths_.SetOut(p_W);
  if (!options_.return_home && !homeward_) return;
  home_paths_.Find(map, p_W);
  way_back_ = home_paths_.LengthFrom(map, p_W).value_or(way_back_);
}

bool Mission::KnowsPathHome(const PlanningMap& map, const Eigen::Vector3d& p_W) {
  if (!home_paths_.home_W()) return false;
  home_paths_.Find(map, p_W);
  return home_paths_.LengthFrom(map, p_W).has_value();
}

std::optional<Budget> Mission::HomeIsDue(const PlanningMap& map, const Eigen::Vector3d& p_W, Time now) const {
  return TooFar(map, 0.0, p_W, now);
}

std::optional<Budget> Mission::TooFar(const PlanningMap& map, double length, const Eigen::Vector3d& end_W,
                                      Time now) const {
  if (!options_.return_home) return std::nullopt;
  // Where no path home is known, it can go back the way it came.
  const double home = home_paths_.LengthFrom(map, end_W).value_or(length + way_back_);
  const double needed = home_paths_.Needed(home);
  if (options_.distance_budget > 0.0 && distance_ + length + needed > options_.distance_budget)
    return Budget::kDistance;
  if (options_.time_budget > Duration::zero() && started_ &&
      now - *started_ + home_paths_.TimeFor(length) + home_paths_.TimeFor(needed) > options_.time_budget) {
    return Budget::kTime;
  }
  return std::nullopt;
}

void Mission::TurnHome(Ending why) {
  homeward_ = std::move(why);
}

std::optional<Ending> Mission::EndingAtHome(const Eigen::Vector3d& p_W) const {
  THALWEG_CHECK(homeward_ && home_paths_.home_W());
  if ((p_W - *home_paths_.home_W()).norm() > kAtHome) return std::nullopt;
  Ending ending = *homeward_;
  ending.home_within_budget = IsBudget(ending.outcome);
  return ending;
}

}  // namespace thalweg::explorer
