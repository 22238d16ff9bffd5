#include "services/explorer/core/going_back.h"

#include <cmath>
#include <vector>

#include "common/geometry/attitude.h"
#include "common/geometry/polyline.h"
#include "services/explorer/core/path/way_back.h"
#include "services/explorer/core/shut_ways.h"

namespace thalweg::explorer {
namespace {

constexpr int kMostInVain = 3;
constexpr double kNearer = 0.05;  // [m]
constexpr double kThere = 0.2;    // [m] From where a way is watched.

}  // namespace

GoingBack::GoingBack(const ExplorerOptions& options)
    : radius_(options.robot.radius),
      may_(options.loop.go_tight_ways && options.robot.turns_on_the_spot()),
      patience_(options.robot.turns_on_the_spot() ? ShutWayOptions(options).patience : Duration::zero()) {}

void GoingBack::ShiftTimes(Duration back) {
  if (watches_since_) *watches_since_ -= back;
}

void GoingBack::GoesOn() {
  left_.reset();
  in_vain_ = 0;
  watches_since_.reset();
}

std::vector<Eigen::Vector3d> GoingBack::Track(const RigidTransform& T_WB, const PlanningMap& map) const {
  return TrackBack(map, T_WB.translation(), came_.BackTo(came_.begin()));
}

std::optional<Task> GoingBack::ToMostOfSpace(const RigidTransform& T_WB, const PlanningMap& map,
                                             const TaskMaker& make) {
  if (!may_ || in_vain_ >= kMostInVain) return std::nullopt;
  const std::vector<Eigen::Vector3d> track_W = Track(T_WB, map);
  const std::optional<PathSearch> most = MostOfSpaceOn(track_W, map);
  if (!most) return std::nullopt;
  const auto reached = [&](const VoxelIndex& i) { return most->Reached(i); };
  return Along(WayBack(map, track_W, radius_, reached), Purpose::kGoBack, T_WB.linear(), T_WB, make);
}

std::vector<Eigen::Vector3d> GoingBack::WayToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                                      const HomePaths& home_paths) const {
  const auto leads_home = [&](const VoxelIndex& i) {
    return home_paths.costs().Get(i, PathSearch::kUnreached) != PathSearch::kUnreached;
  };
  return WayBack(map, Track(T_WB, map), radius_, leads_home);
}

bool GoingBack::LeadsToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                const HomePaths& home_paths) const {
  return may_ && !WayToPathHome(T_WB, map, home_paths).empty();
}

std::optional<Task> GoingBack::ToPathHome(const RigidTransform& T_WB, Time now, const PlanningMap& map,
                                          const HomePaths& home_paths, const TaskMaker& make) {
  if (in_vain_ >= kMostInVain) return std::nullopt;
  const std::vector<Eigen::Vector3d> path_W =
      may_ ? WayToPathHome(T_WB, map, home_paths) : std::vector<Eigen::Vector3d>();
  if (path_W.empty()) return Watch(T_WB, now, map, make);
  watches_since_.reset();
  return Along(path_W, Purpose::kGoBack, T_WB.linear(), T_WB, make);
}

std::optional<Task> GoingBack::Watch(const RigidTransform& T_WB, Time now, const PlanningMap& map,
                                     const TaskMaker& make) {
  if (patience_ <= Duration::zero()) return std::nullopt;
  const std::optional<ShutTrack> shut = FindShut(map, Track(T_WB, map));
  if (!shut) return std::nullopt;
  const Eigen::Vector3d ahead_W = shut->beyond_W - shut->path_W.back();
  const Eigen::Matrix3d R_WB = RotationFromYawPitch(std::atan2(ahead_W.y(), ahead_W.x()), 0.0);
  std::optional<Task> task;
  if (PathLength(shut->path_W) > kThere) {
    task = Along(shut->path_W, Purpose::kWatchShutWay, R_WB, T_WB, make);
  } else {
    if (!watches_since_) watches_since_ = now;
    if (now - *watches_since_ > patience_) return std::nullopt;
    task = make.Turn(Purpose::kWatchShutWay, R_WB, T_WB);
    if (task) task->plan.dwell = kBetweenLooksAtShutWay;
  }
  if (task) task->plan.target_W = shut->beyond_W;
  return task;
}

std::optional<Task> GoingBack::Along(const std::vector<Eigen::Vector3d>& path_W, Purpose purpose,
                                     const Eigen::Matrix3d& R_WB, const RigidTransform& T_WB,
                                     const TaskMaker& make) {
  if (path_W.empty()) return std::nullopt;
  const double length = PathLength(path_W);
  if (!left_ || length < *left_ - kNearer) {
    left_ = length;
    in_vain_ = 0;
  } else if (++in_vain_ == kMostInVain) {
    return std::nullopt;
  }
  std::optional<Task> task = make.Follow(purpose, path_W, R_WB, T_WB);
  if (task) task->plan.target_W = path_W.back();
  return task;
}

}  // namespace thalweg::explorer
