#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "services/cli/adapter/simulated_camera.h"
#include "services/evaluator/adapter/scene.h"
#include "services/surface/evaluation/exploration.h"

namespace thalweg::cli {

/// What an exploration by rifts came to by the truth, with what shows the faults that the source thesis names
/// itself (Section 5.9).
struct RiftRun {
  int start = 0;
  surface::ExplorationEnd end = surface::ExplorationEnd::kAllMoves;
  int moves = 0;
  std::size_t views = 0;
  std::size_t refused = 0;  ///< Poses from which it should have looked, and could not.
  double path = 0.0;        ///< [m] Straight lines between the poses that it looked from.
  // Shares of the surface that the scenario's robot can observe, as in `thalweg evaluate --surface`.
  double seen = 0.0;
  double inspected = 0.0;

  // The path ignores the robot's body:
  std::size_t poses = 0;     ///< All poses of the ways to dominant rifts, and
  std::size_t in_solid = 0;  ///< those in which the robot would touch something or be outside of the world.
  // High precision is needed:
  std::size_t points = 0;  ///< All points of views but the first, and
  std::size_t merged = 0;  ///< those that became points of the view before.
  // Memory grows with the number of scans:
  std::size_t vertices = 0;
  std::size_t cubes = 0;  ///< Cubes of 5 cm that contain one.
  // Edges that hang in free space:
  std::size_t rifts = 0;
  std::size_t rift_edges = 0;  ///< Edges of the rifts that are left, and
  std::size_t hanging = 0;     ///< those whose middle is farther than 0.1 m from any surface.
};

/// Explorations by rifts, as Chapter 5 of the source thesis prints them, from random starts of a scenario.
/// Threading: one thread.
class RiftRuns {
 public:
  /// Throws as SimulatedCamera, Scene and CheckOptions do.
  RiftRuns(const std::string& scenario, const std::vector<std::string>& overrides, bool exact,
           const surface::ExplorationOptions& options);

  /// @param start  As evaluator::Scene::Start takes it.
  RiftRun From(int start);

 private:
  evaluator::Scene scene_;
  SimulatedCamera camera_;
  RobotModel robot_;
  surface::ExplorationOptions options_;
};

// A table for people.
std::string RiftRunHeading();
std::string ToText(const RiftRun& run);
std::string RiftRunLegend();
nlohmann::ordered_json ToJson(const std::vector<RiftRun>& runs);

}  // namespace thalweg::cli
