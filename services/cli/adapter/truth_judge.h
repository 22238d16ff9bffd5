#pragma once

#include <future>
#include <optional>
#include <string>

#include "common/scenario/scenario.h"
#include "services/cli/report/coverage_tally.h"
#include "services/simulator/core/truth.h"

namespace thalweg::cli {

/// Compares a map with the true world of the scenario, where there is one. The true map takes seconds to
/// compute; that happens on a thread of its own.
class TruthJudge {
 public:
  /// @param start_W  Any place where the robot has been. @param voxel_size  [m] of the map to be judged.
  void Begin(const Scenario& scenario, const Eigen::Vector3d& start_W, double voxel_size);
  bool begun() const { return begun_; }

  /// The true map, once it is there; null before, and when there is none.
  const simulator::TrueMap* Poll();
  /// The same, waiting for it.
  const simulator::TrueMap* Wait();

  /// Whether a voxel can be seen at all. @pre Poll() was not null.
  bool Observable(const VoxelIndex& voxel) const;

  const std::string& error() const { return error_; }  ///< Why there will be none; empty while there may.

 private:
  bool begun_ = false;
  std::future<simulator::TrueMap> computing_;
  std::optional<simulator::TrueMap> truth_;
  std::string error_;
};

}  // namespace thalweg::cli
