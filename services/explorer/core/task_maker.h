#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/explorer/core/candidate_search.h"
#include "services/explorer/core/explorer_options.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/path/swing.h"
#include "services/explorer/core/task.h"
#include "services/explorer/core/view/inspection.h"

namespace thalweg::explorer {

/// How near a task comes to what it is to show.
enum class Approach : std::uint8_t {
  kUntilSeen,  ///< To the first point of the path that shows enough, unless the loop's rules say otherwise.
  kNearest,    ///< To the end of the path.
};

/// What orientation a robot that drives in curves has at the end of a path.
enum class Heading : std::uint8_t {
  kByPurpose,  ///< The given one if the purpose is to see something; else any.
  kGiven,
};

/// Makes tasks from what was decided: shapes the path for the robot, sets the orientations along it, and
/// records what the task is to show.
/// Keeps references; made for one decision. Threading: one thread.
class TaskMaker {
 public:
  /// What leads a robot in flight to where a task begins.
  struct Lead {
    FacedPath path;                  ///< See Task::Departure.
    Task::Departure::Hearing hears;  ///< From there the robot can swing onto the task's path,
    std::optional<Flight> flight;    ///< flying so at most; empty if it cannot.
  };
  /// @param lead  The path to where the task begins, if the robot is not there yet; null if it is.
  TaskMaker(const ExplorerOptions& options, const Knowledge& knowledge, const Lead* lead)
      : options_(options), knowledge_(knowledge), lead_(lead) {}

  // A robot that cannot turn on the spot drives in curves (SteerTo). There is no task where there is no room
  // for them.

  /// Turns on the spot, or in curves that end there.
  std::optional<Task> Turn(Purpose purpose, const Eigen::Matrix3d& R_WB, const RigidTransform& T_WB) const;
  /// Turns to the unknown voxels in sight that no look has covered; nothing if the best view shows fewer than
  /// `enough`.
  std::optional<Task> LookAround(const RigidTransform& T_WB, std::size_t enough) const;
  /// Follows a path, as it is, with the given orientation at its end; in curves, another path to that end.
  std::optional<Task> Follow(Purpose purpose, const std::vector<Eigen::Vector3d>& path_W,
                             const Eigen::Matrix3d& R_WB, const RigidTransform& T_WB,
                             Heading heading = Heading::kByPurpose) const;
  /// A path from voxel to voxel, straightened and led away from obstacles.
  std::vector<Eigen::Vector3d> Smoothed(const std::vector<Eigen::Vector3d>& path_W) const;
  /// Goes to see the chosen one of the candidates.
  std::optional<Task> See(const Choice& choice, const std::vector<Candidate>& candidates,
                          const RigidTransform& T_WB, StageTimings& timings,
                          Approach approach = Approach::kUntilSeen) const;
  /// Goes, or turns, to take the view that a strategy chose which goes by views: on its path, as it is.
  std::optional<Task> TakeView(const Choice& choice, const std::vector<Candidate>& candidates,
                               const RigidTransform& T_WB) const;
  /// Goes, or turns, to inspect surface. @param search  From the robot.
  std::optional<Task> Inspect(const InspectionView& view, const PathSearch& search,
                              const RigidTransform& T_WB) const;

 private:
  /// The points at the height at which a driving robot is, or as they are.
  std::vector<Eigen::Vector3d> InPlane(std::vector<Eigen::Vector3d> points_W) const;
  /// The path as a robot in flight takes it: in curves.
  std::vector<Eigen::Vector3d> InCurves(const std::vector<Eigen::Vector3d>& path_W) const;
  /// The path from where the robot can swing onto it; empty if it cannot. It keeps the comfort distance where
  /// some swing does.
  std::vector<Eigen::Vector3d> Swung(const std::vector<Eigen::Vector3d>& path_W) const;
  FacedPath Faced(Purpose purpose, const std::vector<Eigen::Vector3d>& points_W, const Eigen::Matrix3d& R_WB,
                  const RigidTransform& T_WB) const;
  /// Drives in curves.
  std::optional<Task> Steer(Purpose purpose, const Eigen::Vector3d& to_W, const Eigen::Matrix3d& R_WB,
                            const RigidTransform& T_WB, Heading heading) const;
  void AimAt(std::vector<VoxelIndex> target, Task& task) const;

  const ExplorerOptions& options_;
  const Knowledge& knowledge_;
  const Lead* lead_;
};

/// A task without a path: the exploration has ended.
Task Ended(Ending ending);
Task Ended(Outcome outcome);

}  // namespace thalweg::explorer
