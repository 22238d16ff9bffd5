#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/scenario/scenario.h"
#include "services/evaluator/core/outcome.h"

namespace thalweg::evaluator {

/// Where the robot of a run takes its pose from.
enum class PoseSource : std::uint8_t {
  kTruth,
  kOdometry,  ///< Its own stereo images, as the scenario's stereo_camera sees them.
};

/// A scenario as explorations in lock step: its world, loaded once, and what is true of it.
/// Threading: runs may be made from several threads at once.
class Scene {
 public:
  /// Throws as LoadScenario, LoadWorld, CheckExtent and StartFrom do.
  explicit Scene(const std::string& name_or_file, const std::vector<std::string>& overrides = {});

  const std::string& name() const { return name_; }
  const Scenario& scenario() const { return scenario_; }
  const simulator::World& world() const { return world_; }

  /// @param seed  0 = where the scenario starts; else a random place connected to it, looking anywhere.
  RigidTransform Start(int seed) const;
  /// @param strategy  Empty = the scenario's.
  LockstepOptions Options(const std::string& strategy, int seed, PoseSource pose = PoseSource::kTruth) const;
  /// What a robot that starts there could find out; the same object for starts that are connected.
  std::shared_ptr<const simulator::TrueMap> Truth(const Eigen::Vector3d& start_W) const;

  /// One exploration from that start, judged. Scenario, strategy and seed are filled in, the run's number is
  /// not; with odometry the strategy's name says so. @param stop  When requested, it ends soon, as
  /// interrupted.
  Outcome Run(const std::string& strategy, int seed, PoseSource pose = PoseSource::kTruth,
              std::stop_token stop = {}) const;

 private:
  std::string name_;
  Scenario scenario_;
  simulator::World world_;
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<const simulator::TrueMap>> truths_;  ///< Guarded by mutex_.
  mutable std::vector<Eigen::Vector3d>
      start_places_;  ///< Guarded by mutex_; empty until the first is sought.
};

}  // namespace thalweg::evaluator
