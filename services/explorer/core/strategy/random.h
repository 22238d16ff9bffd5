#pragma once

#include <cstdint>
#include <random>

#include "common/base/option_visitor.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Draws one of all the candidates' unknown voxels at random and goes to its cluster: the weakest baseline.
class Random final : public Strategy {
 public:
  struct Options {
    std::uint32_t seed = 1;
  };
  explicit Random(const Options& options) : random_(options.seed) {}
  Choice Choose(const Situation& situation) override;

 private:
  std::mt19937 random_;  // The standard defines its sequence.
};

void Visit(OptionVisitor& visitor, Random::Options& options);  ///< Field `random_seed`.

}  // namespace thalweg::explorer
