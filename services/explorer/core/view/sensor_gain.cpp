#include "services/explorer/core/view/sensor_gain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/geometry/spread_directions.h"
#include "common/voxel/ray.h"

namespace thalweg::explorer {
namespace {

constexpr double kWeightUnits = 16.0;
/// With more changes than this, it is cheaper to cast all rays again.
constexpr std::size_t kMostChanges = 500;

bool OnFace(const VoxelBox& box, const VoxelIndex& i) {
  return i.x == box.min.x || i.y == box.min.y || i.z == box.min.z || i.x == box.max.x - 1 ||
         i.y == box.max.y - 1 || i.z == box.max.z - 1;
}

}  // namespace

SensorGain::SensorGain(const ViewPlanner& views, double voxel_size, double range)
    : view_count_(views.candidates().size()) {
  const VoxelIndex origin{0, 0, 0};
  const Eigen::Vector3d from = VoxelCenter(origin, voxel_size);
  first_.push_back(0);
  for (const Eigen::Vector3d& direction_W : SpreadDirections(kRays)) {
    TraverseVoxels(from, from + range * direction_W, voxel_size, [&](const VoxelIndex& i) {
      if (i == origin) return true;
      const double r = std::sqrt(static_cast<double>(i.x * i.x + i.y * i.y + i.z * i.z));
      const double stands_for = std::max(1.0, r * r * 4.0 * std::numbers::pi / kRays);
      offsets_.push_back(i);
      weights_.push_back(static_cast<std::uint32_t>(std::lround(kWeightUnits * stands_for)));
      return true;
    });
    first_.push_back(static_cast<std::uint32_t>(offsets_.size()));
    views_.emplace_back();
    for (std::size_t n = 0; n < view_count_; ++n) {
      if (views.Shows(views.candidates()[n], {.voxel = origin, .offset_W = direction_W})) {
        views_.back().push_back(static_cast<std::uint16_t>(n));
      }
    }
  }
}

void SensorGain::Follow(const PlanningMap& map, const std::vector<VoxelIndex>& targets,
                        const std::vector<VoxelIndex>& doubtful) {
  const VoxelBox& box = map.box();
  if (!(cells_.box() == box)) {
    // Everything outside the old box was unknown, so no ray went there; only the memory layout changes.
    const DenseGrid<Cell> old = std::move(cells_);
    cells_ = DenseGrid<Cell>(box, Cell::kDark);
    for (std::size_t k = 0; k < old.size(); ++k) {
      const VoxelIndex i = old.IndexAt(k);
      if (cells_.Contains(i)) cells_[i] = old[k];
    }
    counted_.assign(cells_.size(), 0);
    count_ = 0;
    numbers_ = DenseGrid<std::int32_t>(box, -1);
    is_place_ = DenseGrid<std::uint8_t>(box, 0);
    std::erase_if(places_, [&](const Place& place) { return !box.Contains(place.voxel); });
    for (std::size_t n = 0; n < places_.size(); ++n) {
      numbers_[places_[n].voxel] = static_cast<std::int32_t>(n);
      is_place_[places_[n].voxel] = 1;
    }
    jumps_.clear();
    for (const VoxelIndex& o : offsets_) {
      jumps_.push_back(static_cast<std::int32_t>(o.x + o.y * cells_.stride_y() + o.z * cells_.stride_z()));
    }
  }
  for (const VoxelIndex& i : targets_) {
    if (cells_.Contains(i)) cells_[i] = Cell::kDark;
  }
  std::vector<VoxelIndex> blocked;
  std::vector<VoxelIndex> opened;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const VoxelState state = map.states()[k];
    const Cell now = state == VoxelState::kFree       ? Cell::kFree
                     : state == VoxelState::kOccupied ? Cell::kSurface
                                                      : Cell::kDark;
    if (now == cells_[k]) continue;
    const VoxelIndex i = cells_.IndexAt(k);
    if (now == Cell::kFree && OnFace(box, i)) continue;  // so that no ray leaves the box
    if (cells_[k] == Cell::kFree) blocked.push_back(i);
    if (cells_[k] == Cell::kSurface) opened.push_back(i);
    cells_[k] = now;
  }
  FollowChanges(blocked, opened);
  targets_ = targets;
  for (const VoxelIndex& i : targets_) cells_[i] = Cell::kInteresting;
  doubtful_ = doubtful.empty() ? DenseGrid<std::uint8_t>() : DenseGrid<std::uint8_t>(box, 0);
  for (const VoxelIndex& i : doubtful) doubtful_[i] = 1;
  doubtful_weights_.clear();
  if (doubtful.empty()) return;
  for (const std::uint32_t weight : weights_) {
    const double less = map.options().doubt.weight * weight;
    doubtful_weights_.push_back(std::max(1U, static_cast<std::uint32_t>(std::lround(less))));
  }
}

void SensorGain::FollowChanges(const std::vector<VoxelIndex>& blocked,
                               const std::vector<VoxelIndex>& opened) {
  if (blocked.size() + opened.size() > kMostChanges) {
    places_.clear();
    numbers_.Fill(-1);
    is_place_.Fill(0);
    return;
  }
  // Calls visit(place, ray, step) for all rays that cross a voxel or would cross it if they were longer.
  const auto for_rays_through = [&](const VoxelIndex& i, auto&& visit) {
    for (std::size_t r = 0; r < kRays; ++r) {
      for (std::uint32_t k = first_[r]; k < first_[r + 1]; ++k) {
        const VoxelIndex from = i - offsets_[k];
        if (is_place_.Get(from, 0) == 0) continue;
        visit(places_[static_cast<std::size_t>(numbers_[from])], static_cast<std::uint16_t>(r),
              static_cast<std::uint16_t>(k - first_[r]));
      }
    }
  };
  const auto open = [](Place& place, std::uint16_t r) {
    const auto at = std::ranges::lower_bound(place.open, r);
    if (at == place.open.end() || *at != r) place.open.insert(at, r);
  };
  for (const VoxelIndex& i : blocked) {
    for_rays_through(i, [&](Place& place, std::uint16_t r, std::uint16_t step) {
      if (place.ends[r] <= step) return;
      place.ends[r] = step;
      open(place, r);
    });
  }
  for (const VoxelIndex& i : opened) {
    for_rays_through(i, [&](Place& place, std::uint16_t r, std::uint16_t step) {
      if (place.ends[r] == step) open(place, r);
    });
  }
}

template <class Visitor>
void SensorGain::Walk(Place& place, Visitor&& visit) const {
  const Cell* const here = cells_.data() + cells_.Offset(place.voxel);
  std::size_t kept = 0;
  for (const std::uint16_t r : place.open) {
    const std::uint32_t last = first_[r + std::size_t{1}];
    std::uint32_t k = first_[r] + place.ends[r];
    while (k < last && here[jumps_[k]] == Cell::kFree) ++k;
    place.ends[r] = static_cast<std::uint16_t>(k - first_[r]);
    if (k == last || here[jumps_[k]] == Cell::kSurface) continue;
    place.open[kept++] = r;
    if (here[jumps_[k]] == Cell::kInteresting) {
      visit(r, static_cast<std::size_t>(here + jumps_[k] - cells_.data()), weights_[k]);
    }
  }
  place.open.resize(kept);
}

template <class Visitor>
void SensorGain::VisitDoubtful(const Place& place, Visitor&& visit) const {
  if (doubtful_.size() == 0) return;
  const std::size_t here = doubtful_.Offset(place.voxel);
  for (std::uint16_t r = 0; r < kRays; ++r) {
    const std::uint32_t end = std::min(first_[r] + place.ends[r] + 1U, first_[r + std::size_t{1}]);
    for (std::uint32_t k = first_[r]; k < end; ++k) {
      const std::size_t voxel = here + static_cast<std::size_t>(std::ptrdiff_t{jumps_[k]});
      if (doubtful_[voxel] != 0) visit(r, voxel, doubtful_weights_[k]);
    }
  }
}

SensorGain::Place& SensorGain::PlaceAt(const VoxelIndex& voxel) {
  std::int32_t& number = numbers_[voxel];
  if (number < 0) {
    number = static_cast<std::int32_t>(places_.size());
    is_place_[voxel] = 1;
    places_.push_back({voxel, std::vector<std::uint16_t>(kRays, 0), std::vector<std::uint16_t>(kRays)});
    std::iota(places_.back().open.begin(), places_.back().open.end(), std::uint16_t{0});
  }
  return places_[static_cast<std::size_t>(number)];
}

double SensorGain::UpperBound(const VoxelIndex& place) {
  std::uint64_t sum = 0;
  const auto add = [&sum](std::size_t, std::size_t, std::uint32_t weight) { sum += weight; };
  Place& its = PlaceAt(place);
  Walk(its, add);
  VisitDoubtful(its, add);
  return static_cast<double>(sum) / kWeightUnits;
}

SensorGain::Gain SensorGain::BestView(const VoxelIndex& place) {
  struct Hit {
    std::size_t voxel;
    std::size_t ray;
  };
  std::vector<std::uint32_t> sums(view_count_, 0);
  std::vector<Hit> hits;
  ++count_;
  const auto count = [&](std::size_t ray, std::size_t voxel, std::uint32_t weight) {
    if (counted_[voxel] == count_) return;
    counted_[voxel] = count_;
    hits.push_back({voxel, ray});
    for (const std::uint16_t view : views_[ray]) sums[view] += weight;
  };
  Place& its = PlaceAt(place);
  Walk(its, count);
  VisitDoubtful(its, count);
  Gain gain;
  gain.view = static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
  gain.value = sums[gain.view] / kWeightUnits;
  for (const Hit& hit : hits) {
    const std::vector<std::uint16_t>& views = views_[hit.ray];
    if (std::binary_search(views.begin(), views.end(), static_cast<std::uint16_t>(gain.view))) {
      gain.seen.push_back(cells_.IndexAt(hit.voxel));
    }
  }
  return gain;
}

}  // namespace thalweg::explorer
