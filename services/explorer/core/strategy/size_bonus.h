#pragma once

#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// An example of a strategy of one's own: the least of L - 0.5 m ln(min(n, 200)), so that of two clusters the
/// larger one (n unknown voxels) is worth a longer path L.
class SizeBonus final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override;
};

}  // namespace thalweg::explorer
