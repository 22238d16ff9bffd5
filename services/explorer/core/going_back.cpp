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
  return !robot_.turns_on_the_spot() || in_vain_ >= kMostInVain;
}

std::optional<Task> GoingBack::ToMostOfSpace(const RigidTransform& T_WB, const PlanningMap& map,
                                             const TaskMaker& make) {
  if (gives_up()) return std::nullopt;
  const std::vector<Eigen::Vector3d> track_W = Track(T_WB, map);
  const std::optional<PathSearch> most = MostOfSpaceOn(track_W, map);
  if (!most) return std::nullopt;
  return To([&](const VoxelIndex& i) { return most->Reached(i); }, track_W, T_WB, map, make);
}

std::optional<Task> GoingBack::ToPathHome(const RigidTransform& T_WB, const PlanningMap& map,
                                          const HomePaths& home_paths, const TaskMaker& make) {
  if (gives_up()) return std::nullopt;
  const auto leads_home = [&](const VoxelIndex& i) {
    return home_paths.costs().Get(i, PathSearch::kUnreached) != PathSearch::kUnreached;
  };
  return To(leads_home, Track(T_WB, map), T_WB, map, make);
}

std::vector<Eigen::Vector3d> GoingBack::Track(const RigidTransform& T_WB, const PlanningMap& map) const {
  return TrackBack(map, T_WB.translation(), came_.BackTo(came_.begin()));
}

std::optional<Task> GoingBack::To(const std::function<bool(const VoxelIndex&)>& leads_on,
                                  const std::vector<Eigen::Vector3d>& track_W, const RigidTransform& T_WB,
                                  const PlanningMap& map, const TaskMaker& make) {
  const std::vector<Eigen::Vector3d> path_W = WayBack(map, track_W, robot_.radius, leads_on);
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
