#include "common/geometry/flown_path.h"

#include <algorithm>

#include "common/geometry/polyline.h"

namespace thalweg {
namespace {

constexpr double kLeastTravel = 0.01;    // [m] Between positions that are examined.
constexpr std::size_t kMostSince = 256;  // Positions between two vertices, which bounds the work for a pose.

double Distance(const RigidTransform& a, const RigidTransform& b) {
  return (a.translation() - b.translation()).norm();
}

}  // namespace

double FlownPath::end() const {
  if (empty()) return 0.0;
  return vertices_.back().arc + (T_WB_newest_ ? Distance(vertices_.back().T_WB, *T_WB_newest_) : 0.0);
}

void FlownPath::Note(const RigidTransform& T_WB) {
  if (!empty() && Distance(T_WB_newest_.value_or(vertices_.back().T_WB), T_WB) > kLeap) {
    vertices_.clear();
    since_W_.clear();
    T_WB_newest_.reset();
  }
  if (empty()) {
    vertices_.push_back({T_WB, 0.0});
    return;
  }
  if (T_WB_newest_ && !StraightTo(T_WB)) Fix(*T_WB_newest_);
  T_WB_newest_ = T_WB;
  const Eigen::Vector3d& last_W = since_W_.empty() ? vertices_.back().T_WB.translation() : since_W_.back();
  if ((T_WB.translation() - last_W).norm() >= kLeastTravel) since_W_.push_back(T_WB.translation());
}

/// Whether everything since the last vertex lies on the segment from there to `T_WB`.
bool FlownPath::StraightTo(const RigidTransform& T_WB) const {
  const RigidTransform& from = vertices_.back().T_WB;
  if (since_W_.size() >= kMostSince || AngleBetween(from, T_WB) > kTurn) return false;
  return std::ranges::all_of(since_W_, [&](const Eigen::Vector3d& p_W) {
    return DistanceToSegment(from.translation(), T_WB.translation(), p_W) <= kTolerance;
  });
}

void FlownPath::Fix(const RigidTransform& T_WB) {
  vertices_.push_back({T_WB, vertices_.back().arc + Distance(vertices_.back().T_WB, T_WB)});
  since_W_.clear();
  if (vertices_.size() > kMostPoses) vertices_.pop_front();
}

std::vector<RigidTransform> FlownPath::BackTo(double arc) const {
  std::vector<RigidTransform> back;
  if (empty()) return back;
  arc = std::clamp(arc, begin(), end());
  if (T_WB_newest_) back.push_back(*T_WB_newest_);
  for (auto vertex = vertices_.rbegin(); vertex != vertices_.rend() && vertex->arc >= arc; ++vertex) {
    back.push_back(vertex->T_WB);
  }
  back.push_back(PoseAt(arc));
  return back;
}

RigidTransform FlownPath::PoseAt(double arc) const {
  const auto after = std::ranges::lower_bound(vertices_, arc, {}, &Vertex::arc);
  if (after == vertices_.begin()) return vertices_.front().T_WB;
  const Vertex& from = *std::prev(after);
  if (after == vertices_.end() && !T_WB_newest_) return from.T_WB;
  const RigidTransform& to = after == vertices_.end() ? *T_WB_newest_ : after->T_WB;
  const double length = Distance(from.T_WB, to);
  return length > 0.0 ? Interpolate(from.T_WB, to, std::min(1.0, (arc - from.arc) / length)) : from.T_WB;
}

void FlownPath::Shorten(double arc) {
  if (empty() || arc >= end()) return;
  arc = std::max(arc, begin());
  const RigidTransform T_WB = PoseAt(arc);
  while (vertices_.size() > 1 && vertices_.back().arc > arc) vertices_.pop_back();
  since_W_.clear();
  T_WB_newest_ = T_WB;
}

}  // namespace thalweg
