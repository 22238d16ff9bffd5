#include "services/explorer/core/strategy/size_bonus.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thalweg::explorer {

Choice SizeBonus::Choose(const Situation& situation) {
  std::size_t best = 0;
  double best_cost = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    const Candidate& candidate = situation.candidates[n];
    const double size =
        static_cast<double>(std::clamp<std::size_t>(candidate.cluster.unknowns.size(), 1, 200));
    const double cost = candidate.length - 0.5 * std::log(size);
    if (cost >= best_cost) continue;
    best = n;
    best_cost = cost;
  }
  return StraightTo(situation, best);
}

}  // namespace thalweg::explorer
