#include "services/explorer/core/knowledge.h"

#include <stdexcept>

#include "common/base/angles.h"
#include "common/voxel/for_each_voxel.h"

namespace thalweg::explorer {
namespace {

/// Scans from nearly the same pose show nothing new.
constexpr double kSameScanPosition = 0.05;        // [m]
constexpr double kSameScanAngle = 5.0 * kDegree;  // [rad]

}  // namespace

Knowledge::Knowledge(const Options& options)
    : options_(options), map_(options.map), memory_(options.memory), views_(options.camera, options.robot) {
  if (!(options.look_range > 0.0)) throw std::invalid_argument("look_range must be > 0");
  if (!(options.min_measured_share >= 0.0 && options.min_measured_share <= 1.0))
    throw std::invalid_argument("min_measured_share must be 0 to 1");
  if (options.memory.looks < 1) throw std::invalid_argument("looks_before_set_aside must be >= 1");
  memory_.Cover(map_.box());
}

void Knowledge::Reset() {
  map_.Reset();
  memory_.Cover(map_.box());
  memory_.Clear();
  if (inspected_) inspected_->Clear();
  counted_T_WC_.reset();
  last_scan_.reset();
}

void Knowledge::Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now) {
  Follow(map_.Apply(changes));
  for (const ScanView& scan : scans) {
    const RigidTransform& T_WC = scan.T_WC;
    if (counted_T_WC_ && (counted_T_WC_->translation() - T_WC.translation()).norm() < kSameScanPosition &&
        AngleBetween(*counted_T_WC_, T_WC) < kSameScanAngle) {
      continue;
    }
    counted_T_WC_ = T_WC;
    const Eigen::Matrix3d R_WB = T_WC.linear() * options_.robot.T_BC.linear().transpose();
    for (const Sighting& sighting : SightingsFrom(map_, T_WC.translation(), options_.look_range)) {
      if (!views_.Shows(R_WB, sighting)) continue;
      const Sensed sensed = SensedBy(scan, sighting.voxel).value_or(Sensed::kDepth);
      memory_.Look(sighting.voxel, T_WC.translation(), sensed, now);
    }
    if (inspected_) inspected_->See(map_, scan);
  }
  if (!scans.empty()) last_scan_ = scans.back();
}

void Knowledge::Occupy(const Eigen::Vector3d& p_W) {
  Follow(map_.Vacate(p_W, options_.robot.radius));
}

void Knowledge::Follow(std::span<const PlanningMap::StateChange> changes) {
  memory_.Cover(map_.box());
  memory_.Follow(changes);
  if (inspected_) inspected_->Follow(map_, changes);
}

void Knowledge::Inspect(const std::optional<InspectionCriterion>& criterion) {
  if (!criterion) return inspected_.reset();
  inspected_.emplace(*criterion, options_.camera, options_.min_measured_share);
  inspected_->Follow(map_, {});
}

RigidTransform Knowledge::InPlane(const RigidTransform& T_WB) {
  if (!options_.robot.drives) return T_WB;
  if (!map_.plane()) {
    map_.SetPlane(T_WB.translation().z());
    Follow({});
  }
  RigidTransform level = T_WB;
  level.translation().z() = *map_.plane();
  return level;
}

bool Knowledge::KnowsPlace(const RigidTransform& T_WB) const {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(options_.reach);
  const Eigen::Vector3d eye_W = map_.EyeAt(T_WB.translation());
  const VoxelBox around{map_.IndexOf(eye_W - reach), map_.IndexOf(eye_W + reach) + VoxelIndex{1, 1, 1}};
  return !ForEachVoxel(around, [&](const VoxelIndex& i) { return map_.State(i) != VoxelState::kFree; });
}

std::optional<Sensed> Knowledge::SensedBy(const ScanView& scan, const VoxelIndex& i) const {
  if (!scan.measured) return std::nullopt;
  const Eigen::Vector3d p_C = scan.T_WC.inverse() * map_.CenterOf(i);
  const std::optional<double> share = scan.measured->At(options_.camera, p_C);
  if (!share) return std::nullopt;
  return *share < options_.min_measured_share ? Sensed::kNothing : Sensed::kDepth;
}

std::optional<Sensed> Knowledge::LastSensed(const VoxelIndex& i) const {
  return last_scan_ ? SensedBy(*last_scan_, i) : std::nullopt;
}

std::vector<Sighting> Knowledge::SightingsFromBody(const Eigen::Vector3d& p_W) const {
  return SightingsFrom(map_, map_.EyeAt(p_W), options_.look_range);
}

}  // namespace thalweg::explorer
