#include "services/explorer/core/view/goal_memory.h"

#include <utility>

#include "common/base/parallel.h"

namespace thalweg::explorer {
namespace {

constexpr std::size_t kWorthAThread = 16;  // [clusters] Goals of fewer are found sooner than a thread begins.

}  // namespace

std::vector<std::vector<VoxelIndex>> GoalMemory::GoalsOf(const std::vector<Cluster>& clusters,
                                                         const PlanningMap& map, const PathSearch& search,
                                                         const ViewPlanner& views) {
  changes_.Update(map, search);
  Entries entries;
  struct Missing {
    const std::vector<VoxelIndex>* sample;
    Entry* entry;
  };
  std::vector<Missing> missing;
  std::vector<const Entry*> of;
  for (const Cluster& cluster : clusters) {
    std::vector<VoxelIndex> sample = GoalFinder::SampleOf(cluster);
    const auto former = entries_.find(sample);
    const bool valid =
        former != entries_.end() && changes_.LastIn(former->second.places.depends_on) <= former->second.found;
    const auto [at, is_new] =
        entries.try_emplace(std::move(sample), valid ? std::move(former->second) : Entry{{}, changes_.now()});
    if (is_new && !valid) missing.push_back({&at->first, &at->second});
    of.push_back(&at->second);
  }
  ParallelFor(missing.size(), kWorthAThread, [&](std::size_t n) {
    missing[n].entry->places = finder_.PlacesOf(*missing[n].sample, map, search, views);
  });
  entries_ = std::move(entries);
  searched_ = missing.size();
  std::vector<std::vector<VoxelIndex>> goals;
  goals.reserve(of.size());
  for (const Entry* entry : of) goals.push_back(GoalFinder::NearestFirst(entry->places, search));
  return goals;
}

}  // namespace thalweg::explorer
