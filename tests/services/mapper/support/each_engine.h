#pragma once

#include <gtest/gtest.h>

#include <string>

#include "services/mapper/core/map_engine.h"

/// For tests that hold whichever engine fuses the map.
namespace thalweg::test {

inline const auto kEngines = testing::Values(mapper::MapEngine::kBlocks, mapper::MapEngine::kOctomap);

inline std::string NameOfEngine(const testing::TestParamInfo<mapper::MapEngine>& tested) {
  switch (tested.param) {
    case mapper::MapEngine::kBlocks:
      return "Blocks";
    case mapper::MapEngine::kOctomap:
      return "Octomap";
  }
  return "NoName";
}

}  // namespace thalweg::test
