#include "services/controller/core/smoother.h"

#include <algorithm>

namespace thalweg::controller {

void Smoother::Restart(const Eigen::Vector3d& p_W) {
  knots_ = {{.time = -window_, .p_W = p_W}, {.time = 0.0, .p_W = p_W}};
}

void Smoother::Move(const Eigen::Vector3d& p_W, double dt) {
  if (dt <= 0.0) return;
  knots_.push_back({.time = knots_.back().time + dt, .p_W = p_W});
  while (knots_[1].time <= begin()) knots_.pop_front();
}

Eigen::Vector3d Smoother::AtBegin() const {
  const Knot& a = knots_[0];
  const Knot& b = knots_[1];
  const double share = std::clamp((begin() - a.time) / (b.time - a.time), 0.0, 1.0);
  return a.p_W + share * (b.p_W - a.p_W);
}

/// Relative to where the other point is, so that a mean of equal positions is exact.
Eigen::Vector3d Smoother::position() const {
  const Eigen::Vector3d& origin_W = knots_.back().p_W;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d from_W = AtBegin() - origin_W;
  double from = begin();
  for (std::size_t n = 1; n < knots_.size(); ++n) {
    const Eigen::Vector3d to_W = knots_[n].p_W - origin_W;
    sum += 0.5 * (knots_[n].time - from) * (from_W + to_W);
    from_W = to_W;
    from = knots_[n].time;
  }
  return origin_W + sum / window_;
}

Eigen::Vector3d Smoother::velocity() const {
  return (knots_.back().p_W - AtBegin()) / window_;
}

bool Smoother::stands() const {
  return std::ranges::all_of(knots_, [this](const Knot& knot) { return knot.p_W == knots_.back().p_W; });
}

}  // namespace thalweg::controller
