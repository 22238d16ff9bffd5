#include "services/controller/core/retreat.h"

#include <algorithm>

namespace thalweg::controller {
namespace {

// Poses nearer to each other than this count as one.
constexpr double kLeastStepTravel = 0.01;  // [m]
constexpr double kLeastTurn = 0.02;        // [rad]

}  // namespace

void Retreat::Note(const RigidTransform& T_WB) {
  Step step{T_WB};
  if (!steps_.empty()) {
    step.travel = (T_WB.translation() - steps_.back().T_WB.translation()).norm();
    step.turn = AngleBetween(T_WB, steps_.back().T_WB);
    if (step.travel < kLeastStepTravel && step.turn < kLeastTurn) return;
  }
  travel_ += step.travel;
  turn_ += step.turn;
  steps_.push_back(step);
  while (steps_.size() > 1 && (travel_ > options_.reach || turn_ > options_.turn_reach)) {
    steps_.pop_front();
    travel_ -= steps_.front().travel;
    turn_ -= steps_.front().turn;
  }
}

std::optional<RigidTransform> Retreat::Back(const RigidTransform& T_WB, double dt) {
  while (!steps_.empty()) {
    const RigidTransform& goal = steps_.back().T_WB;
    const double distance = (goal.translation() - T_WB.translation()).norm();
    const double turn = AngleBetween(T_WB, goal);
    const double duration = std::max(distance / options_.max_speed, turn / options_.max_turn_rate);
    if (duration > dt) return Interpolate(T_WB, goal, dt / duration);
    if (steps_.size() == 1 && duration > 0.0) return goal;
    travel_ -= steps_.back().travel;
    turn_ -= steps_.back().turn;
    steps_.pop_back();
  }
  return std::nullopt;
}

}  // namespace thalweg::controller
