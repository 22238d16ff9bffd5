#include "services/explorer/core/view/view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/angles.h"
#include "common/geometry/spread_directions.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"
#include "services/explorer/core/map/frontier.h"

namespace thalweg::explorer {
namespace {

constexpr std::size_t kHeadings = 16;
constexpr double kHeadingStep = 2.0 * std::numbers::pi / kHeadings;  // [rad]

constexpr double kElevationStep = 25.0 * kDegree;

/// [rad] From the lowest to the highest.
std::vector<double> ElevationsOf(const RobotModel& robot) {
  if (robot.level()) return {0.0};
  std::vector<double> elevations;
  if (robot.turns_freely()) {
    for (int n = -3; n <= 3; ++n) elevations.push_back(n * kElevationStep);
    return elevations;
  }
  const double range = robot.gimbal_highest - robot.gimbal_lowest;
  const int steps = static_cast<int>(std::ceil(range / kElevationStep - 1e-9));
  for (int n = 0; n <= steps; ++n)
    elevations.push_back(robot.gimbal_lowest + (steps > 0 ? range * n / steps : 0.0));
  return elevations;
}

double LeastCosine(const PinholeCamera& camera) {
  constexpr double kRounding = 1e-9;
  double least = 1.0;
  for (const double u : {-0.5, camera.width_px - 0.5}) {
    for (const double v : {-0.5, camera.height_px - 0.5})
      least = std::min(least, 1.0 / camera.RayAtUnitDepth(u, v).norm());
  }
  return least - kRounding;
}

}  // namespace

std::vector<Sighting> SightingsFrom(const PlanningMap& map, const Eigen::Vector3d& p_W, double range) {
  std::vector<Sighting> sightings;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(range);
  const VoxelBox around{map.IndexOf(p_W - reach), map.IndexOf(p_W + reach) + VoxelIndex{1, 1, 1}};
  ForEachVoxel(Intersection(around, map.box()), [&](const VoxelIndex& i) {
    if ((map.states()[i] != VoxelState::kUnknown && !map.Doubtful(i)) || !IsTarget(map, i)) return;
    const Eigen::Vector3d center = map.CenterOf(i);
    if ((center - p_W).squaredNorm() > range * range || !map.InSight(p_W, center)) return;
    sightings.push_back({i, center - p_W});
  });
  return sightings;
}

std::vector<std::vector<RayStep>> SpreadRays(std::size_t count, double range, double voxel_size) {
  const Eigen::Vector3d center = VoxelCenter({0, 0, 0}, voxel_size);
  std::vector<std::vector<RayStep>> rays;
  for (const Eigen::Vector3d& direction : SpreadDirections(count)) {
    std::vector<RayStep>& ray = rays.emplace_back();
    TraverseVoxels(center, center + range * direction, voxel_size, [&](const VoxelIndex& i) {
      if (!(i == VoxelIndex{0, 0, 0})) ray.push_back({i, (VoxelCenter(i, voxel_size) - center).norm()});
      return true;
    });
  }
  return rays;
}

ViewPlanner::ViewPlanner(const PinholeCamera& camera, const RobotModel& robot)
    : camera_(camera), robot_(robot), R_BC_(robot.T_BC.linear()), least_cosine_(LeastCosine(camera)) {
  // An image that is pitched up by 25 deg is narrower at the horizon.
  const bool is_wide =
      0.5 * camera.width_px / camera.fx >= std::tan(kHeadingStep) / std::cos(kElevationStep) &&
      0.5 * camera.height_px / camera.fy >= std::tan(kElevationStep);
  std::size_t row = 0;
  for (const double elevation : ElevationsOf(robot)) {
    for (std::size_t heading = 0; heading < kHeadings; ++heading) {
      candidates_.push_back(
          RotationFromYawPitch(static_cast<double>(heading) * 2.0 * std::numbers::pi / kHeadings, elevation));
      cameras_.push_back(candidates_.back() * R_BC_);
      if (robot.turns_freely() && is_wide && (heading % 2 != 0 || row % 2 != 0)) continue;
      sparse_.push_back(candidates_.back());
      sparse_cameras_.push_back(cameras_.back());
    }
    ++row;
  }
}

BitTable ViewPlanner::ShownBySparse(const std::vector<Eigen::Vector3d>& offsets_W) const {
  BitTable shown(sparse_.size(), offsets_W.size());
  for (std::size_t n = 0; n < offsets_W.size(); ++n) {
    const double length = offsets_W[n].norm();
    for (std::size_t k = 0; k < sparse_.size(); ++k) {
      if (InImage(sparse_cameras_[k], offsets_W[n], length)) shown.Set(k, n);
    }
  }
  return shown;
}

bool ViewPlanner::CanShow(const Eigen::Vector3d& offset_W) const {
  if (robot_.turns_freely()) return true;  // the elevations reach all around
  // The heading that most likely shows it is tried first.
  const double length = offset_W.norm();
  const double heading = std::atan2(offset_W.y(), offset_W.x()) / kHeadingStep;
  const auto first = static_cast<std::size_t>(std::lround(heading) + std::ptrdiff_t{kHeadings});
  for (std::size_t n = 0; n < kHeadings; ++n) {
    for (std::size_t row = 0; row < cameras_.size(); row += kHeadings) {
      if (InImage(cameras_[row + (first + n) % kHeadings], offset_W, length)) return true;
    }
  }
  return false;
}

View ViewPlanner::Best(const std::vector<Sighting>& sightings, const std::vector<bool>& counts,
                       const std::vector<bool>& required, const Eigen::Matrix3d& R_WB) const {
  std::vector<double> lengths;
  lengths.reserve(sightings.size());
  for (const Sighting& sighting : sightings) lengths.push_back(sighting.offset_W.norm());
  View best{R_WB};
  double best_turn = 0.0;
  bool first = true;
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const Eigen::Matrix3d& candidate = candidates_[k];
    View view{candidate};
    for (std::size_t n = 0; n < sightings.size(); ++n) {
      const bool is_required = !required.empty() && required[n];
      if ((!counts[n] && !is_required) || !InImage(cameras_[k], sightings[n].offset_W, lengths[n])) continue;
      view.count += counts[n] ? 1U : 0U;
      view.required += is_required ? 1U : 0U;
    }
    const double turn = Eigen::AngleAxisd(R_WB.transpose() * candidate).angle();
    const bool better = view.required != best.required ? view.required > best.required
                        : view.count != best.count     ? view.count > best.count
                                                       : turn < best_turn;
    if (first || better) {
      best = view;
      best_turn = turn;
      first = false;
    }
  }
  return best;
}

}  // namespace thalweg::explorer
