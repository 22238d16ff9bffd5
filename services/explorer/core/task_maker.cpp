#include "services/explorer/core/task_maker.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/base/stopwatch.h"
#include "common/geometry/polyline.h"
#include "services/explorer/core/path/flyable_path.h"
#include "services/explorer/core/path/steered_path.h"
#include "services/explorer/core/surface_inspection.h"
#include "services/explorer/core/turn_price.h"
#include "services/explorer/core/view/aiming.h"

namespace thalweg::explorer {
namespace {

constexpr double kOnTheSpot = 1e-3;  // [m] Length of a path on which the robot only turns.

/// Whether a task is carried out only where the robot looks in its direction at the end.
bool NeedsOrientation(Purpose purpose) {
  switch (purpose) {
    case Purpose::kGoBack:
    case Purpose::kGoHome:
    case Purpose::kGoTo:
    case Purpose::kLeaveNoGo:
    case Purpose::kEnd:
      return false;
    case Purpose::kFindFreeSpace:
    case Purpose::kLookAround:
    case Purpose::kSeeFrontier:
    case Purpose::kTakeView:
    case Purpose::kInspect:
    case Purpose::kWatchShutWay:
    case Purpose::kLookAt:
      break;
  }
  return true;
}

}  // namespace

std::optional<Task> TaskMaker::Turn(Purpose purpose, const Eigen::Matrix3d& R_WB,
                                    const RigidTransform& T_WB) const {
  if (!options_.robot.turns_on_the_spot())
    return Steer(purpose, T_WB.translation(), R_WB, T_WB, Heading::kGiven);
  Task task;
  task.plan.kind = Plan::Kind::kLook;
  task.plan.purpose = purpose;
  task.plan.T_WBs = {MakeTransform(R_WB, T_WB.translation())};
  return task;
}

std::optional<Task> TaskMaker::LookAround(const RigidTransform& T_WB, std::size_t enough) const {
  const LookMemory& memory = knowledge_.memory();
  const std::vector<Sighting> sightings = knowledge_.SightingsFromBody(T_WB.translation());
  std::vector<bool> fresh(sightings.size());
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    const VoxelIndex& i = sightings[n].voxel;
    fresh[n] = memory.Looks(i) == 0 && memory.set_aside()[i] == 0;
  }
  const ViewPlanner& views = knowledge_.views();
  const View view = views.Best(sightings, fresh, {}, T_WB.linear());
  if (view.count < enough) return std::nullopt;
  std::vector<VoxelIndex> target;
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    if (fresh[n] && views.Shows(view.R_WB, sightings[n])) target.push_back(sightings[n].voxel);
  }
  std::optional<Task> task = Turn(Purpose::kLookAround, view.R_WB, T_WB);
  if (!task) return std::nullopt;
  task->plan.target_W = T_WB.translation() + view.R_WB.col(0);
  AimAt(std::move(target), *task);
  return task;
}

std::vector<Eigen::Vector3d> TaskMaker::InPlane(std::vector<Eigen::Vector3d> points_W) const {
  if (const std::optional<double> plane = knowledge_.map().plane()) {
    for (Eigen::Vector3d& p_W : points_W) p_W.z() = *plane;
  }
  return points_W;
}

std::vector<Eigen::Vector3d> TaskMaker::InCurves(const std::vector<Eigen::Vector3d>& path_W) const {
  std::vector<Eigen::Vector3d> whole_W;
  if (lead_ != nullptr) whole_W.emplace_back((lead_->path.T_WBs.end() - 2)->translation());
  whole_W.insert(whole_W.end(), path_W.begin(), path_W.end());
  return MakeFlyable(knowledge_.map(), whole_W, options_.clearance() + options_.comfort.distance,
                     lead_ != nullptr);
}

std::vector<Eigen::Vector3d> TaskMaker::Swung(const std::vector<Eigen::Vector3d>& path_W) const {
  if (lead_ == nullptr || !lead_->flight || path_W.size() < 2) return {};
  const PlanningMap& map = knowledge_.map();
  const std::vector<Eigen::Vector3d> flat_W = InPlane(path_W);
  const double comfortable = options_.clearance() + options_.comfort.distance;
  std::optional<Swing> swing = SwingOnto(map, *lead_->flight, flat_W, comfortable);
  if (!swing) swing = SwingOnto(map, *lead_->flight, flat_W, options_.clearance());
  if (!swing) return {};
  std::vector<Eigen::Vector3d> points_W = swing->arc_W;
  // The curves begin on the arc's last segment; a robot that flies straight on already has none.
  const auto straight = points_W.end() - std::min<std::ptrdiff_t>(2, std::ssize(points_W));
  std::vector<Eigen::Vector3d> rest_W(straight, points_W.end());
  rest_W.insert(rest_W.end(), swing->rest_W.begin(), swing->rest_W.end());
  points_W.erase(straight, points_W.end());
  rest_W = MakeFlyable(map, rest_W, comfortable, true);
  points_W.insert(points_W.end(), rest_W.begin(), rest_W.end());
  return points_W;
}

FacedPath TaskMaker::Faced(Purpose purpose, const std::vector<Eigen::Vector3d>& points_W,
                           const Eigen::Matrix3d& R_WB, const RigidTransform& T_WB) const {
  const bool views = purpose == Purpose::kTakeView;  // the orientation is what the path is for
  if (!options_.loop.face_target && !views) return FaceTravel(points_W, T_WB);
  if (options_.robot.faces_travel() || !options_.loop.face_target)
    return FaceTravelThenTurn(points_W, T_WB, R_WB);
  const bool in_flight = options_.minimize == Minimize::kTime;
  return FaceNarrowPassages(knowledge_.map(), points_W, T_WB, R_WB, options_.robot,
                            in_flight ? AngleWellInView(options_.camera, options_.robot) : kOffThePath);
}

std::optional<Task> TaskMaker::Follow(Purpose purpose, const std::vector<Eigen::Vector3d>& path_W,
                                      const Eigen::Matrix3d& R_WB, const RigidTransform& T_WB,
                                      Heading heading) const {
  if (!options_.robot.turns_on_the_spot()) return Steer(purpose, path_W.back(), R_WB, T_WB, heading);
  const PlanningMap& map = knowledge_.map();
  Task task;
  task.plan.kind = Plan::Kind::kGo;
  task.plan.purpose = purpose;
  task.plan.length = PathLength(path_W);
  // What leads back the way it came is too narrow to be bent.
  const bool bends = purpose != Purpose::kGoBack;
  const std::vector<Eigen::Vector3d> swung_W = bends ? Swung(path_W) : std::vector<Eigen::Vector3d>();
  if (!swung_W.empty()) {
    FacedPath faced = Faced(purpose, InPlane(swung_W), R_WB, lead_->hears.T_WB);
    if (!faced.turn_first) {
      task.lead_poses = lead_->hears.pose + 1;
      task.Follow(std::move(faced), map, options_.least_clearance());
      return task;
    }
  }
  const bool curves = bends && options_.minimize == Minimize::kTime;
  const std::vector<Eigen::Vector3d> points_W = InPlane(curves ? InCurves(path_W) : path_W);
  task.Follow(Faced(purpose, points_W, R_WB, T_WB), map, options_.least_clearance());
  return task;
}

std::optional<Task> TaskMaker::Steer(Purpose purpose, const Eigen::Vector3d& to_W,
                                     const Eigen::Matrix3d& R_WB, const RigidTransform& T_WB,
                                     Heading heading) const {
  const PlanningMap& map = knowledge_.map();
  if (!map.plane()) return std::nullopt;
  SteeringGoal goal{.p_W = to_W, .was_there = purpose == Purpose::kGoHome};
  // Whoever leaves a box at its edge has not left it.
  if (purpose == Purpose::kLeaveNoGo) goal.distance = 0.5 * options_.safety_margin;
  const bool is_wanted =
      NeedsOrientation(purpose) && (options_.loop.face_target || purpose == Purpose::kTakeView);
  if (is_wanted || heading == Heading::kGiven) goal.yaw = YawOf(R_WB);
  const SteeringModel model{.min_turning_radius = options_.robot.min_turning_radius,
                            .body_radius = options_.robot.radius,
                            .exemption = options_.exemption,
                            .wide_exemption = options_.wide_exemption};
  std::optional<std::vector<RigidTransform>> T_WBs = SteerTo(map, T_WB, goal, model);
  if (!T_WBs) return std::nullopt;
  Task task;
  task.plan.kind = T_WBs->size() == 1 ? Plan::Kind::kLook : Plan::Kind::kGo;
  task.plan.purpose = purpose;
  task.plan.length = PathLength(*T_WBs);
  const std::vector<bool> narrow(T_WBs->size(), false);
  task.Follow({.T_WBs = *std::move(T_WBs), .narrow = narrow}, map, options_.least_clearance());
  return task;
}

std::vector<Eigen::Vector3d> TaskMaker::Smoothed(const std::vector<Eigen::Vector3d>& path_W) const {
  const PlanningMap& map = knowledge_.map();
  return MakeComfortable(map, PullStraight(map, path_W, options_.clearance()), options_.comfort);
}

std::optional<Task> TaskMaker::See(const Choice& choice, const std::vector<Candidate>& candidates,
                                   const RigidTransform& T_WB, StageTimings& timings,
                                   Approach approach) const {
  const PlanningMap& map = knowledge_.map();
  const ViewPlanner& views = knowledge_.views();
  const Cluster& cluster = candidates[choice.candidate].cluster;
  const std::vector<VoxelIndex>& target = choice.target.empty() ? cluster.unknowns : choice.target;
  std::vector<Eigen::Vector3d> path_W = choice.path_W;
  if (options_.loop.stop_short && approach == Approach::kUntilSeen && !choice.R_WB)
    StopWhereSeen(map, views, options_.look_range, target, path_W);
  const Stopwatch comfort;
  // In curves only the end counts, which stays.
  if (options_.robot.turns_on_the_spot()) path_W = MakeComfortable(map, path_W, options_.comfort);
  timings["comfort"].Add(comfort.Milliseconds());
  const Eigen::Matrix3d R_WB = choice.R_WB ? *choice.R_WB
                                           : BestViewOf(target, knowledge_.SightingsFromBody(path_W.back()),
                                                        knowledge_.memory().set_aside(), views, T_WB.linear())
                                                 .R_WB;
  std::optional<Task> task = Follow(Purpose::kSeeFrontier, path_W, R_WB, T_WB);
  if (!task) return std::nullopt;
  task->plan.target_W = cluster.center_W;
  task->plan.frontiers = candidates.size();
  task->choice = choice;
  AimAt(target, *task);
  return task;
}

std::optional<Task> TaskMaker::TakeView(const Choice& choice, const std::vector<Candidate>& candidates,
                                        const RigidTransform& T_WB) const {
  std::optional<Task> task = PathLength(choice.path_W) < kOnTheSpot
                                 ? Turn(Purpose::kTakeView, *choice.R_WB, T_WB)
                                 : Follow(Purpose::kTakeView, choice.path_W, *choice.R_WB, T_WB);
  if (!task) return std::nullopt;
  task->plan.target_W = candidates[choice.candidate].cluster.center_W;
  task->plan.frontiers = candidates.size();
  task->choice = choice;
  return task;
}

std::optional<Task> TaskMaker::Inspect(const InspectionView& view, const PathSearch& search,
                                       const RigidTransform& T_WB) const {
  const PlanningMap& map = knowledge_.map();
  std::optional<Task> task =
      view.length > 0.0
          ? Follow(Purpose::kInspect, Smoothed(search.PathFrom(map, T_WB.translation(), view.place)),
                   view.R_WB, T_WB)
          : Turn(Purpose::kInspect, view.R_WB, T_WB);
  if (!task) return std::nullopt;
  DescribeInspection(view, map, task->plan);
  task->facets = view.facets;
  return task;
}

void TaskMaker::AimAt(std::vector<VoxelIndex> target, Task& task) const {
  task.Aim(std::move(target), knowledge_.map());
  task.plan.target_doubtful = task.doubtful_in_target();
  task.plan.target_unknown = task.target.size() - task.plan.target_doubtful;
}

Task Ended(Ending ending) {
  Task task;
  task.plan.ending = std::move(ending);
  return task;
}

Task Ended(Outcome outcome) {
  return Ended(Ending{.outcome = outcome});
}

}  // namespace thalweg::explorer
