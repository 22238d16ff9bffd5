#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string_view>
#include <vector>

#include "services/explorer/core/explorer.h"
#include "services/explorer/core/strategy/cover.h"
#include "tests/services/explorer/support/rooms.h"

namespace thalweg::explorer::test {

/// The strategies that choose among the explorer's candidates, and want nothing else: to these all rules of
/// the explorer apply alike. Those that are for some robots only are left out.
inline std::vector<std::string_view> ChoosingStrategies() {
  const PlanningMap nothing({.voxel_size = 0.1, .clearance = 0.15, .bounds = {}});
  const DenseGrid<std::uint8_t> none(nothing.box(), 0);
  std::vector<std::string_view> names;
  for (const StrategyInfo& info : Strategies()) {
    const std::unique_ptr<Strategy> strategy = Configure(info.name).make();
    const bool finds_its_own =
        strategy->FindCandidates({nothing, kHere.translation(), 0.15, none, 0.0}).has_value();
    if (!finds_its_own && strategy->inspection() == nullptr && info.robots == ForRobots::kAll)
      names.push_back(info.name);
  }
  return names;
}

/// An explorer by each of them.
class ChoosingExplorer : public testing::TestWithParam<std::string_view> {
 protected:
  ChoosingExplorer() {
    options_.strategy = Configure(GetParam());
    // What these tests are about is small and far away.
    if (options_.strategy.name == "cover")
      options_.strategy.make = [] { return std::make_unique<Cover>(Cover::Options{.least_yield = 0.0}); };
  }
  static Explorer With(const Explorer::Options& options, const std::vector<VoxelChange>& changes) {
    Explorer explorer(options);
    explorer.Update(changes, {}, kStart);
    return explorer;
  }

  Explorer::Options options_ = GoingOptions();
};

}  // namespace thalweg::explorer::test
