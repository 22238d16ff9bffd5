#include "services/explorer/core/map/planning_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/check.h"
#include "common/base/simd.h"
#include "common/geometry/interval.h"
#include "common/geometry/polyline.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"

namespace thalweg::explorer {
namespace {

/// More than any reach, so that a voxel that makes the map grow lies well inside the new box.
constexpr int kGrowthVoxels = 32;

/// Distance [voxels] along one axis from the center of voxel 0 to the cube of voxel d.
double DistanceToCube(int d) {
  return DistanceToInterval(0.0, d - 0.5, d + 0.5);
}

/// Tolerance for bodies that end exactly at a voxel's face [voxels, m].
constexpr double kTouch = 1e-9;

/// The voxels whose centers lie in the box.
VoxelBox VoxelsIn(const Eigen::AlignedBox3d& box, double voxel_size) {
  const auto first = [&](double v) { return static_cast<int>(std::ceil(v / voxel_size - 0.5 - 1e-9)); };
  const auto end = [&](double v) { return static_cast<int>(std::floor(v / voxel_size - 0.5 + 1e-9)) + 1; };
  return {{first(box.min().x()), first(box.min().y()), first(box.min().z())},
          {end(box.max().x()), end(box.max().y()), end(box.max().z())}};
}

/// sums += a - b
THALWEG_SIMD_CLONES
void AddDifferences(const std::uint16_t* a, const std::uint16_t* b, std::size_t count, std::uint16_t* sums) {
  for (std::size_t k = 0; k < count; ++k) sums[k] = static_cast<std::uint16_t>(sums[k] + a[k] - b[k]);
}

VoxelBox Dilated(const VoxelBox& box, int by) {
  return {box.min - VoxelIndex{by, by, by}, box.max + VoxelIndex{by, by, by}};
}

}  // namespace

PlanningMap::PlanningMap(const Options& options) : options_(options) {
  if (!(options.voxel_size > 0.0)) throw std::invalid_argument("voxel_size must be > 0");
  if (!(options.clearance > 0.0)) throw std::invalid_argument("clearance must be > 0");
  if (!(options.half_height >= 0.0)) throw std::invalid_argument("half_height must be >= 0");
  if (!(options.doubt.max_log_odds >= 0.0)) throw std::invalid_argument("doubt.max_log_odds must be >= 0");
  if (!(options.doubt.weight > 0.0 && options.doubt.weight <= 1.0))
    throw std::invalid_argument("doubt.weight must be in (0, 1]");
  eye_layers_ = VoxelAt(EyeAt(CenterOf({0, 0, 0})), voxel_size()).z;
  FindBlocking();
  for (const Eigen::AlignedBox3d& box : options.no_go) {
    no_go_.push_back(VoxelsWithin(box, options.voxel_size));
  }
  if (options.bounds) {
    bounds_ = VoxelsIn(*options.bounds, options.voxel_size);
    if (bounds_.count() == 0) throw std::invalid_argument("bounds hold no voxel");
    const VoxelBox box = Dilated(LookedThrough(), reach_);
    if (box.count() > options.max_voxels) {
      throw std::invalid_argument("bounds hold more than " + std::to_string(options.max_voxels) + " voxels");
    }
    Rebuild(box);
  } else {
    constexpr int kFar = kMaxVoxelIndex;
    bounds_ = {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  }
}

void PlanningMap::FindBlocking() {
  const double radius = options_.clearance / options_.voxel_size;
  const double half_height = options_.half_height / options_.voxel_size;
  reach_ = static_cast<int>(std::ceil(std::max(radius, half_height) + 0.5));
  const auto blocks = [&](int x, int y, int z) {
    const double aside = std::hypot(DistanceToCube(x), DistanceToCube(y));
    if (plane_) return z == 0 && aside < radius - kTouch;
    if (half_height > 0.0) return aside < radius - kTouch && DistanceToCube(z) < half_height - kTouch;
    return std::hypot(aside, DistanceToCube(z)) < radius - kTouch;
  };
  blocking_.clear();
  ForEachVoxel(CubeAround({0, 0, 0}, reach_), [&](const VoxelIndex& offset) {
    if (blocks(offset.x, offset.y, offset.z)) blocking_.push_back(offset);
  });
}

void PlanningMap::SetPlane(double z_W) {
  if (!(options_.half_height > 0.0)) throw std::invalid_argument("a plane needs a half_height");
  plane_ = z_W;
  layer_ = VoxelAt({0.0, 0.0, z_W}, voxel_size()).z;
  eye_layers_ = VoxelAt(EyeAt({0.0, 0.0, z_W}), voxel_size()).z - layer_;
  const Eigen::Vector3d half(0.5 * voxel_size(), 0.5 * voxel_size(), options_.half_height);
  const Eigen::Vector3d middle(half.x(), half.y(), z_W);
  const VoxelBox band = VoxelsWithin({middle - half, middle + half}, voxel_size());
  bounds_.min.z = std::max(bounds_.min.z, band.min.z);
  bounds_.max.z = std::min(bounds_.max.z, band.max.z);
  FindBlocking();
  if (options_.bounds) {
    Rebuild(Dilated(LookedThrough(), reach_));
  } else if (states_.size() > 0) {
    VoxelBox box = states_.box();
    box.min.z = LookedThrough().min.z - reach_;
    box.max.z = LookedThrough().max.z + reach_;
    Rebuild(box);
  }
}

/// The bounds, extended to the cameras of all bodies inside them.
VoxelBox PlanningMap::LookedThrough() const {
  VoxelBox box = bounds_;
  box.min.z += std::min(0, eye_layers_);
  box.max.z += std::max(0, eye_layers_);
  return box;
}

bool PlanningMap::IsLookedThrough(const VoxelIndex& i) const {
  const VoxelBox box = LookedThrough();
  return i.z >= box.min.z && i.z < box.max.z;
}

bool PlanningMap::BlockedBy(const VoxelBox& no_go, const VoxelIndex& i) const {
  return std::any_of(blocking_.begin(), blocking_.end(), [&](const VoxelIndex& offset) {
    VoxelIndex at = i + offset;
    if (!plane_) return no_go.Contains(at);
    at.z = std::max(no_go.min.z, bounds_.min.z);  // the part of the box inside the band
    return at.z < bounds_.max.z && no_go.Contains(at);
  });
}

void PlanningMap::Rebuild(const VoxelBox& box) {
  const DenseGrid<VoxelState> old = std::move(states_);
  const DenseGrid<std::uint8_t> old_doubtful = std::move(doubtful_);
  const DenseGrid<std::uint8_t> old_weakly_free = std::move(weakly_free_);
  states_ = DenseGrid<VoxelState>(box, VoxelState::kUnknown);
  weakly_free_ = DenseGrid<std::uint8_t>(box, 0);
  doubtful_ = options_.doubt.max_log_odds > 0.0 ? DenseGrid<std::uint8_t>(box, 0) : DenseGrid<std::uint8_t>();
  for (std::size_t k = 0; k < old.size(); ++k) {
    if (old[k] == VoxelState::kUnknown) continue;
    const VoxelIndex i = old.IndexAt(k);
    if (plane_ && !IsLookedThrough(i)) continue;
    states_[i] = old[k];
    if (old_doubtful.Get(i, 0) != 0) doubtful_[i] = 1;
    weakly_free_[i] = old_weakly_free.Get(i, 0);
  }
  const int layers = plane_ ? bounds_.size_z() : 1;
  blockers_ = DenseGrid<std::uint16_t>(
      box, plane_ ? static_cast<std::uint16_t>(blocking_.size() * static_cast<unsigned>(layers)) : 0);
  if (plane_) {
    for (std::size_t k = 0; k < states_.size(); ++k) {
      const VoxelIndex i = states_.IndexAt(k);
      if (states_[k] == VoxelState::kFree && InBand(i)) Block(i, -1);
    }
  } else {
    CountBlockers();
  }
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const VoxelIndex i = states_.IndexAt(k);
    if (!bounds_.Contains(i) || (plane_ && i.z != layer_)) ++blockers_[k];
  }
  for (const VoxelBox& no_go : no_go_) {
    const VoxelBox reached = Dilated(no_go, reach_);  // beyond it nothing is blocked
    ForEachVoxel(Intersection(box, reached), [&](const VoxelIndex& i) {
      if (BlockedBy(no_go, i)) ++blockers_[i];
    });
  }
  traversable_count_ = static_cast<std::size_t>(std::count(blockers().begin(), blockers().end(), 0));
}

/// Counts for each voxel how many of those that block it are not free, which is all outside the box. What
/// blocks a voxel are sections of rows around it; sums along each row make the count in a section a
/// difference.
void PlanningMap::CountBlockers() {
  struct Section {
    VoxelIndex middle;
    int half;  ///< It has `half` voxels on either side of the middle.
  };
  std::vector<Section> sections;
  for (const VoxelIndex& i : blocking_) {
    if (sections.empty() || sections.back().middle.y != i.y || sections.back().middle.z != i.z)
      sections.push_back({{0, i.y, i.z}, 0});
    sections.back().half = std::max(sections.back().half, i.x);
  }
  const VoxelBox& box = states_.box();
  const VoxelBox padded{box.min - VoxelIndex{reach_, 0, 0}, box.max + VoxelIndex{reach_ + 1, 0, 0}};
  // Number of voxels before each in its row that are not free; sums may wrap around, differences do not.
  DenseGrid<std::uint16_t> before(padded, 0);
  const auto width = static_cast<std::size_t>(box.size_x());
  VoxelIndex row{box.min.x, 0, 0};
  for (row.z = box.min.z; row.z < box.max.z; ++row.z) {
    for (row.y = box.min.y; row.y < box.max.y; ++row.y) {
      std::uint16_t* const sums = &before[{padded.min.x, row.y, row.z}];
      const VoxelState* const states = &states_[row];
      const auto pad = static_cast<std::size_t>(reach_);
      for (std::size_t k = 0; k < width + 2 * pad; ++k) {
        const bool blocks = k < pad || k >= width + pad || states[k - pad] != VoxelState::kFree;
        sums[k + 1] = static_cast<std::uint16_t>(sums[k] + (blocks ? 1U : 0U));
      }
    }
  }
  for (row.z = box.min.z; row.z < box.max.z; ++row.z) {
    for (row.y = box.min.y; row.y < box.max.y; ++row.y) {
      std::uint16_t* const counts = &blockers_[row];
      for (const auto& [middle, half] : sections) {
        const VoxelIndex first = row + middle - VoxelIndex{half, 0, 0};
        if (box.Contains(row + middle)) {
          AddDifferences(&before[first + VoxelIndex{2 * half + 1, 0, 0}], &before[first], width, counts);
        } else {
          for (std::size_t k = 0; k < width; ++k)
            counts[k] = static_cast<std::uint16_t>(counts[k] + 2 * half + 1);
        }
      }
    }
  }
}

void PlanningMap::SetNoGo(const std::vector<Eigen::AlignedBox3d>& boxes) {
  std::vector<VoxelBox> no_go;
  for (const Eigen::AlignedBox3d& box : boxes) no_go.push_back(VoxelsWithin(box, voxel_size()));
  options_.no_go = boxes;
  if (std::exchange(no_go_, no_go) == no_go) return;
  if (states_.size() == 0) return;
  const VoxelBox box = states_.box();
  Rebuild(box);
}

PlanningMap PlanningMap::WithClearance(double clearance) const {
  THALWEG_CHECK(clearance <= options_.clearance);  // the box has room for no greater reach
  PlanningMap other = *this;
  other.options_.clearance = clearance;
  other.FindBlocking();
  if (states_.size() > 0) other.Rebuild(states_.box());
  return other;
}

bool PlanningMap::Touches(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& p_W, double radius) const {
  const VoxelBox voxels = VoxelsWithin(box, voxel_size());
  const Eigen::Vector3d low = voxel_size() * Eigen::Vector3d(voxels.min.x, voxels.min.y, voxels.min.z);
  const Eigen::Vector3d high = voxel_size() * Eigen::Vector3d(voxels.max.x, voxels.max.y, voxels.max.z);
  const Eigen::Vector3d middle(p_W.x(), p_W.y(), plane_.value_or(p_W.z()));
  const Eigen::Vector3d gap = (low - middle).cwiseMax(middle - high).cwiseMax(0.0);
  if (options_.half_height == 0.0) return gap.norm() < radius;
  return gap.head<2>().norm() < radius && gap.z() < options_.half_height;
}

bool PlanningMap::NoGoAmong(const VoxelIndex& i) const {
  return std::any_of(no_go_.begin(), no_go_.end(), [&](const VoxelBox& box) { return box.Contains(i); });
}

/// Returns false when the box would become too large.
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
  const int up = plane_ ? layer_ - i.z : 0;
  for (const VoxelIndex& offset : blocking_) {
    const VoxelIndex blocked = i + VoxelIndex{offset.x, offset.y, offset.z + up};
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
  if (plane_ && !InBand(i)) return;  // above or below the body
  if ((before == VoxelState::kFree) != (now == VoxelState::kFree)) {
    Block(i, now == VoxelState::kFree ? -1 : 1);
  }
}

/// Whether the box can grow to contain all of the changes.
bool PlanningMap::HasRoomFor(std::span<const VoxelChange> changes) const {
  constexpr int kMax = std::numeric_limits<int>::max();
  VoxelBox box = states_.size() == 0 ? VoxelBox{{kMax, kMax, kMax}, {-kMax, -kMax, -kMax}} : states_.box();
  for (const VoxelChange& change : changes) {
    const VoxelIndex& i = change.voxel;
    if (plane_ && !IsLookedThrough(i)) continue;
    box.min = {std::min(box.min.x, i.x), std::min(box.min.y, i.y), std::min(box.min.z, i.z)};
    box.max = {std::max(box.max.x, i.x + 1), std::max(box.max.y, i.y + 1), std::max(box.max.z, i.z + 1)};
  }
  return box.min.x > box.max.x || Dilated(box, kGrowthVoxels).count() <= options_.max_voxels;
}

std::vector<VoxelChange> PlanningMap::NearestFirst(std::span<const VoxelChange> changes) const {
  const auto median = [&](std::int32_t VoxelIndex::*axis) {
    std::vector<std::int32_t> values;
    values.reserve(changes.size());
    for (const VoxelChange& change : changes) values.push_back(change.voxel.*axis);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const VoxelIndex middle =
      states_.size() == 0 ? VoxelIndex{median(&VoxelIndex::x), median(&VoxelIndex::y), median(&VoxelIndex::z)}
                          : VoxelIndex{(box().min.x + box().max.x) / 2, (box().min.y + box().max.y) / 2,
                                       (box().min.z + box().max.z) / 2};
  std::vector<VoxelChange> sorted(changes.begin(), changes.end());
  std::stable_sort(sorted.begin(), sorted.end(), [&](const VoxelChange& a, const VoxelChange& b) {
    const auto distance = [&](const VoxelIndex& i) {
      const VoxelIndex d = i - middle;
      return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    };
    return distance(a.voxel) < distance(b.voxel);
  });
  return sorted;
}

void PlanningMap::Apply(const VoxelChange& change) {
  if (plane_ && !IsLookedThrough(change.voxel)) return;
  if (options_.bounds ? !states_.Contains(change.voxel) : !Dilated(box(), -reach_).Contains(change.voxel)) {
    if (options_.bounds) return;
    if (!Grow(change.voxel)) {
      ++beyond_limit_;
      return;
    }
  }
  weakly_free_[change.voxel] = OccupancyGrid::IsWeaklyFree(change.log_odds) ? 1 : 0;
  const VoxelState before = states_[change.voxel];
  const VoxelState now = OccupancyGrid::StateOf(change.log_odds);
  const bool doubtful_before = Doubtful(change.voxel);
  const bool doubtful_now = std::abs(static_cast<double>(change.log_odds)) < options_.doubt.max_log_odds;
  if (before == now && doubtful_before == doubtful_now) return;
  if (before != now) SetState(change.voxel, now);
  if (doubtful_before != doubtful_now) doubtful_[change.voxel] = doubtful_now ? 1 : 0;
  changes_.push_back({change.voxel, before, now, doubtful_before, doubtful_now});
}

std::span<const PlanningMap::StateChange> PlanningMap::Apply(std::span<const VoxelChange> changes) {
  changes_.clear();
  if (options_.bounds || HasRoomFor(changes)) {
    for (const VoxelChange& change : changes) Apply(change);
  } else {
    for (const VoxelChange& change : NearestFirst(changes)) Apply(change);
  }
  return changes_;
}

std::span<const PlanningMap::StateChange> PlanningMap::Vacate(const Eigen::Vector3d& p_W, double radius) {
  const bool sphere = options_.half_height == 0.0;
  const Eigen::Vector3d middle_W(p_W.x(), p_W.y(), plane_.value_or(p_W.z()));
  const Eigen::Vector3d reach(radius, radius, sphere ? radius : options_.half_height);
  const VoxelBox around{IndexOf(middle_W - reach), IndexOf(middle_W + reach) + VoxelIndex{1, 1, 1}};
  std::vector<VoxelChange> inside;
  ForEachVoxel(around, [&](const VoxelIndex& i) {
    if (State(i) != VoxelState::kUnknown) return;
    const Eigen::Vector3d off = CenterOf(i) - middle_W;
    const bool fills =
        sphere ? off.norm() <= radius : off.head<2>().norm() <= radius && std::abs(off.z()) <= reach.z();
    if (fills) inside.push_back({i, kSurelyFree});
  });
  return Apply(inside);
}

void PlanningMap::Reset() {
  states_ = {};
  doubtful_ = {};
  weakly_free_ = {};
  if (options_.bounds) {
    Rebuild(blockers_.box());
  } else {
    blockers_ = {};
    traversable_count_ = 0;
  }
}

bool PlanningMap::IsObstacle(const VoxelIndex& i, Obstacles obstacles) const {
  if (NoGo(i)) return true;
  switch (State(i)) {
    case VoxelState::kFree:
      return obstacles == Obstacles::kAllButSurelyFree && weakly_free_.Get(i, 0) != 0;
    case VoxelState::kUnknown:
      return obstacles != Obstacles::kOccupied;
    case VoxelState::kOccupied:
      return true;
  }
  return true;
}

/// Calls visit(const VoxelIndex&, double square) for each obstacle voxel beside which a body may have only a
/// radius below `limit` [m], with the square of that radius [m^2]; see ClearanceAt. What it returns is the
/// square of the limit from then on.
template <class Visitor>
void PlanningMap::ForEachObstacle(const Eigen::Vector3d& p_W, Obstacles obstacles, double limit,
                                  Visitor&& visit) const {
  const double size = voxel_size();
  const bool sphere = options_.half_height == 0.0;
  const double taller = sphere ? 0.0 : options_.half_height - options_.clearance;
  VoxelIndex low = IndexOf(p_W - Eigen::Vector3d(limit, limit, limit + taller));
  VoxelIndex high = IndexOf(p_W + Eigen::Vector3d(limit, limit, limit + taller));
  if (plane_) {
    low.z = bounds_.min.z;
    high.z = bounds_.max.z - 1;
  }
  double below = limit * limit;
  const auto gap = [size](int i, double p) { return DistanceToInterval(p, i * size, (i + 1) * size); };
  const auto join = [sphere](double aside, double above) {
    return sphere ? aside + above : std::max(aside, above);
  };
  for (int z = low.z; z <= high.z; ++z) {
    const double over = plane_ ? 0.0 : std::max(0.0, gap(z, p_W.z()) - taller);
    const double dz = over * over;
    for (int y = low.y; y <= high.y; ++y) {
      const double over_y = gap(y, p_W.y());
      const double dy = over_y * over_y;
      if (join(dy, dz) >= below) continue;
      for (int x = low.x; x <= high.x; ++x) {
        if (!IsObstacle({x, y, z}, obstacles)) continue;
        const double over_x = gap(x, p_W.x());
        const double square = join(over_x * over_x + dy, dz);
        if (square < below) below = visit(VoxelIndex{x, y, z}, square);
      }
    }
  }
}

double PlanningMap::ClearanceAt(const Eigen::Vector3d& p_W, Obstacles obstacles, double limit) const {
  double least = limit * limit;
  ForEachObstacle(p_W, obstacles, limit,
                  [&](const VoxelIndex& /*voxel*/, double square) { return least = square; });
  return std::sqrt(least);
}

std::vector<PlanningMap::Touched> PlanningMap::TouchedAt(const Eigen::Vector3d& p_W, Obstacles obstacles,
                                                         double radius) const {
  std::vector<Touched> touched;
  ForEachObstacle(p_W, obstacles, radius, [&](const VoxelIndex& voxel, double square) {
    touched.push_back({voxel, std::sqrt(square)});
    return radius * radius;
  });
  return touched;
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
    // Clearance changes by no more than the distance traveled.
    at = std::min(length, at + std::max(finest, here - clearance));
  }
}

/// The radius [m] that a body may have beside the voxel, see ClearanceAt.
double PlanningMap::GapTo(const VoxelIndex& i, const Eigen::Vector3d& p_W) const {
  const double size = voxel_size();
  const auto gap = [size](int at, double p) { return DistanceToInterval(p, at * size, (at + 1) * size); };
  const double aside = std::hypot(gap(i.x, p_W.x()), gap(i.y, p_W.y()));
  if (plane_) return aside;
  const double above = gap(i.z, p_W.z());
  if (options_.half_height == 0.0) return std::hypot(aside, above);
  return std::max(aside, above - (options_.half_height - options_.clearance));
}

/// The least of GapTo between a and b, where it is convex: by a golden-section search, to a micrometer.
double PlanningMap::LeastGapTo(const VoxelIndex& i, const Eigen::Vector3d& a_W,
                               const Eigen::Vector3d& b_W) const {
  const auto at = [&](double share) { return GapTo(i, a_W + share * (b_W - a_W)); };
  const double precise = 1e-6 / std::max(1e-6, (b_W - a_W).norm());
  constexpr double kGolden = 1.0 / std::numbers::phi;
  double low = 0.0;
  double high = 1.0;
  double left = high - kGolden;
  double right = kGolden;
  double at_left = at(left);
  double at_right = at(right);
  while (high - low > precise) {
    if (at_left <= at_right) {
      high = std::exchange(right, left);
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = at(left);
    } else {
      low = std::exchange(left, right);
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = at(right);
    }
  }
  return std::min({at(0.0), at(1.0), at_left, at_right});
}

bool PlanningMap::SegmentClearBut(std::span<const Touched> but, const Eigen::Vector3d& a_W,
                                  const Eigen::Vector3d& b_W, Obstacles obstacles, double radius) const {
  const double half = 0.5 * (b_W - a_W).norm();
  const Eigen::Vector3d middle_W = 0.5 * (a_W + b_W);
  bool clear = true;
  ForEachObstacle(middle_W, obstacles, half + radius, [&](const VoxelIndex& i, double /*square*/) {
    // The gap changes by no more than the distance moved.
    clear = clear && (LeastGapTo(i, a_W, b_W) >= radius - kTouch ||
                      std::ranges::find(but, i, &Touched::voxel) != but.end());
    return clear ? (half + radius) * (half + radius) : 0.0;
  });
  return clear;
}

bool PlanningMap::ClearToLeave(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, Obstacles obstacles,
                               double radius) const {
  constexpr double kNearer = 2e-6;  // [m]
  const std::vector<Touched> touched = TouchedAt(a_W, obstacles, radius);
  if (!SegmentClearBut(touched, a_W, b_W, obstacles, radius)) return false;
  double least = radius;
  for (const Touched& its : touched) least = std::min(least, its.gap);
  return std::ranges::all_of(
      touched, [&](const Touched& its) { return LeastGapTo(its.voxel, a_W, b_W) >= least - kNearer; });
}

double PlanningMap::SegmentClearance(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W,
                                     Obstacles obstacles, double limit) const {
  const int pieces = PiecesOf((b_W - a_W).norm(), 0.125 * voxel_size());
  double least = limit;
  for (int piece = 0; piece <= pieces; ++piece) {
    const double share = static_cast<double>(piece) / pieces;
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
