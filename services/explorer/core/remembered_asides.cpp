#include "services/explorer/core/remembered_asides.h"

#include <limits>

#include "common/geometry/point_text.h"

namespace thalweg::explorer {
namespace {

constexpr double kFarthestIgnored = 1.0;  // [m] From the point that an operator named to its frontier.

}  // namespace

Result<Cluster> RememberedAsides::Ignore(const Eigen::Vector3d& p_W, const FrontierOptions& frontier,
                                         Knowledge& knowledge, Time now) {
  const PlanningMap& map = knowledge.map();
  DenseGrid<std::uint8_t> ignored = knowledge.memory().set_aside();
  for (std::size_t k = 0; k < ignored.size(); ++k) {
    if (ignored[k] != static_cast<std::uint8_t>(AsideReason::kIgnored)) ignored[k] = 0;
  }
  const Frontiers frontiers = FindFrontiers(map, ignored, frontier);
  const Cluster* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Cluster& cluster : frontiers.clusters) {
    for (const VoxelIndex& i : cluster.unknowns) {
      const double distance = (map.CenterOf(i) - p_W).norm();
      if (distance >= least) continue;
      least = distance;
      nearest = &cluster;
    }
  }
  if (nearest == nullptr) return Error{"there is no frontier that is not ignored already"};
  if (least > kFarthestIgnored)
    return Error{"the frontier nearest to " + PointText(p_W) + " is at " + PointText(nearest->center_W)};
  for (const VoxelIndex& i : nearest->unknowns) {
    knowledge.memory().SetAside(i, AsideReason::kIgnored, now);
    ignored_.push_back({map.CenterOf(i), AsideReason::kIgnored});
  }
  return *nearest;
}

void RememberedAsides::SetAsideAgain(Knowledge& knowledge, Time now) {
  const PlanningMap& map = knowledge.map();
  std::vector<SavedExploration::Aside> again = ignored_;
  again.insert(again.end(), restored_.begin(), restored_.end());
  restored_.clear();
  for (const SavedExploration::Aside& aside : again) {
    const VoxelIndex i = map.IndexOf(aside.p_W);
    if (map.box().Contains(i) && IsTarget(map, i)) knowledge.memory().SetAside(i, aside.reason, now);
  }
}

void RememberedAsides::SaveTo(std::vector<SavedExploration::Aside>& saved, const Knowledge& knowledge) const {
  saved.insert(saved.end(), ignored_.begin(), ignored_.end());
  saved.insert(saved.end(), restored_.begin(), restored_.end());
  for (const auto& [reason, voxels] : knowledge.memory().SetAsideVoxels()) {
    if (reason == AsideReason::kIgnored) continue;
    for (const VoxelIndex& i : voxels) saved.push_back({knowledge.map().CenterOf(i), reason});
  }
}

void RememberedAsides::Restore(const std::vector<SavedExploration::Aside>& saved) {
  for (const SavedExploration::Aside& aside : saved)
    (aside.reason == AsideReason::kIgnored ? ignored_ : restored_).push_back(aside);
}

bool IsIgnored(const LookMemory& memory, const VoxelIndex& i) {
  return memory.set_aside().Get(i, 0) == static_cast<std::uint8_t>(AsideReason::kIgnored);
}

}  // namespace thalweg::explorer
