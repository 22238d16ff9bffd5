#pragma once

#include <cstdint>
#include <random>

#include "common/base/option_visitor.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Goes to a random one of all unknown voxels that could be seen: the baseline of baselines.
class Random final : public Strategy {
 public:
  struct Options {
    std::uint32_t seed = 1;
  };
  explicit Random(const Options& options) : random_(options.seed) {}
  Choice Choose(const Situation& situation) override;

 private:
  std::mt19937 random_;  // whose numbers the standard fixes
};

void Visit(OptionVisitor& visitor, Random::Options& options);

}  // namespace thalweg::explorer
