#pragma once

#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Goes to the cluster with the shortest path
/// [Yamauchi: A frontier-based approach for autonomous exploration, CIRA 1997].
class Closest final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override;
};

}  // namespace thalweg::explorer
