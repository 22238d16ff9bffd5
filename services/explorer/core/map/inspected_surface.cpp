#include "services/explorer/core/map/inspected_surface.h"

#include <numbers>
#include <stdexcept>
#include <utility>

#include "common/voxel/moved_grid.h"

namespace thalweg::explorer {
namespace {

Eigen::Vector3d DirectionOf(std::uint8_t side) {
  const VoxelIndex& step = kFaceNeighbors[side];
  return {static_cast<double>(step.x), static_cast<double>(step.y), static_cast<double>(step.z)};
}

bool Exists(const PlanningMap& map, const Facet& facet) {
  return map.State(facet.voxel) == VoxelState::kOccupied && map.State(facet.before()) == VoxelState::kFree;
}

}  // namespace

Eigen::Vector3d CenterOf(const PlanningMap& map, const Facet& facet) {
  return map.CenterOf(facet.voxel) + 0.5 * map.voxel_size() * DirectionOf(facet.side);
}

InspectedSurface::InspectedSurface(const InspectionCriterion& criterion, const PinholeCamera& camera,
                                   double min_measured_share)
    : criterion_(criterion),
      least_cosine_(criterion.least_cosine()),
      camera_(camera),
      min_measured_share_(min_measured_share) {
  if (!(criterion.distance > 0.0)) throw std::invalid_argument("the inspection's distance must be > 0");
  if (!(criterion.max_angle > 0.0 && criterion.max_angle < 0.5 * std::numbers::pi))
    throw std::invalid_argument("the inspection's angle must be between 0 and 90 degrees");
}

void InspectedSurface::Clear() {
  inspected_ = settled_ = tried_ = {};
  normals_.clear();
}

std::vector<VoxelIndex> InspectedSurface::BlocksChangedSince(std::uint64_t revision) const {
  std::vector<VoxelIndex> blocks;
  for (const auto& [block, changed_at] : changed_at_) {
    if (changed_at > revision) blocks.push_back(block);
  }
  return blocks;
}

void InspectedSurface::Follow(const PlanningMap& map, std::span<const PlanningMap::StateChange> changes) {
  if (!(inspected_.box() == map.box())) {
    for (DenseGrid<std::uint8_t>* grid : {&inspected_, &settled_, &tried_})
      *grid = MovedTo(*grid, map.box(), std::uint8_t{0});
  }
  ++revision_;
  for (const PlanningMap::StateChange& change : changes) {
    if (change.before == change.now) continue;
    if (change.before == VoxelState::kOccupied) {
      for (DenseGrid<std::uint8_t>* grid : {&inspected_, &settled_, &tried_}) (*grid)[change.voxel] = 0;
    }
    changed_at_[OccupancyGrid::BlockOf(change.voxel)] = revision_;
    ForEachVoxel(CubeAround(change.voxel, kChangeReach), [&](const VoxelIndex& i) { normals_.erase(i); });
  }
}

const InspectedSurface::Normal& InspectedSurface::NormalOf(const PlanningMap& map, const Facet& facet) {
  const auto [known, is_new] = normals_.try_emplace(facet.voxel);
  if (is_new) known->second.fill(Normal::Zero());
  Normal& normal = known->second[facet.side];
  if (!normal.isZero()) return normal;
  // The free voxels around it that are connected with the one before it.
  const VoxelBox around = CubeAround(facet.voxel, kNormalReach);
  DenseGrid<std::uint8_t> same(around, 0);
  std::vector<VoxelIndex> free = {facet.before()};
  same[facet.before()] = 1;
  const VoxelIndex& toward = kFaceNeighbors[facet.side];
  for (std::size_t n = 0; n < free.size(); ++n) {
    for (const VoxelIndex& step : kFaceNeighbors) {
      const VoxelIndex next = free[n] + step;
      if (!around.Contains(next)) continue;
      const VoxelState state = map.State(next);
      if (state == VoxelState::kFree && std::exchange(same[next], 1) == 0) free.push_back(next);
      // Next is behind the facet that faces the voxel before it, against the step.
      const int along = -(step.x * toward.x + step.y * toward.y + step.z * toward.z);
      if (state == VoxelState::kOccupied && along >= 0)
        normal -= Eigen::Vector3i(step.x, step.y, step.z).cast<float>();
    }
  }
  normal.normalize();
  return normal;
}

bool InspectedSurface::InspectableFrom(const PlanningMap& map, const Eigen::Vector3d& eye_W,
                                       const Facet& facet) {
  const Eigen::Vector3d center_W = CenterOf(map, facet);
  const Eigen::Vector3d to_eye_W = eye_W - center_W;
  if (to_eye_W.dot(DirectionOf(facet.side)) <= 0.0) return false;
  // The surface itself lies anywhere in the voxel, up to its far side.
  const double distance = to_eye_W.norm();
  if (distance + map.voxel_size() > criterion_.distance) return false;
  if (NormalOf(map, facet).cast<double>().dot(to_eye_W) < least_cosine_ * distance) return false;
  return map.InSight(eye_W, map.CenterOf(facet.before()));
}

void InspectedSurface::See(const PlanningMap& map, const ScanView& scan) {
  const Eigen::Vector3d eye_W = scan.T_WC.translation();
  const RigidTransform T_CW = scan.T_WC.inverse();
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(criterion_.distance);
  const VoxelBox around{map.IndexOf(eye_W - reach), map.IndexOf(eye_W + reach) + VoxelIndex{1, 1, 1}};
  ForEachVoxel(Intersection(around, map.box()), [&](const VoxelIndex& i) {
    if (map.states()[i] != VoxelState::kOccupied) return;
    for (std::uint8_t side = 0; side < kFacetSides; ++side) {
      const Facet facet{i, side};
      if ((inspected_[i] & Bit(facet)) != 0 || !Exists(map, facet)) continue;
      const Eigen::Vector3d p_C = T_CW * CenterOf(map, facet);
      if (!camera_.Sees(p_C) || !InspectableFrom(map, eye_W, facet)) continue;
      if (scan.measured && scan.measured->At(camera_, p_C).value_or(0.0) < min_measured_share_) continue;
      inspected_[i] = static_cast<std::uint8_t>(inspected_[i] | Bit(facet));
      settled_[i] = static_cast<std::uint8_t>(settled_[i] | Bit(facet));
    }
  });
}

bool InspectedSurface::Open(const PlanningMap& map, const Facet& facet) const {
  return (settled_.Get(facet.voxel, 0) & Bit(facet)) == 0 && Exists(map, facet);
}

std::vector<Facet> InspectedSurface::OpenFacets(const PlanningMap& map) const {
  std::vector<Facet> open;
  const VoxelBox& box = settled_.box();
  const VoxelBox inner{box.min + VoxelIndex{1, 1, 1}, box.max - VoxelIndex{1, 1, 1}};
  ForEachVoxel(inner, [&](const VoxelIndex& i) {
    if (map.states()[i] != VoxelState::kOccupied || settled_[i] == (1U << kFacetSides) - 1U) return;
    for (std::uint8_t side = 0; side < kFacetSides; ++side) {
      const Facet facet{i, side};
      if (Open(map, facet) && map.InBounds(facet.before())) open.push_back(facet);
    }
  });
  return open;
}

void InspectedSurface::CountTry(const Facet& facet) {
  if (!tried_.Contains(facet.voxel)) return;
  std::uint8_t& tried = tried_[facet.voxel];
  std::uint8_t& settled = settled_[facet.voxel];
  if ((tried & Bit(facet)) != 0) settled = static_cast<std::uint8_t>(settled | Bit(facet));
  tried = static_cast<std::uint8_t>(tried | Bit(facet));
}

InspectedSurface::Area InspectedSurface::MeasureArea(const PlanningMap& map) const {
  std::size_t all = 0;
  std::size_t inspected = 0;
  ForEachVoxel(map.box(), [&](const VoxelIndex& i) {
    if (map.states()[i] != VoxelState::kOccupied) return;
    for (std::uint8_t side = 0; side < kFacetSides; ++side) {
      const Facet facet{i, side};
      if (!Exists(map, facet)) continue;
      ++all;
      if ((inspected_.Get(i, 0) & Bit(facet)) != 0) ++inspected;
    }
  });
  const double area = map.voxel_size() * map.voxel_size();
  return {static_cast<double>(all) * area, static_cast<double>(inspected) * area};
}

}  // namespace thalweg::explorer
