#include "services/simulator/core/visibility.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/spread_directions.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"

namespace thalweg::simulator {
namespace {

constexpr double kNearRadius = 0.7;     // [m] search radius for the nearest positions
constexpr std::size_t kNearest = 8;     // number of positions tried first
constexpr double kSpreadCosine = 0.94;  // their directions differ by at least 20 deg
constexpr int kFanRays = 128;
constexpr int kLevelFanRays = 512;     // of which a level camera has those between its lowest and highest ray
constexpr int kLevelDirections = 64;   // in the level camera's fan
constexpr double kLevelSpacing = 0.1;  // between its positions, as a share of the distance
constexpr double kOnSurface = 1e-3;    // [m] a ray that ends within this distance of a point has hit it
constexpr double kStraightUp = 0.5 * std::numbers::pi - 1e-6;  // [rad]
constexpr std::size_t kMostPatches = 12;                       // per voxel, largest first

std::vector<VoxelIndex> OffsetsByDistance(int reach) {
  std::vector<VoxelIndex> offsets;
  const auto squared = [](const VoxelIndex& i) { return i.x * i.x + i.y * i.y + i.z * i.z; };
  ForEachVoxel(CubeAround({0, 0, 0}, reach), [&](const VoxelIndex& i) {
    if (squared(i) <= reach * reach) offsets.push_back(i);
  });
  std::stable_sort(offsets.begin(), offsets.end(),
                   [&](const VoxelIndex& a, const VoxelIndex& b) { return squared(a) < squared(b); });
  return offsets;
}

std::optional<SurfacePatch> PatchOf(const Triangle& triangle, const Eigen::AlignedBox3d& box) {
  const std::vector<Eigen::Vector3d> polygon = ClipToBox(triangle, box);
  if (polygon.size() < 3) return std::nullopt;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : polygon) center += corner / static_cast<double>(polygon.size());
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    area += 0.5 * (polygon[i] - center).cross(polygon[(i + 1) % polygon.size()] - center);
  }
  const Eigen::Vector3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
  SurfacePatch patch{{center}, normal, area.norm()};
  for (const Eigen::Vector3d& corner : polygon) patch.aims.push_back(0.1 * center + 0.9 * corner);
  return patch;
}

}  // namespace

std::vector<SurfacePatch> PatchesIn(const Eigen::AlignedBox3d& box, const Mesh& mesh,
                                    const std::vector<std::uint32_t>& triangles) {
  std::vector<SurfacePatch> patches;
  for (const std::uint32_t index : triangles) {
    if (auto patch = PatchOf(TriangleOf(mesh, index), box)) patches.push_back(std::move(*patch));
  }
  std::stable_sort(patches.begin(), patches.end(),
                   [](const SurfacePatch& a, const SurfacePatch& b) { return a.area > b.area; });
  if (patches.size() > kMostPatches) patches.resize(kMostPatches);
  return patches;
}

bool SeesAim(const World& world, const Eigen::AlignedBox3d& box, const Eigen::Vector3d& eye_W,
             const Eigen::Vector3d& aim_W, double view_range) {
  const Eigen::Vector3d offset = aim_W - eye_W;
  const double length = offset.norm();
  const Eigen::Vector3d direction = offset / length;
  const auto hit = world.CastRay(eye_W, direction, view_range);
  if (!hit) return false;
  return std::abs(hit->distance - length) <= kOnSurface || box.contains(eye_W + hit->distance * direction);
}

bool LevelCamera::Sees(const Eigen::Vector3d& position_W, const Eigen::Vector3d& target_W) const {
  const Eigen::Vector3d offset = target_W - position_W;
  const double away = offset.head<2>().norm();
  return offset.z() >= least_rise * away && offset.z() <= greatest_rise * away;
}

LevelCamera LevelCameraOf(const RobotModel& robot, const PinholeCamera& camera,
                          const Eigen::Vector3d& start_W) {
  const double pitch = std::asin(std::clamp(robot.T_BC.linear()(2, 2), -1.0, 1.0));
  // The middle column of the image reaches highest and lowest, and the robot can turn it to any side.
  const auto rise = [&](double v, double gimbal) {
    const double elevation = gimbal + pitch - std::atan((v - camera.cy) / camera.fy);
    return std::tan(std::clamp(elevation, -kStraightUp, kStraightUp));
  };
  return {.above_body = robot.T_BC.translation().z(),
          .plane_W = robot.drives ? std::optional(start_W.z()) : std::nullopt,
          .least_rise = rise(camera.height_px - 0.5, robot.PitchWithin(-kStraightUp)),
          .greatest_rise = rise(-0.5, robot.PitchWithin(kStraightUp))};
}

Visibility::Visibility(const World& world, const DenseGrid<std::uint8_t>& reachable, double voxel_size,
                       double view_range, const std::optional<LevelCamera>& level)
    : world_(world),
      reachable_(reachable),
      voxel_size_(voxel_size),
      view_range_(view_range),
      level_(level),
      near_offsets_(OffsetsByDistance(static_cast<int>(std::ceil(kNearRadius / voxel_size)))),
      fan_(SpreadDirections(level ? kLevelFanRays : kFanRays)) {
  // From a target toward the cameras that have it in view.
  if (level_) std::erase_if(fan_, [&](const auto& direction) { return !level_->Sees(direction, {0, 0, 0}); });
}

Eigen::Vector3d Visibility::PositionIn(const VoxelIndex& voxel) const {
  const Eigen::Vector3d center = VoxelCenter(voxel, voxel_size_);
  return level_ ? level_->EyeOf(center) : center;
}

bool Visibility::InView(const Eigen::Vector3d& position, const Eigen::Vector3d& target) const {
  return (target - position).norm() <= view_range_ && (!level_ || level_->Sees(position, target));
}

std::vector<Eigen::Vector3d> Visibility::NearestPositions(const Eigen::Vector3d& target) const {
  const VoxelIndex middle = VoxelAt(target, voxel_size_);
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3d> directions;
  for (const VoxelIndex& offset : near_offsets_) {
    const VoxelIndex voxel = middle + offset;
    if (!reachable_.Get(voxel, 0)) continue;
    const Eigen::Vector3d position = PositionIn(voxel);
    const Eigen::Vector3d direction = (position - target).normalized();
    const bool spread = std::none_of(directions.begin(), directions.end(), [&](const Eigen::Vector3d& other) {
      return other.dot(direction) > kSpreadCosine;
    });
    if (!spread || !InView(position, target)) continue;
    positions.push_back(position);
    directions.push_back(direction);
    if (positions.size() == kNearest) break;
  }
  return positions;
}

std::optional<Eigen::Vector3d> Visibility::FirstPositionOn(const Eigen::Vector3d& from,
                                                           const Eigen::Vector3d& to) const {
  std::optional<Eigen::Vector3d> found;
  // The line on which the body's center is when the camera is on the line.
  const Eigen::Vector3d down(0.0, 0.0, level_ ? -level_->above_body : 0.0);
  TraverseVoxels(from + down, to + down, voxel_size_, [&](const VoxelIndex& voxel) {
    if (!reachable_.Contains(voxel)) return level_.has_value();  // the lowered line may begin below the box
    if (!reachable_[voxel]) return true;
    const Eigen::Vector3d position = PositionIn(voxel);
    // A camera that turns freely needs no test: all of the line is within range.
    if (!level_ || InView(position, from)) found = position;
    return !found;
  });
  return found;
}

template <class Sees>
bool Visibility::TryFan(const Eigen::Vector3d& from, Sees&& sees) const {
  if (level_ && level_->plane_W) return TryFanInPlane(from, sees);
  return std::any_of(fan_.begin(), fan_.end(), [&](const Eigen::Vector3d& direction) {
    const auto hit = world_.CastRay(from, direction, view_range_);
    const double length = hit ? hit->distance : view_range_;
    const auto position = FirstPositionOn(from, from + length * direction);
    return position && sees(*position);
  });
}

template <class Sees>
bool Visibility::TryFanInPlane(const Eigen::Vector3d& from, Sees&& sees) const {
  const int layer = VoxelAt({0.0, 0.0, *level_->plane_W}, voxel_size_).z;
  for (int n = 0; n < kLevelDirections; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kLevelDirections;
    const Eigen::Vector3d direction(std::cos(angle), std::sin(angle), 0.0);
    for (double away = 0.0; away <= view_range_; away += std::max(voxel_size_, kLevelSpacing * away)) {
      VoxelIndex voxel = VoxelAt(from + away * direction, voxel_size_);
      voxel.z = layer;
      if (reachable_.Get(voxel, 0) && sees(PositionIn(voxel))) return true;
    }
  }
  return false;
}

bool Visibility::SeesPoint(const Eigen::Vector3d& target) const {
  const auto sees = [&](const Eigen::Vector3d& position) {
    return InView(position, target) && world_.InSight(position, target);
  };
  const auto nearest = NearestPositions(target);
  return std::any_of(nearest.begin(), nearest.end(), sees) || TryFan(target, sees);
}

bool Visibility::SeesSurface(const Eigen::AlignedBox3d& box,
                             const std::vector<std::uint32_t>& triangles) const {
  const std::vector<SurfacePatch> patches = PatchesIn(box, world_.mesh(), triangles);
  const auto sees_aim = [&](const Eigen::Vector3d& position, const Eigen::Vector3d& aim) {
    return InView(position, aim) && SeesAim(world_, box, position, aim, view_range_);
  };
  const auto nearest = NearestPositions(box.center());
  for (const Eigen::Vector3d& position : nearest) {
    for (const SurfacePatch& patch : patches) {
      for (const Eigen::Vector3d& aim : patch.aims) {
        if (sees_aim(position, aim)) return true;
      }
    }
  }
  for (const SurfacePatch& patch : patches) {
    for (const double side : {kOnSurface, -kOnSurface}) {
      const Eigen::Vector3d before = patch.aims.front() + side * patch.normal;
      if (TryFan(before, [&](const Eigen::Vector3d& p) { return sees_aim(p, patch.aims.front()); })) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace thalweg::simulator
