#include "services/explorer/core/aftermath.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace thalweg::explorer {
namespace {

/// Counts a look at the facets that it has not inspected.
void CountTries(const Task& task, Knowledge& knowledge) {
  InspectedSurface* const surface = knowledge.inspected();
  if (surface == nullptr) return;
  for (const Facet& facet : task.facets) {
    if (surface->Open(knowledge.map(), facet)) surface->CountTry(facet);
  }
}

}  // namespace

void RememberArrival(const Task& task, Knowledge& knowledge, Time now) {
  const PlanningMap& map = knowledge.map();
  std::vector<VoxelIndex> left;
  std::vector<std::optional<Sensed>> sensed;  // per voxel left: what the scan from the end pose sensed there
  for (const VoxelIndex& i : task.target) {
    if (!IsTarget(map, i)) continue;
    left.push_back(i);
    sensed.push_back(knowledge.LastSensed(i));
  }
  // When going somewhere brought no result at all, the whole cluster is set aside, because a second visit
  // costs more than it ever brings. If the target spans several clusters, only voxels that the last scan
  // could show are set aside, one by one.
  const bool fruitless = task.plan.kind == Plan::Kind::kGo && task.KnownOfTarget(map) == 0;
  const bool several = !task.choice.target.empty() &&
                       std::any_of(sensed.begin(), sensed.end(), [](const auto& s) { return s.has_value(); });
  const bool nothing_sensed = std::count(sensed.begin(), sensed.end(), Sensed::kNothing) >
                              std::count(sensed.begin(), sensed.end(), Sensed::kDepth);
  LookMemory& memory = knowledge.memory();
  for (std::size_t n = 0; n < left.size(); ++n) {
    if (task.plan.kind == Plan::Kind::kLook)
      memory.CountLook(left[n], AsideReason::kLookedAt, sensed[n].value_or(Sensed::kDepth), now);
    if (!fruitless || (several && !sensed[n])) continue;
    const bool no_depth = several ? sensed[n] == Sensed::kNothing : nothing_sensed;
    memory.SetAside(left[n], no_depth ? AsideReason::kNoDepth : AsideReason::kVisited, now);
  }
  CountTries(task, knowledge);
}

void RememberFailure(const Task& task, Knowledge& knowledge, Time now) {
  for (const VoxelIndex& i : task.target) {
    if (IsTarget(knowledge.map(), i))
      knowledge.memory().CountLook(i, AsideReason::kLostThere, Sensed::kDepth, now);
  }
  CountTries(task, knowledge);
}

}  // namespace thalweg::explorer
