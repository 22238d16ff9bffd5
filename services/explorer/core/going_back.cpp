#include "services/explorer/core/going_back.h"

#include <vector>

#include "common/geometry/polyline.h"
#include "services/explorer/core/path/way_back.h"

namespace thalweg::explorer {
namespace {

constexpr int kMostInVain = 3;
constexpr double kNearer = 0.05;  // [m]

}  // namespace

void GoingBack::GoesOn() {
  left_.reset();
  in_vain_ = 0;
}

bool GoingBack::gives_up() const {
  return !may_ || in_vain_ >= kMostInVain;
}

std::vector<Eigen::Vector3d> GoingBack::Track(const RigidTransform& T_WB, const PlanningMap& map) const {
  return TrackBack(map, T_WB.translation(), came_.BackTo(came_.begin()));
}

std::optional<Task> GoingBack::ToMostOfSpace(const RigidTransform& T_WB, const PlanningMap& map,
                                             const TaskMaker& make) {
  if (gives_up()) return std::nullopt;
  const std::vector<Eigen::Vector3d> track_W = Track(T_WB, map);
  const std::optional<PathSearch> most = MostOfSpaceOn(track_W, map);
  if (!most) return std::nullopt;
  const auto reached = [&](const VoxelIndex& i) { return most->Reached(i); };
  return Along(WayBack(map, track_W, robot_.radius, reached), T_WB, make);
}

std::vector<Eigen::Vector3d> GoingBack::WayToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                                      const HomePaths& home_paths) const {
  const auto leads_home = [&](const VoxelIndex& i) {
    return home_paths.costs().Get(i, PathSearch::kUnreached) != PathSearch::kUnreached;
  };
  return WayBack(map, Track(T_WB, map), robot_.radius, leads_home);
}

bool GoingBack::LeadsToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                const HomePaths& home_paths) const {
  return may_ && !WayToPathHome(T_WB, map, home_paths).empty();
}

std::optional<Task> GoingBack::ToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                          const HomePaths& home_paths, const TaskMaker& make) {
  if (gives_up()) return std::nullopt;
  return Along(WayToPathHome(T_WB, map, home_paths), T_WB, make);
}

std::optional<Task> GoingBack::Along(const std::vector<Eigen::Vector3d>& path_W, const RigidTransform& T_WB,
                                     const TaskMaker& make) {
  if (path_W.empty()) return std::nullopt;
  const double length = PathLength(path_W);
  if (!left_ || length < *left_ - kNearer) {
    left_ = length;
    in_vain_ = 0;
  } else if (++in_vain_ == kMostInVain) {
    return std::nullopt;
  }
  std::optional<Task> task = make.Follow(Purpose::kGoBack, path_W, T_WB.linear(), T_WB);
  if (task) task->plan.target_W = path_W.back();
  return task;
}

}  // namespace thalweg::explorer
