#include "services/explorer/core/journey.h"

#include <stdexcept>

namespace thalweg::explorer {
namespace {

constexpr const char* kTime = "time budget";
constexpr const char* kDistance = "distance budget";

}  // namespace

Journey::Journey(const Options& options) : options_(options), way_home_(options.way_home) {
  if (!(options.way_home.margin >= 0.0)) throw std::invalid_argument("home_margin must be >= 0");
}

void Journey::Move(const Eigen::Vector3d& p_W) {
  if (last_position_W_) distance_ += (p_W - *last_position_W_).norm();
  last_position_W_ = p_W;
}

void Journey::ShiftTimes(Duration back) {
  if (started_) *started_ -= back;
}

std::optional<std::string> Journey::Spent(Time now) {
  if (!started_) started_ = now;
  if (options_.time_budget > Duration::zero() && now - *started_ >= options_.time_budget) return kTime;
  if (options_.distance_budget > 0.0 && distance_ >= options_.distance_budget) return kDistance;
  return std::nullopt;
}

bool Journey::IsBudget(const std::string& reason) {
  return reason == kTime || reason == kDistance;
}

void Journey::FindWaysHome(const PlanningMap& map, const Eigen::Vector3d& p_W) {
  if (!options_.return_home) return;
  if (!way_home_.home_W()) way_home_.SetOut(p_W);
  way_home_.Find(map, p_W);
}

std::optional<std::string> Journey::HomeIsDue(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                              Time now) const {
  return TooFar(map, 0.0, p_W, now);
}

std::optional<std::string> Journey::TooFar(const PlanningMap& map, double length,
                                           const Eigen::Vector3d& end_W, Time now) const {
  if (!options_.return_home) return std::nullopt;
  const std::optional<double> home = way_home_.LengthFrom(map, end_W);
  if (!home) return std::nullopt;  // seen when it gets there
  const double needed = way_home_.Needed(*home);
  if (options_.distance_budget > 0.0 && distance_ + length + needed > options_.distance_budget)
    return kDistance;
  if (options_.time_budget > Duration::zero() && started_ &&
      now - *started_ + way_home_.TimeFor(length) + way_home_.TimeFor(needed) > options_.time_budget) {
    return kTime;
  }
  return std::nullopt;
}

}  // namespace thalweg::explorer
