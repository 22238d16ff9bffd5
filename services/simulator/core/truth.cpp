#include "services/simulator/core/truth.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/base/parallel.h"
#include "common/base/text.h"
#include "common/voxel/for_each_voxel.h"
#include "common/voxel/voxels_within.h"
#include "services/simulator/core/reachable.h"
#include "services/simulator/core/surface_voxels.h"
#include "services/simulator/core/swept_voxels.h"

namespace thalweg::simulator {
namespace {

/// Grows the observable region outward from the reachable voxels: a voxel is tested once one of its
/// neighbors is known to be observable, so voxels far from anything visible are never tested.
class ObservableFill {
 public:
  ObservableFill(const World& world, const Eigen::Vector3d& start_W, const DenseGrid<std::uint8_t>& reachable,
                 const TrueMap::Options& options)
      : surfaces_(world.mesh(), reachable.box(), options.voxel_size, kTouchTolerance),
        visibility_(world, reachable, options.voxel_size, options.view_range,
                    TrueMap::CameraOf(options, start_W)),
        voxel_size_(options.voxel_size),
        seen_(reachable) {
    if (!options.robot.turns_freely() && !options.robot.drives) KeepOnlyAround(VoxelAt(start_W, voxel_size_));
    for (const Eigen::AlignedBox3d& box : world.no_go()) {
      no_go_.push_back(VoxelsWithin(box, options.voxel_size));
    }
  }

  DenseGrid<TrueVoxel> Run() {
    DenseGrid<std::uint8_t> tried = seen_;
    std::vector<std::size_t> newest;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (seen_[i]) newest.push_back(i);
    }
    while (!newest.empty()) {
      const std::vector<std::size_t> candidates = UntriedNeighbors(newest, tried);
      ParallelFor(candidates.size(), 64, [&](std::size_t i) { seen_[candidates[i]] = Sees(candidates[i]); });
      newest.clear();
      for (const std::size_t i : candidates) {
        if (seen_[i]) newest.push_back(i);
      }
    }
    return Classes();
  }

 private:
  /// A camera that does not turn freely may be where a body fits and see that place from nowhere, so that
  /// only the surroundings of the start are taken for seen.
  void KeepOnlyAround(const VoxelIndex& start) {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (!CubeAround(start, 1).Contains(seen_.IndexAt(i))) seen_[i] = 0;
    }
  }

  std::vector<std::size_t> UntriedNeighbors(const std::vector<std::size_t>& voxels,
                                            DenseGrid<std::uint8_t>& tried) const {
    std::vector<std::size_t> untried;
    for (const std::size_t offset : voxels) {
      ForEachVoxel(CubeAround(seen_.IndexAt(offset), 1), [&](const VoxelIndex& neighbor) {
        if (!tried.Contains(neighbor) || tried[neighbor]) return;
        tried[neighbor] = 1;
        untried.push_back(tried.Offset(neighbor));
      });
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
      const VoxelIndex voxel = seen_.IndexAt(i);
      if (std::any_of(no_go_.begin(), no_go_.end(), [&](const VoxelBox& b) { return b.Contains(voxel); }))
        continue;
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
  std::vector<VoxelBox> no_go_;  ///< Excluded from the comparison.
};

double Share(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

std::optional<LevelCamera> TrueMap::CameraOf(const Options& options, const Eigen::Vector3d& start_W) {
  if (options.robot.turns_freely()) return std::nullopt;
  return LevelCameraOf(options.robot, options.camera, start_W);
}

TrueMap::TrueMap(const World& given, const Eigen::Vector3d& start_W, const Options& options)
    : voxel_size_(options.voxel_size) {
  if (!(options.voxel_size > 0.0) || !(options.robot.radius > 0.0) || !(options.view_range > 0.0)) {
    throw std::invalid_argument("truth: voxel_size, the robot's radius and view_range must be > 0");
  }
  if (options.robot.drives) plane_ = start_W.z();
  std::vector<MovingPart> parts;
  for (const PartInMotion& part : given.parts()) parts.push_back(part.part());
  const std::optional<World> emptied =
      parts.empty() ? std::nullopt : std::optional<World>(given.WithoutParts());
  const World& world = emptied ? *emptied : given;
  reachable_ = ReachableVoxels(world, start_W, options.robot, options.voxel_size);
  voxels_ = ObservableFill(world, start_W, reachable_, options).Run();
  if (!parts.empty()) {
    const DenseGrid<std::uint8_t> swept = SweptVoxels(parts, voxels_.box(), options.voxel_size);
    for (std::size_t i = 0; i < voxels_.size(); ++i) {
      if (swept[i] && voxels_[i] != TrueVoxel::kOutside) voxels_[i] = TrueVoxel::kAmbiguous;
    }
  }
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    observable_count_ += voxels_[i] == TrueVoxel::kFree || voxels_[i] == TrueVoxel::kSurface;
  }
}

bool TrueMap::HoldsFor(const Eigen::Vector3d& start_W) const {
  constexpr double kSamePlane = 1e-6;  // [m]
  if (plane_ && std::abs(start_W.z() - *plane_) > kSamePlane) return false;
  return reachable_.Get(VoxelAt(start_W, voxel_size_), 0) != 0;
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
    throw std::invalid_argument("truth has voxels of " + NumberText(voxel_size_) + " m, the map of " +
                                NumberText(map.voxel_size()) + " m");
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
