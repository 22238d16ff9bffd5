#include "services/explorer/core/path/narrow_passage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/angles.h"
#include "common/geometry/attitude.h"
#include "common/geometry/polyline.h"

namespace thalweg::explorer {
namespace {

constexpr double kPassageSampling = 0.5;  // [voxels]
constexpr double kBefore = 0.6;           // [m] faces the path this far before a narrow position,
constexpr double kTurned = 0.2;           // [m] or so early that the turn is finished this far before it
/// [m] Looks at the point of the path this far ahead: at the default speed and turn rate, the robot has
/// finished a right-angle turn by the corner. What lies farther ahead is behind the next corner.
constexpr double kGazeAhead = 0.6;

struct Sample {
  Eigen::Vector3d p_W;
  double arc;   ///< [m] Arc length from the start.
  bool vertex;  ///< Whether it is a vertex of the given path.
};

std::vector<Sample> SamplesOf(const std::vector<Eigen::Vector3d>& path_W, double step) {
  std::vector<Sample> samples{{path_W.front(), 0.0, true}};
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    const Eigen::Vector3d segment = path_W[n] - path_W[n - 1];
    const int pieces = PiecesOf(segment.norm(), step);
    for (int piece = 1; piece <= pieces; ++piece) {
      samples.push_back({path_W[n - 1] + segment * (static_cast<double>(piece) / pieces),
                         samples.back().arc + segment.norm() / pieces, piece == pieces});
    }
  }
  return samples;
}

/// The point that the robot faces at each sample: the point of the path kGazeAhead farther on, extrapolated
/// straight beyond the end of the path, so that the robot faces the last segment, too, however short it is.
std::vector<Eigen::Vector3d> GazesOf(const std::vector<Sample>& samples) {
  const Eigen::Vector3d& end = samples.back().p_W;
  const Eigen::Vector3d last_segment = end - samples[samples.size() - 2].p_W;
  const Eigen::Vector3d on = last_segment.norm() > 0.0 ? last_segment.normalized() : Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> gazes;
  std::size_t at = 0;
  for (const Sample& sample : samples) {
    const double arc = sample.arc + kGazeAhead;
    while (at < samples.size() && samples[at].arc < arc) ++at;
    gazes.push_back(at < samples.size() ? samples[at].p_W : end + (arc - samples.back().arc) * on);
  }
  return gazes;
}

/// Orientation toward `direction` without roll, and with a pitch that the robot can have; where `direction`
/// is vertical, the heading of `R_WB` is kept.
Eigen::Matrix3d Facing(const Eigen::Vector3d& direction, const Eigen::Matrix3d& R_WB,
                       const RobotModel& robot) {
  const double flat = std::hypot(direction.x(), direction.y());
  const double length = direction.norm();
  if (length < 1e-6) return R_WB;
  const bool upright = flat < 0.05 * length;
  const double yaw = upright ? YawOf(R_WB) : std::atan2(direction.y(), direction.x());
  return RotationFromYawPitch(yaw, robot.PitchWithin(std::atan2(direction.z(), flat)));
}

}  // namespace

bool IsNarrow(const PlanningMap& map, const Eigen::Vector3d& p_W, const RobotModel& robot) {
  const double narrow = robot.radius + map.voxel_size();
  return map.ClearanceAt(p_W, PlanningMap::Obstacles::kAllButSurelyFree, narrow) < narrow - 1e-9;
}

FacedPath FaceNarrowPassages(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                             const RigidTransform& T_WB, const Eigen::Matrix3d& R_WB_end,
                             const RobotModel& robot, double sees) {
  if (path_W.size() < 2) return {.T_WBs = {MakeTransform(R_WB_end, path_W.front())}, .narrow = {false}};
  const std::vector<Sample> samples = SamplesOf(path_W, kPassageSampling * map.voxel_size());
  std::vector<double> next_narrow(samples.size());  // [m] arc length of the next narrow position
  double next = std::numeric_limits<double>::infinity();
  for (std::size_t n = samples.size(); n-- > 0;) {
    const Sample& sample = samples[n];
    const bool here = sample.arc < map.voxel_size();  // the robot is already there
    if (!here && IsNarrow(map, sample.p_W, robot)) next = sample.arc;
    next_narrow[n] = next;
  }

  // The orientation at each sample; that of the first is the one for setting out.
  std::vector<Eigen::Matrix3d> R_WBs(samples.size(), R_WB_end);
  const double travel_per_turn = robot.max_speed / robot.max_turn_rate;  // [m/rad]
  const auto travel_to_turn = [&](const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
    if (!robot.gimballed()) return AngleBetween(from, to) * travel_per_turn;
    const YawPitch a = YawPitchOf(from);
    const YawPitch b = YawPitchOf(to);
    return robot.max_speed * std::max(std::abs(WrappedAngle(b.yaw - a.yaw)) / robot.max_turn_rate,
                                      std::abs(b.pitch - a.pitch) / robot.max_gimbal_rate);
  };
  const std::vector<Eigen::Vector3d> gazes = GazesOf(samples);
  // orientation reached when turning at full rate while traveling at full speed
  RigidTransform turned = T_WB;
  double faces_until = 0.0;  // [m] arc length of the narrow position that it already turns for
  FacedPath path;
  for (std::size_t n = 0; n + 1 < samples.size(); ++n) {
    if (n > 0) {
      const double travel = samples[n].arc - samples[n - 1].arc;
      const RigidTransform toward = MakeTransform(R_WBs[n - 1], T_WB.translation());
      turned = robot.gimballed() ? TurnedFor(robot, turned, toward, travel / robot.max_speed)
                                 : TurnedTowards(turned, toward, travel / travel_per_turn);
    }
    if (!std::isfinite(next_narrow[n])) continue;
    const Eigen::Matrix3d& before = n > 0 ? R_WBs[n - 1] : T_WB.linear();
    const Eigen::Matrix3d facing = Facing(gazes[n] - samples[n].p_W, before, robot);
    const double reach = std::max(kBefore, kTurned + travel_to_turn(turned.linear(), facing));
    if (faces_until != next_narrow[n] && next_narrow[n] - samples[n].arc > reach) continue;
    faces_until = next_narrow[n];
    const double off = AngleBetween(before, facing);
    R_WBs[n] = off < kOffThePath ? before : facing;
    if (n == 0 && off >= sees && kTurned + travel_to_turn(before, facing) > next_narrow[n]) {
      path.turn_first = true;
      turned.linear() = facing;
    }
  }

  path.T_WBs.push_back(MakeTransform(path.turn_first ? R_WBs.front() : T_WB.linear(), samples.front().p_W));
  path.narrow.push_back(false);
  const auto narrow_soon = [&](std::size_t n) {
    return n + 1 < samples.size() && next_narrow[n] - samples[n].arc <= kTurned;
  };
  for (std::size_t n = 1; n < samples.size(); ++n) {
    const bool last = n + 1 == samples.size();
    const bool goes_on = !last && !samples[n].vertex && AngleBetween(R_WBs[n], R_WBs[n + 1]) < 1e-9 &&
                         narrow_soon(n) == narrow_soon(n + 1);
    if (goes_on) continue;
    path.T_WBs.push_back(MakeTransform(R_WBs[n], samples[n].p_W));
    path.narrow.push_back(narrow_soon(n));
  }
  return path;
}

FacedPath FaceTravel(const std::vector<Eigen::Vector3d>& path_W, const RigidTransform& T_WB) {
  FacedPath faced;
  Eigen::Matrix3d R_WB = T_WB.linear();
  for (std::size_t n = 0; n < path_W.size(); ++n) {
    const Eigen::Vector3d along_W = path_W[n] - path_W[n == 0 ? 0 : n - 1];
    const double across = along_W.head<2>().norm();
    if (across + std::abs(along_W.z()) > 0.0) {
      const double yaw = across > 0.0 ? std::atan2(along_W.y(), along_W.x()) : YawOf(R_WB);
      R_WB = RotationFromYawPitch(yaw, std::atan2(along_W.z(), across));
    }
    faced.T_WBs.push_back(MakeTransform(R_WB, path_W[n]));
  }
  faced.narrow.assign(path_W.size(), false);
  return faced;
}

FacedPath FaceTravelThenTurn(const std::vector<Eigen::Vector3d>& path_W, const RigidTransform& T_WB,
                             const Eigen::Matrix3d& R_WB_end) {
  if (path_W.size() < 2) return {.T_WBs = {MakeTransform(R_WB_end, path_W.front())}, .narrow = {false}};
  FacedPath faced = FaceTravel(path_W, T_WB);
  faced.T_WBs.push_back(MakeTransform(R_WB_end, path_W.back()));
  faced.narrow.push_back(false);
  return faced;
}

}  // namespace thalweg::explorer
