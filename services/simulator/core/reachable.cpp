#include "services/simulator/core/reachable.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "common/base/text.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/voxels_within.h"
#include "services/simulator/core/moving_part.h"
#include "services/simulator/core/upright_cylinder.h"

namespace thalweg::simulator {
namespace {

/// Whether any part of the robot is inside a no-go box.
bool InNoGo(const World& world, const Eigen::Vector3d& p_W, const RobotModel& robot) {
  return std::any_of(world.no_go().begin(), world.no_go().end(), [&](const Eigen::AlignedBox3d& box) {
    return robot.height > 0.0 ? Distance({p_W, robot.radius, robot.height}, box) < 0.0
                              : box.exteriorDistance(p_W) < robot.radius;
  });
}

/// Whether a part that moves comes nearer to a robot there, at any time, than it would come by itself.
bool InTheWayOfParts(const World& world, const Eigen::Vector3d& p_W, const RobotModel& robot) {
  constexpr double kBetweenPoses = 0.02;  // [m]
  return std::ranges::any_of(world.parts(), [&](const PartInMotion& part) {
    bool near = false;
    VisitPoses(part.part(), kBetweenPoses, [&](const RigidTransform& T_WP) {
      near = near || DistanceTo(part.part(), T_WP, robot, p_W) < PartInMotion::kKeepOff + 0.5 * kBetweenPoses;
    });
    return near;
  });
}

/// Flood fill over the voxels in which the robot fits.
class ReachableFill {
 public:
  ReachableFill(const World& world, const Eigen::Vector3d& start_W, const RobotModel& robot,
                double voxel_size)
      : world_(world),
        start_W_(start_W),
        robot_(robot),
        voxel_size_(voxel_size),
        reachable_(VoxelsWithin(ExploredBounds(robot, start_W, world.bounds()), voxel_size), 0) {}

  DenseGrid<std::uint8_t> Run() {
    const VoxelIndex first = VoxelAt(start_W_, voxel_size_);
    // The robot may fit at the start but not at the center of the start's voxel, so its neighbors are seeds,
    // too.
    ForEachVoxel(CubeAround(first, 1), [&](const VoxelIndex& i) { Visit(start_W_, i); });
    while (!stack_.empty()) {
      const VoxelIndex voxel = stack_.back();
      stack_.pop_back();
      const Eigen::Vector3d from = PlaceIn(voxel, voxel_size_, robot_, start_W_);
      for (const VoxelIndex& step : kFaceNeighbors) Visit(from, voxel + step);
    }
    return std::move(reachable_);
  }

 private:
  void Visit(const Eigen::Vector3d& from, const VoxelIndex& voxel) {
    if (!reachable_.Contains(voxel) || reachable_[voxel]) return;
    if (robot_.drives && voxel.z != VoxelAt(start_W_, voxel_size_).z) return;
    const Eigen::Vector3d place = PlaceIn(voxel, voxel_size_, robot_, start_W_);
    if (world_.ClearanceOf(robot_, place, 0.0) < 0.0 || InNoGo(world_, place, robot_)) return;
    if (!world_.InSight(from, place)) return;  // a wall thinner than a voxel lies between
    reachable_[voxel] = 1;
    stack_.push_back(voxel);
  }

  const World& world_;
  Eigen::Vector3d start_W_;
  const RobotModel& robot_;
  double voxel_size_;
  DenseGrid<std::uint8_t> reachable_;
  std::vector<VoxelIndex> stack_;
};

}  // namespace

void CheckStart(const World& world, const Eigen::Vector3d& start_W, const RobotModel& robot) {
  const double clearance = world.ClearanceOf(robot, start_W, 0.0);
  const bool no_go = InNoGo(world, start_W, robot);
  if (world.bounds().contains(start_W) && clearance >= 0.0 && !no_go) return;
  std::ostringstream text;
  text << "a robot of radius " << robot.radius << " m ";
  if (robot.height > 0.0) text << "and height " << robot.height << " m ";
  text << "does not fit at the start " << start_W.transpose();
  if (no_go) {
    text << ": it would be in a no-go box";
  } else if (!world.bounds().contains(start_W)) {
    text << ": it is outside the bounds";
  } else {
    text << ": a surface reaches " << -clearance << " m into it";
  }
  throw std::invalid_argument(text.str());
}

Eigen::Vector3d PlaceIn(const VoxelIndex& voxel, double voxel_size, const RobotModel& robot,
                        const Eigen::Vector3d& start_W) {
  Eigen::Vector3d place = VoxelCenter(voxel, voxel_size);
  if (robot.drives) place.z() = start_W.z();
  return place;
}

DenseGrid<std::uint8_t> ReachableVoxels(const World& world, const Eigen::Vector3d& start_W,
                                        const RobotModel& robot, double voxel_size) {
  CheckStart(world, start_W, robot);
  return ReachableFill(world, start_W, robot, voxel_size).Run();
}

std::vector<Eigen::Vector3d> StartPlaces(const World& world, const Eigen::Vector3d& start_W,
                                         const RobotModel& robot, double room) {
  // Fine enough not to lose a passage that the robot fits through comfortably.
  const double voxel_size = robot.radius;
  CheckStart(world, start_W, robot);
  const DenseGrid<std::uint8_t> reachable =
      world.parts().empty() ? ReachableVoxels(world, start_W, robot, voxel_size)
                            : ReachableVoxels(world.WithoutParts(), start_W, robot, voxel_size);
  RobotModel wide = robot;
  wide.radius = room;
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < reachable.size(); ++i) {
    if (!reachable[i]) continue;
    const Eigen::Vector3d place = PlaceIn(reachable.IndexAt(i), voxel_size, robot, start_W);
    if (world.ClearanceOf(wide, place, 0.0) < 0.0 || InTheWayOfParts(world, place, wide)) continue;
    places.push_back(place);
  }
  if (places.empty()) {
    throw std::invalid_argument("no place with room for a radius of " + NumberText(room) +
                                " m is connected to the start");
  }
  return places;
}

RigidTransform RandomStart(std::span<const Eigen::Vector3d> places_W, std::uint32_t seed) {
  std::mt19937 random(seed);
  const Eigen::Vector3d& place = places_W[random() % places_W.size()];
  const double yaw = 2.0 * std::numbers::pi * random() / std::mt19937::max();
  return MakeTransform(RotationFromYawPitch(yaw, 0.0), place);
}

RigidTransform RandomStart(const World& world, const Eigen::Vector3d& start_W, const RobotModel& robot,
                           double room, std::uint32_t seed) {
  return RandomStart(StartPlaces(world, start_W, robot, room), seed);
}

}  // namespace thalweg::simulator
