#include "services/explorer/core/strategy/random.h"

#include <algorithm>

namespace thalweg::explorer {

void Visit(OptionVisitor& visitor, Random::Options& options) {
  visitor.Whole("random_seed", options.seed);
}

Choice Random::Choose(const Situation& situation) {
  std::size_t voxels = 0;
  for (const Candidate& candidate : situation.candidates) voxels += candidate.cluster.unknowns.size();
  std::size_t drawn = random_() % std::max<std::size_t>(1, voxels);
  std::size_t n = 0;
  for (; drawn >= situation.candidates[n].cluster.unknowns.size() && n + 1 < situation.candidates.size();
       ++n) {
    drawn -= situation.candidates[n].cluster.unknowns.size();
  }
  return StraightTo(situation, n);
}

}  // namespace thalweg::explorer
