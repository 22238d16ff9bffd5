#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>

#include "common/scenario/scenario.h"
#include "services/cli/report/coverage_tally.h"
#include "services/simulator/core/truth.h"
#include "services/simulator/core/world.h"

namespace thalweg::cli {

/// Compares a map with the scenario's true world, if there is one. Computing the true map takes seconds and
/// runs on a thread of its own.
class TruthJudge {
 public:
  /// Starts computing the true map.
  /// @param start_W     Any position where the robot has been.
  /// @param voxel_size  [m] Voxel size of the map to be compared.
  void Begin(const Scenario& scenario, const Eigen::Vector3d& start_W, double voxel_size);
  bool begun() const { return begun_; }

  /// The true map once it is available; null before, and if there is none.
  const simulator::TrueMap* Poll();
  /// As Poll, but waits for it.
  const simulator::TrueMap* Wait();

  /// Whether a voxel can be observed at all.
  /// @pre Poll() has returned a map.
  bool Observable(const VoxelIndex& voxel) const;

  /// [m^2] Area of all surface that the robot can observe; absent where there is no true map. Waits for it,
  /// and computes O(area) visibility tests on all cores.
  std::optional<double> ObservableSurface();

  /// Why there is no true map; empty while there may still be one.
  const std::string& error() const { return error_; }

 private:
  struct Truth {
    simulator::World world;
    Eigen::Vector3d start_W;
    simulator::TrueMap::Options options;
    simulator::TrueMap map;
  };

  bool begun_ = false;
  std::future<std::unique_ptr<Truth>> computing_;
  std::unique_ptr<Truth> truth_;
  std::string error_;
};

}  // namespace thalweg::cli
