#include "services/simulator/core/truth.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "services/simulator/core/parallel.h"
#include "services/simulator/core/surface_voxels.h"
#include "services/simulator/core/visibility.h"

namespace thalweg::simulator {
namespace {

constexpr double kTouchTolerance = 1e-4;  // [m]

/// The voxels that have a part within the bounds; a sliver from rounding does not count.
VoxelBox VoxelsWithin(const Eigen::AlignedBox3d& bounds, double voxel_size) {
  constexpr double kSliver = 1e-6;
  const auto low = [&](int axis) {
    return static_cast<std::int32_t>(std::floor(bounds.min()[axis] / voxel_size + kSliver));
  };
  const auto high = [&](int axis) {
    return static_cast<std::int32_t>(std::ceil(bounds.max()[axis] / voxel_size - kSliver));
  };
  return {{low(0), low(1), low(2)}, {high(0), high(1), high(2)}};
}

void CheckStart(const World& world, const Eigen::Vector3d& start_W, double radius) {
  const double clearance = world.DistanceToSurface(start_W, 10.0 * radius);
  if (world.bounds().contains(start_W) && clearance >= radius) return;
  std::ostringstream text;
  text << "a robot of radius " << radius << " m does not fit at the start " << start_W.transpose();
  if (world.bounds().contains(start_W)) {
    text << ": the nearest surface is " << clearance << " m away";
  } else {
    text << ": it is outside the bounds";
  }
  throw std::invalid_argument(text.str());
}

/// Flood fill of the places where the robot's sphere can be.
class ReachableFill {
 public:
  ReachableFill(const World& world, const VoxelBox& box, const TrueMap::Options& options)
      : world_(world), options_(options), reachable_(box, 0) {}

  DenseGrid<std::uint8_t> From(const Eigen::Vector3d& start_W) {
    const VoxelIndex first = VoxelAt(start_W, options_.voxel_size);
    // The robot may fit at the start and yet not in that voxel's centre.
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) Visit(start_W, first + VoxelIndex{x, y, z});
      }
    }
    while (!stack_.empty()) {
      const VoxelIndex voxel = stack_.back();
      stack_.pop_back();
      const Eigen::Vector3d from = VoxelCenter(voxel, options_.voxel_size);
      for (const VoxelIndex& step : kFaceNeighbours) Visit(from, voxel + step);
    }
    return std::move(reachable_);
  }

 private:
  void Visit(const Eigen::Vector3d& from, const VoxelIndex& voxel) {
    if (!reachable_.Contains(voxel) || reachable_[voxel]) return;
    const Eigen::Vector3d center = VoxelCenter(voxel, options_.voxel_size);
    if (world_.DistanceToSurface(center, options_.robot_radius) < options_.robot_radius) return;
    if (!world_.InSight(from, center)) return;  // a wall between, thin against the voxel
    reachable_[voxel] = 1;
    stack_.push_back(voxel);
  }

  const World& world_;
  const TrueMap::Options& options_;
  DenseGrid<std::uint8_t> reachable_;
  std::vector<VoxelIndex> stack_;
};

/// Grows what is observable outwards from the reachable voxels: a voxel is tried when a neighbour is
/// observable.
class ObservableFill {
 public:
  ObservableFill(const World& world, const DenseGrid<std::uint8_t>& reachable,
                 const TrueMap::Options& options)
      : surfaces_(world.mesh(), reachable.box(), options.voxel_size, kTouchTolerance),
        visibility_(world, reachable, options.voxel_size, options.view_range),
        voxel_size_(options.voxel_size),
        seen_(reachable) {}

  DenseGrid<TrueVoxel> Run() {
    DenseGrid<std::uint8_t> tried = seen_;
    std::vector<std::size_t> newest;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (seen_[i]) newest.push_back(i);
    }
    while (!newest.empty()) {
      const std::vector<std::size_t> candidates = UntriedNeighbours(newest, tried);
      ParallelFor(candidates.size(), 64, [&](std::size_t i) { seen_[candidates[i]] = Sees(candidates[i]); });
      newest.clear();
      for (const std::size_t i : candidates) {
        if (seen_[i]) newest.push_back(i);
      }
    }
    return Classes();
  }

 private:
  std::vector<std::size_t> UntriedNeighbours(const std::vector<std::size_t>& voxels,
                                             DenseGrid<std::uint8_t>& tried) const {
    std::vector<std::size_t> untried;
    for (const std::size_t offset : voxels) {
      const VoxelIndex voxel = seen_.IndexAt(offset);
      for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
          for (int x = -1; x <= 1; ++x) {
            const VoxelIndex neighbour = voxel + VoxelIndex{x, y, z};
            if (!tried.Contains(neighbour) || tried[neighbour]) continue;
            tried[neighbour] = 1;
            untried.push_back(tried.Offset(neighbour));
          }
        }
      }
    }
    return untried;
  }

  bool Sees(std::size_t offset) const {
    const VoxelIndex voxel = seen_.IndexAt(offset);
    if (surfaces_.KindOf(offset) == SurfaceVoxels::Kind::kCut) {
      return visibility_.SeesSurface(BoxOf(voxel, voxel_size_), surfaces_.TrianglesAt(offset));
    }
    return visibility_.SeesPoint(VoxelCenter(voxel, voxel_size_));
  }

  DenseGrid<TrueVoxel> Classes() const {
    DenseGrid<TrueVoxel> classes(seen_.box(), TrueVoxel::kOutside);
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const SurfaceVoxels::Kind kind = surfaces_.KindOf(i);
      if (kind == SurfaceVoxels::Kind::kTouched) {
        classes[i] = TrueVoxel::kAmbiguous;
      } else if (seen_[i]) {
        classes[i] = kind == SurfaceVoxels::Kind::kCut ? TrueVoxel::kSurface : TrueVoxel::kFree;
      }
    }
    return classes;
  }

  SurfaceVoxels surfaces_;
  Visibility visibility_;
  double voxel_size_;
  DenseGrid<std::uint8_t> seen_;
};

double Share(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

TrueMap::TrueMap(const World& world, const Eigen::Vector3d& start_W, const Options& options)
    : voxel_size_(options.voxel_size) {
  if (!(options.voxel_size > 0.0) || !(options.robot_radius > 0.0) || !(options.view_range > 0.0)) {
    throw std::invalid_argument("truth: voxel_size, robot_radius and view_range must be > 0");
  }
  CheckStart(world, start_W, options.robot_radius);
  reachable_ = ReachableFill(world, VoxelsWithin(world.bounds(), options.voxel_size), options).From(start_W);
  voxels_ = ObservableFill(world, reachable_, options).Run();
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    observable_count_ += voxels_[i] == TrueVoxel::kFree || voxels_[i] == TrueVoxel::kSurface;
  }
}

double TrueMap::Agreement::share() const {
  const std::size_t right = free_right + surface_right;
  return Share(right, right + free_wrong + free_unknown + surface_wrong + surface_unknown);
}

double TrueMap::Agreement::coverage() const {
  const std::size_t known = free_right + free_wrong + surface_right + surface_wrong;
  return Share(known, known + free_unknown + surface_unknown);
}

TrueMap::Agreement TrueMap::Compare(const OccupancyGrid& map) const {
  if (std::abs(map.voxel_size() - voxel_size_) > 1e-9 * voxel_size_) {
    throw std::invalid_argument("truth has voxels of " + std::to_string(voxel_size_) + " m, the map of " +
                                std::to_string(map.voxel_size()) + " m");
  }
  Agreement agreement;
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    const bool is_free = voxels_[i] == TrueVoxel::kFree;
    if (!is_free && voxels_[i] != TrueVoxel::kSurface) continue;
    const VoxelState state = map.State(voxels_.IndexAt(i));
    const VoxelState expected = is_free ? VoxelState::kFree : VoxelState::kOccupied;
    if (state == VoxelState::kUnknown) {
      ++(is_free ? agreement.free_unknown : agreement.surface_unknown);
    } else if (state == expected) {
      ++(is_free ? agreement.free_right : agreement.surface_right);
    } else {
      ++(is_free ? agreement.free_wrong : agreement.surface_wrong);
    }
  }
  return agreement;
}

}  // namespace thalweg::simulator
