#include "services/explorer/core/sensor_gain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/voxel/ray.h"

namespace thalweg::explorer {
namespace {

constexpr double kWeightUnits = 16.0;

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

void SensorGain::Follow(const PlanningMap& map, const std::vector<VoxelIndex>& targets) {
  const VoxelBox& box = map.box();
  if (!(cells_.box() == box)) {
    // What lay outside was unknown: no ray went there. Only where things are in memory changes.
    const DenseGrid<Cell> old = std::move(cells_);
    cells_ = DenseGrid<Cell>(box, Cell::kBlocked);
    for (std::size_t k = 0; k < old.size(); ++k) {
      const VoxelIndex i = old.IndexAt(k);
      if (cells_.Contains(i)) cells_[i] = old[k];
    }
    counted_.assign(cells_.size(), 0);
    count_ = 0;
    numbers_ = DenseGrid<std::int32_t>(box, -1);
    std::erase_if(ends_,
                  [&, n = std::size_t{0}](const auto&) mutable { return !box.Contains(places_[n++]); });
    std::erase_if(places_, [&](const VoxelIndex& i) { return !box.Contains(i); });
    for (std::size_t n = 0; n < places_.size(); ++n) numbers_[places_[n]] = static_cast<std::int32_t>(n);
    jumps_.clear();
    for (const VoxelIndex& o : offsets_) {
      jumps_.push_back(static_cast<std::int32_t>(o.x + o.y * cells_.stride_y() + o.z * cells_.stride_z()));
    }
  }
  for (const VoxelIndex& i : targets_) {
    if (cells_.Contains(i)) cells_[i] = Cell::kBlocked;
  }
  std::vector<VoxelIndex> blocked;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const bool free = map.states()[k] == VoxelState::kFree;
    if (free == (cells_[k] == Cell::kFree)) continue;
    const VoxelIndex i = cells_.IndexAt(k);
    if (free && OnFace(box, i)) continue;  // so that no ray leaves the box
    if (!free) blocked.push_back(i);
    cells_[k] = free ? Cell::kFree : Cell::kBlocked;
  }
  if (!blocked.empty()) CutOff(blocked);
  targets_ = targets;
  for (const VoxelIndex& i : targets_) cells_[i] = Cell::kInteresting;
}

void SensorGain::CutOff(const std::vector<VoxelIndex>& blocked) {
  for (std::size_t r = 0; r < kRays; ++r) {
    for (std::uint32_t k = first_[r]; k < first_[r + 1]; ++k) {
      for (const VoxelIndex& i : blocked) {
        const std::int32_t number = numbers_.Get(i - offsets_[k], -1);
        if (number < 0) continue;
        std::uint16_t& end = ends_[static_cast<std::size_t>(number)][r];
        end = std::min(end, static_cast<std::uint16_t>(k - first_[r]));
      }
    }
  }
}

template <class Visitor>
void SensorGain::Walk(std::size_t at, Ends& ends, Visitor&& visit) const {
  const Cell* const here = cells_.data() + at;
  for (std::size_t r = 0; r < kRays; ++r) {
    const std::uint32_t last = first_[r + 1];
    std::uint32_t k = first_[r] + ends[r];
    while (k < last && here[jumps_[k]] == Cell::kFree) ++k;
    ends[r] = static_cast<std::uint16_t>(k - first_[r]);
    if (k < last && here[jumps_[k]] == Cell::kInteresting) {
      visit(r, static_cast<std::size_t>(here + jumps_[k] - cells_.data()), weights_[k]);
    }
  }
}

SensorGain::Ends& SensorGain::EndsOf(const VoxelIndex& place) {
  std::int32_t& number = numbers_[place];
  if (number < 0) {
    number = static_cast<std::int32_t>(places_.size());
    places_.push_back(place);
    ends_.emplace_back(kRays, std::uint16_t{0});
  }
  return ends_[static_cast<std::size_t>(number)];
}

double SensorGain::UpperBound(const VoxelIndex& place) {
  std::uint64_t sum = 0;
  Walk(cells_.Offset(place), EndsOf(place),
       [&](std::size_t, std::size_t, std::uint32_t weight) { sum += weight; });
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
  Walk(cells_.Offset(place), EndsOf(place), [&](std::size_t ray, std::size_t voxel, std::uint32_t weight) {
    if (counted_[voxel] == count_) return;
    counted_[voxel] = count_;
    hits.push_back({voxel, ray});
    for (const std::uint16_t view : views_[ray]) sums[view] += weight;
  });
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
