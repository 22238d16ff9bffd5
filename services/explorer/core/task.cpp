#include "services/explorer/core/task.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/base/angles.h"
#include "common/base/check.h"
#include "common/geometry/attitude.h"
#include "common/geometry/polyline.h"

namespace thalweg::explorer {
namespace {

/// [m] Allows for sampling, and for a robot that is not exactly on its path.
constexpr double kClearanceTolerance = 0.02;
constexpr double kBeginning = 0.1;      // [m] Length of a path's beginning.
constexpr double kStraightEnd = 0.1;    // [m] of what leads to where the robot leaves a path
constexpr double kLeastSegment = 1e-6;  // [m]
const double kFaces = std::cos(45.0 * kDegree);

/// The segment of the path nearest to the robot, by the index of its end.
std::size_t SegmentNearest(const std::vector<RigidTransform>& T_WBs, const Eigen::Vector3d& p_W) {
  std::size_t segment = 1;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < T_WBs.size(); ++n) {
    const Eigen::Vector3d a = T_WBs[n - 1].translation();
    const Eigen::Vector3d along = T_WBs[n].translation() - a;
    const double share =
        along.squaredNorm() > 0.0 ? std::clamp((p_W - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
    const double distance = (a + share * along - p_W).norm();
    if (distance < nearest) {
      nearest = distance;
      segment = n;
    }
  }
  return segment;
}

}  // namespace

void Task::Follow(FacedPath path, const PlanningMap& map, double enough) {
  THALWEG_CHECK(path.narrow.size() == path.T_WBs.size());
  plan.T_WBs = std::move(path.T_WBs);
  narrow = std::move(path.narrow);
  turn_first = path.turn_first;
  clearance.clear();
  for (std::size_t n = 1; n < plan.T_WBs.size(); ++n) {
    clearance.push_back(map.SegmentClearance(plan.T_WBs[n - 1].translation(), plan.T_WBs[n].translation(),
                                             PlanningMap::Obstacles::kOccupied,
                                             enough + kClearanceTolerance));
  }
}

std::optional<Task::Departure> Task::DepartAhead(const RigidTransform& T_WB, const Stretch& reacts,
                                                 const Stretch& brakes, const RobotModel& robot) const {
  constexpr double kBeside = 0.3;  // [m]
  if (plan.T_WBs.size() < 2) return std::nullopt;
  std::size_t n = SegmentNearest(plan.T_WBs, T_WB.translation());
  const Eigen::Vector3d before_W = plan.T_WBs[n - 1].translation();
  const Eigen::Vector3d after_W = plan.T_WBs[n].translation();
  const Eigen::Vector3d from_W =
      before_W + NearestShare(before_W, after_W, T_WB.translation()) * (after_W - before_W);
  if ((from_W - T_WB.translation()).norm() > kBeside) return std::nullopt;
  Departure departure{
      .lead = {.T_WBs = {MakeTransform(plan.T_WBs[n].linear(), from_W)}, .narrow = {narrow[n]}},
      .T_WB = T_WB,
      .hears = {}};
  const auto add = [&](const Eigen::Vector3d& p_W) {
    if ((p_W - departure.lead.T_WBs.back().translation()).norm() < kLeastSegment) return;
    departure.lead.T_WBs.push_back(MakeTransform(plan.T_WBs[n].linear(), p_W));
    departure.lead.narrow.push_back(narrow[n]);
  };
  // First to where the robot hears of the next path, then to where it can leave, and from there straight on
  // to where the path goes.
  Eigen::Vector3d at_W = from_W;
  for (int stretch = 0; stretch < 3; ++stretch) {
    double left = std::array{reacts.length, brakes.length, kStraightEnd}[static_cast<std::size_t>(stretch)];
    while (true) {
      const Eigen::Vector3d along_W = plan.T_WBs[n].translation() - at_W;
      if (along_W.norm() >= left) {
        at_W += along_W.norm() > 0.0 ? Eigen::Vector3d(along_W * (left / along_W.norm())) : along_W;
        break;
      }
      left -= along_W.norm();
      at_W = plan.T_WBs[n].translation();
      if (n + 1 == plan.T_WBs.size()) break;
      if (stretch < 2) add(at_W);
      ++n;
    }
    add(at_W);
    if (stretch > 0) continue;
    Departure::Hearing& hears = departure.hears;
    hears.pose = departure.lead.T_WBs.size() - 1;
    hears.T_WB = TurnedFor(robot, T_WB, departure.lead.T_WBs.back(), reacts.time);
    hears.T_WB.translation() = departure.lead.T_WBs.back().translation();
    hears.left = (plan.T_WBs[n].translation() - at_W).norm();
    for (std::size_t m = n + 1; m < plan.T_WBs.size(); ++m)
      hears.left += (plan.T_WBs[m].translation() - plan.T_WBs[m - 1].translation()).norm();
  }
  if (departure.lead.T_WBs.size() < 2) return std::nullopt;
  departure.T_WB = TurnedFor(robot, T_WB, departure.lead.T_WBs.back(), reacts.time + brakes.time);
  departure.T_WB.translation() = departure.lead.T_WBs.back().translation();
  return departure;
}

void Task::Prepend(const FacedPath& lead, const PlanningMap& map, double enough) {
  FacedPath path = lead;
  if (plan.kind == Plan::Kind::kLook) narrow.assign(plan.T_WBs.size(), false);
  path.T_WBs.insert(path.T_WBs.end(), plan.T_WBs.begin(), plan.T_WBs.end());
  path.narrow.insert(path.narrow.end(), narrow.begin(), narrow.end());
  path.turn_first = turn_first;
  Follow(std::move(path), map, enough);
}

bool Task::StillClear(const PlanningMap& map, const Eigen::Vector3d& p_W, double least, double radius) const {
  constexpr auto kOccupied = PlanningMap::Obstacles::kOccupied;
  Eigen::Vector3d from = p_W;
  for (std::size_t n = SegmentNearest(plan.T_WBs, p_W); n < plan.T_WBs.size(); ++n) {
    const Eigen::Vector3d to = plan.T_WBs[n].translation();
    // A path out of a narrow place was narrow when it was planned.
    const double planned = clearance[n - 1] - kClearanceTolerance;
    if (!map.SegmentClear(from, to, kOccupied, std::min(least, planned))) return false;
    if (planned < radius && !map.SegmentClearBut(map.TouchedAt(p_W, kOccupied, radius), from, to, kOccupied,
                                                 radius - kClearanceTolerance))
      return false;
    from = to;
  }
  return true;
}

bool Task::FacesNarrowPassage(const RigidTransform& T_WB) const {
  const Eigen::Vector3d p_W = T_WB.translation();
  if (plan.T_WBs.size() < 2 || (p_W - plan.T_WBs.front().translation()).norm() < kBeginning) return true;
  const std::size_t n = SegmentNearest(plan.T_WBs, p_W);
  // Rotation of the image about the camera's axis does not matter.
  return !narrow[n] || T_WB.linear().col(0).dot(plan.T_WBs[n].linear().col(0)) >= kFaces;
}

void Task::Aim(std::vector<VoxelIndex> at, const PlanningMap& map) {
  target = std::move(at);
  was_doubtful_.clear();
  for (const VoxelIndex& i : target) was_doubtful_.push_back(map.Doubtful(i));
}

void Task::DropTarget() {
  target.clear();
  facets.clear();
  was_doubtful_.clear();
}

std::size_t Task::doubtful_in_target() const {
  return static_cast<std::size_t>(std::count(was_doubtful_.begin(), was_doubtful_.end(), true));
}

std::size_t Task::KnownOfTarget(const PlanningMap& map) const {
  std::size_t known = 0;
  for (std::size_t n = 0; n < target.size(); ++n) {
    if (map.State(target[n]) == VoxelState::kUnknown) continue;
    known += was_doubtful_[n] && map.Doubtful(target[n]) ? 0 : 1;
  }
  return known;
}

}  // namespace thalweg::explorer
