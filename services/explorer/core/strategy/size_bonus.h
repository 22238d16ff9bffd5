#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// A strategy of one's own, as an example: the least of L - 0.5 m ln(min(n, 200)), so that of two clusters
/// the larger one (n unknown voxels) is worth a longer path L.
///
/// A strategy derives from Strategy, is told of a Situation (map, costs of all that can be reached, clusters
/// with the places from which each is in sight), and answers with a Choice. Its line in the table in
/// core/strategy.cpp and its name in common/scenario/scenario.proto make it known to scenarios, `thalweg run`
/// and `thalweg evaluate`.
class SizeBonus final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override {
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
};

}  // namespace thalweg::explorer
