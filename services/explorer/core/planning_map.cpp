#include "services/explorer/core/planning_map.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "common/voxel/ray.h"
#include "common/voxel/voxels_within.h"

namespace thalweg::explorer {
namespace {

/// More than any reach, so that a voxel that made the map grow lies well inside.
constexpr int kGrowthVoxels = 32;

/// [voxels] from the centre of voxel 0 to the cube of voxel i.
double DistanceToCube(const VoxelIndex& i) {
  const auto gap = [](int d) { return std::max(0.0, std::abs(d) - 0.5); };
  return std::hypot(gap(i.x), gap(i.y), gap(i.z));
}

/// Voxels whose centre lies in the box.
VoxelBox VoxelsIn(const Eigen::AlignedBox3d& box, double voxel_size) {
  const auto first = [&](double v) { return static_cast<int>(std::ceil(v / voxel_size - 0.5 - 1e-9)); };
  const auto end = [&](double v) { return static_cast<int>(std::floor(v / voxel_size - 0.5 + 1e-9)) + 1; };
  return {{first(box.min().x()), first(box.min().y()), first(box.min().z())},
          {end(box.max().x()), end(box.max().y()), end(box.max().z())}};
}

VoxelBox Dilated(const VoxelBox& box, int by) {
  return {box.min - VoxelIndex{by, by, by}, box.max + VoxelIndex{by, by, by}};
}

}  // namespace

PlanningMap::PlanningMap(const Options& options) : options_(options) {
  if (!(options.voxel_size > 0.0)) throw std::invalid_argument("voxel_size must be > 0");
  if (!(options.clearance > 0.0)) throw std::invalid_argument("clearance must be > 0");
  const double clearance_voxels = options.clearance / options.voxel_size;
  reach_ = static_cast<int>(std::ceil(clearance_voxels + 0.5));
  for (int z = -reach_; z <= reach_; ++z) {
    for (int y = -reach_; y <= reach_; ++y) {
      for (int x = -reach_; x <= reach_; ++x) {
        if (DistanceToCube({x, y, z}) < clearance_voxels - 1e-9) blocking_.push_back({x, y, z});
      }
    }
  }
  for (const Eigen::AlignedBox3d& box : options.no_go) {
    no_go_.push_back(VoxelsWithin(box, options.voxel_size));
  }
  if (options.bounds) {
    bounds_ = VoxelsIn(*options.bounds, options.voxel_size);
    if (bounds_.count() == 0) throw std::invalid_argument("bounds hold no voxel");
    const VoxelBox box = Dilated(bounds_, reach_);
    if (box.count() > options.max_voxels) {
      throw std::invalid_argument("bounds hold more than " + std::to_string(options.max_voxels) + " voxels");
    }
    Rebuild(box);
  } else {
    constexpr int kFar = kMaxVoxelIndex;
    bounds_ = {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  }
}

void PlanningMap::Rebuild(const VoxelBox& box) {
  const DenseGrid<VoxelState> old = std::move(states_);
  states_ = DenseGrid<VoxelState>(box, VoxelState::kUnknown);
  blockers_ = DenseGrid<std::uint16_t>(box, static_cast<std::uint16_t>(blocking_.size()));
  traversable_count_ = 0;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    if (!bounds_.Contains(states_.IndexAt(k))) ++blockers_[k];
  }
  for (const VoxelBox& no_go : no_go_) {
    const VoxelBox reached = Dilated(no_go, reach_);  // beyond it nothing is blocked
    VoxelIndex i;
    for (i.z = std::max(box.min.z, reached.min.z); i.z < std::min(box.max.z, reached.max.z); ++i.z) {
      for (i.y = std::max(box.min.y, reached.min.y); i.y < std::min(box.max.y, reached.max.y); ++i.y) {
        for (i.x = std::max(box.min.x, reached.min.x); i.x < std::min(box.max.x, reached.max.x); ++i.x) {
          const bool blocked = std::any_of(blocking_.begin(), blocking_.end(), [&](const VoxelIndex& offset) {
            return no_go.Contains(i + offset);
          });
          if (blocked) ++blockers_[i];
        }
      }
    }
  }
  for (std::size_t k = 0; k < old.size(); ++k) {
    if (old[k] != VoxelState::kUnknown) SetState(old.IndexAt(k), old[k]);
  }
}

bool PlanningMap::NoGoAmong(const VoxelIndex& i) const {
  return std::any_of(no_go_.begin(), no_go_.end(), [&](const VoxelBox& box) { return box.Contains(i); });
}

/// False when the box would be too large.
bool PlanningMap::Grow(const VoxelIndex& include) {
  VoxelBox box = states_.size() == 0 ? VoxelBox{include, include + VoxelIndex{1, 1, 1}} : states_.box();
  const auto stretch = [this](int v, int& low, int& high) {
    if (v < low + reach_) low = v - kGrowthVoxels;
    if (v >= high - reach_) high = v + 1 + kGrowthVoxels;
  };
  stretch(include.x, box.min.x, box.max.x);
  stretch(include.y, box.min.y, box.max.y);
  stretch(include.z, box.min.z, box.max.z);
  if (box.count() > options_.max_voxels) return false;
  Rebuild(box);
  return true;
}

void PlanningMap::Block(const VoxelIndex& i, int by) {
  for (const VoxelIndex& offset : blocking_) {
    const VoxelIndex blocked = i + offset;
    if (!blockers_.Contains(blocked)) continue;
    const std::size_t k = blockers_.Offset(blocked);
    const bool was = Traversable(k);
    blockers_[k] = static_cast<std::uint16_t>(blockers_[k] + by);
    const bool is = Traversable(k);
    if (was != is) traversable_count_ += is ? 1U : static_cast<std::size_t>(-1);
  }
}

void PlanningMap::SetState(const VoxelIndex& i, VoxelState now) {
  const std::size_t k = states_.Offset(i);
  const VoxelState before = states_[k];
  states_[k] = now;
  if ((before == VoxelState::kFree) != (now == VoxelState::kFree)) {
    Block(i, now == VoxelState::kFree ? -1 : 1);
  }
}

std::span<const PlanningMap::StateChange> PlanningMap::Apply(std::span<const VoxelChange> changes) {
  changes_.clear();
  for (const VoxelChange& change : changes) {
    if (options_.bounds ? !states_.Contains(change.voxel) : !Dilated(box(), -reach_).Contains(change.voxel)) {
      if (options_.bounds) continue;
      if (!Grow(change.voxel)) {
        ++beyond_limit_;
        continue;
      }
    }
    const VoxelState before = states_[change.voxel];
    const VoxelState now = OccupancyGrid::StateOf(change.log_odds);
    if (before == now) continue;
    SetState(change.voxel, now);
    changes_.push_back({change.voxel, before, now});
  }
  return changes_;
}

void PlanningMap::Reset() {
  states_ = {};
  if (options_.bounds) {
    Rebuild(blockers_.box());
  } else {
    blockers_ = {};
    traversable_count_ = 0;
  }
}

double PlanningMap::ClearanceAt(const Eigen::Vector3d& p_W, Obstacles obstacles, double limit) const {
  const double size = voxel_size();
  const VoxelIndex low = IndexOf(p_W - Eigen::Vector3d::Constant(limit));
  const VoxelIndex high = IndexOf(p_W + Eigen::Vector3d::Constant(limit));
  double least = limit * limit;
  const auto gap = [size](int i, double p) { return std::max({0.0, i * size - p, p - (i + 1) * size}); };
  for (int z = low.z; z <= high.z; ++z) {
    const double dz = gap(z, p_W.z());
    for (int y = low.y; y <= high.y; ++y) {
      const double dy = gap(y, p_W.y());
      const double dyz = dy * dy + dz * dz;
      if (dyz >= least) continue;
      for (int x = low.x; x <= high.x; ++x) {
        if (!NoGo({x, y, z})) {
          const VoxelState state = State({x, y, z});
          if (state == VoxelState::kFree) continue;
          if (state == VoxelState::kUnknown && obstacles == Obstacles::kOccupied) continue;
        }
        const double dx = gap(x, p_W.x());
        least = std::min(least, dx * dx + dyz);
      }
    }
  }
  return std::sqrt(least);
}

bool PlanningMap::SegmentClear(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                               double clearance) const {
  const double length = (b_W - a_W).norm();
  const double finest = 0.25 * voxel_size();
  const double limit = clearance + voxel_size();
  for (double at = 0.0;;) {
    const Eigen::Vector3d p = length > 0.0 ? Eigen::Vector3d(a_W + (b_W - a_W) * (at / length)) : a_W;
    const double here = ClearanceAt(p, obstacles, limit);
    if (here < clearance - 1e-9) return false;
    if (at >= length) return true;
    // Clearance changes by no more than the way gone.
    at = std::min(length, at + std::max(finest, here - clearance));
  }
}

double PlanningMap::SegmentClearance(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W,
                                     Obstacles obstacles, double limit) const {
  const double length = (b_W - a_W).norm();
  const int pieces = static_cast<int>(std::ceil(length / (0.125 * voxel_size())));
  double least = limit;
  for (int piece = 0; piece <= pieces; ++piece) {
    const double share = pieces > 0 ? static_cast<double>(piece) / pieces : 0.0;
    least = std::min(least, ClearanceAt(a_W + share * (b_W - a_W), obstacles, least));
  }
  return least;
}

bool PlanningMap::InSight(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const {
  const VoxelIndex first = IndexOf(a_W);
  const VoxelIndex last = IndexOf(b_W);
  return TraverseVoxels(a_W, b_W, voxel_size(), [&](const VoxelIndex& i) {
    return i == first || i == last || State(i) == VoxelState::kFree;
  });
}

}  // namespace thalweg::explorer
