#include "services/simulator/core/reachable.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "common/voxel/voxels_within.h"

namespace thalweg::simulator {
namespace {

/// Whether a part of a sphere is in a no-go box.
bool InNoGo(const World& world, const Eigen::Vector3d& center_W, double radius) {
  return std::any_of(world.no_go().begin(), world.no_go().end(),
                     [&](const Eigen::AlignedBox3d& box) { return box.exteriorDistance(center_W) < radius; });
}

/// Flood fill of the places where the robot's sphere can be.
class ReachableFill {
 public:
  ReachableFill(const World& world, const VoxelBox& box, double radius, double voxel_size)
      : world_(world), radius_(radius), voxel_size_(voxel_size), reachable_(box, 0) {}

  DenseGrid<std::uint8_t> From(const Eigen::Vector3d& start_W) {
    const VoxelIndex first = VoxelAt(start_W, voxel_size_);
    // The robot may fit at the start and yet not in that voxel's centre.
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) Visit(start_W, first + VoxelIndex{x, y, z});
      }
    }
    while (!stack_.empty()) {
      const VoxelIndex voxel = stack_.back();
      stack_.pop_back();
      const Eigen::Vector3d from = VoxelCenter(voxel, voxel_size_);
      for (const VoxelIndex& step : kFaceNeighbours) Visit(from, voxel + step);
    }
    return std::move(reachable_);
  }

 private:
  void Visit(const Eigen::Vector3d& from, const VoxelIndex& voxel) {
    if (!reachable_.Contains(voxel) || reachable_[voxel]) return;
    const Eigen::Vector3d center = VoxelCenter(voxel, voxel_size_);
    if (world_.DistanceToSurface(center, radius_) < radius_ || InNoGo(world_, center, radius_)) return;
    if (!world_.InSight(from, center)) return;  // a wall between, thin against the voxel
    reachable_[voxel] = 1;
    stack_.push_back(voxel);
  }

  const World& world_;
  double radius_;
  double voxel_size_;
  DenseGrid<std::uint8_t> reachable_;
  std::vector<VoxelIndex> stack_;
};

}  // namespace

void CheckStart(const World& world, const Eigen::Vector3d& start_W, double radius) {
  const double clearance = world.DistanceToSurface(start_W, 10.0 * radius);
  const bool no_go = InNoGo(world, start_W, radius);
  if (world.bounds().contains(start_W) && clearance >= radius && !no_go) return;
  std::ostringstream text;
  text << "a robot of radius " << radius << " m does not fit at the start " << start_W.transpose();
  if (no_go) {
    text << ": it would be in a no-go box";
  } else if (world.bounds().contains(start_W)) {
    text << ": the nearest surface is " << clearance << " m away";
  } else {
    text << ": it is outside the bounds";
  }
  throw std::invalid_argument(text.str());
}

DenseGrid<std::uint8_t> ReachableVoxels(const World& world, const Eigen::Vector3d& start_W, double radius,
                                        double voxel_size) {
  CheckStart(world, start_W, radius);
  return ReachableFill(world, VoxelsWithin(world.bounds(), voxel_size), radius, voxel_size).From(start_W);
}

std::vector<Eigen::Vector3d> StartPlaces(const World& world, const Eigen::Vector3d& start_W, double radius,
                                         double clearance) {
  const double voxel_size = radius;  // fine enough not to lose a passage the robot fits through well
  const DenseGrid<std::uint8_t> reachable = ReachableVoxels(world, start_W, radius, voxel_size);
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < reachable.size(); ++i) {
    if (!reachable[i]) continue;
    const Eigen::Vector3d place = VoxelCenter(reachable.IndexAt(i), voxel_size);
    if (world.DistanceToSurface(place, clearance) >= clearance) places.push_back(place);
  }
  if (places.empty()) {
    throw std::invalid_argument("no place with a clearance of " + std::to_string(clearance) +
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

RigidTransform RandomStart(const World& world, const Eigen::Vector3d& start_W, double radius,
                           double clearance, std::uint32_t seed) {
  return RandomStart(StartPlaces(world, start_W, radius, clearance), seed);
}

}  // namespace thalweg::simulator
