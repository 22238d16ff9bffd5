#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/timed_pose.h"
#include "common/scenario/scenario.h"
#include "services/evaluator/core/noise_free_map.h"
#include "services/evaluator/core/outcome.h"
#include "services/evaluator/core/surface_truth.h"

namespace thalweg::evaluator {

/// The source of the robot's pose in a run.
enum class PoseSource : std::uint8_t {
  kTruth,
  kOdometry,  ///< Odometry from its own stereo images, rendered for the scenario's stereo_camera.
};

/// Throws std::invalid_argument where parts of a scenario's world move (`world.moving`).
/// @param for_what  What cannot be had there, at the beginning of a sentence.
void CheckNothingMoves(const std::vector<std::string>& scenarios, const std::vector<std::string>& overrides,
                       const std::string& for_what);

/// A scenario prepared for explorations in lock step: its world, loaded once, and the ground truth.
/// Threading: Run may be called from several threads at once.
class Scene {
 public:
  /// Throws as LoadScenario, LoadWorld, CheckExtent and StartFrom do.
  explicit Scene(const std::string& name_or_file, const std::vector<std::string>& overrides = {});

  const std::string& name() const { return name_; }
  const Scenario& scenario() const { return scenario_; }
  const simulator::World& world() const { return world_; }

  /// @param seed  0 = the scenario's start; otherwise a random position connected to it, with a random
  /// heading.
  RigidTransform Start(int seed) const;
  /// @param strategy  Empty = the scenario's.
  LockstepOptions Options(const std::string& strategy, int seed, PoseSource pose = PoseSource::kTruth,
                          MotionModel motion = MotionModel::kKinematic) const;
  /// What a robot that starts there can observe. Starts that are connected share one object.
  std::shared_ptr<const simulator::TrueMap> Truth(const Eigen::Vector3d& start_W) const;
  /// The surface that it can observe, for the same truth.
  std::shared_ptr<const SurfaceTruth> Surfaces(const std::shared_ptr<const simulator::TrueMap>& truth,
                                               const Eigen::Vector3d& start_W) const;
  /// How the truth is determined.
  simulator::TrueMap::Options TruthOptions() const;

  /// Runs one exploration and compares its map with the truth. Fills in scenario, strategy and seed, but not
  /// the run's number; with odometry, the strategy's name is marked as such.
  /// @param stop  When requested, the run ends soon, as interrupted.
  /// @param with_tail  Whether to record the run's tail, which takes a few percent of its time.
  /// @param meshes     If given, surfaces are fused and judged, and the mesh becomes MeshFile in this folder and,
  ///   as a picture, the same with .png, unless the run was interrupted. Throws std::runtime_error if it cannot
  ///   be written.
  Outcome Run(const std::string& strategy, int seed, PoseSource pose = PoseSource::kTruth,
              std::stop_token stop = {}, bool with_tail = false, MotionModel motion = MotionModel::kKinematic,
              const std::optional<std::filesystem::path>& meshes = {}) const;
  /// SCENARIO-STRATEGY-SEED.ply, or with poses from odometry SCENARIO-STRATEGY-odometry-SEED.ply.
  std::string MeshFile(const std::string& strategy, int seed, PoseSource pose) const;
  /// Judges a trajectory that another program flew, see Fly; it has its name in place of a strategy's, and is
  /// run 0. Throws std::invalid_argument as Fly does, and if it begins in a wall or outside of the world.
  Outcome JudgeTrajectory(std::span<const TimedPose> T_WBs, const std::string& name,
                          std::stop_token stop = {}) const;

 private:
  std::unique_ptr<mapper::FusedMap> NewMap() const;
  /// For a run of the depth sensor with noise; nothing for others.
  std::optional<NoiseFreeMap> NewNoiseFreeMap(const LockstepOptions& options) const;

  std::string name_;
  Scenario scenario_;
  simulator::World world_;
  mutable std::mutex mutex_;
  mutable std::vector<std::shared_ptr<const simulator::TrueMap>> truths_;  ///< Guarded by mutex_.
  /// By truth; guarded by mutex_.
  mutable std::vector<
      std::pair<std::shared_ptr<const simulator::TrueMap>, std::shared_ptr<const SurfaceTruth>>>
      surfaces_;
  mutable std::vector<Eigen::Vector3d> start_places_;  ///< Guarded by mutex_; empty until first needed.
};

}  // namespace thalweg::evaluator
