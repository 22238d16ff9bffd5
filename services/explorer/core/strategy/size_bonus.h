#pragma once

#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// An example of a strategy: minimizes L - 0.5 m * ln(min(n, 200)), where L is the path length and n the
/// cluster's number of unknown voxels. A larger cluster is thus worth a longer path.
class SizeBonus final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override;
};

}  // namespace thalweg::explorer
