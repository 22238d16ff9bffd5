#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "services/evaluator/core/cover_tour.h"
#include "services/evaluator/core/view_lattice.h"
#include "services/simulator/core/voxel_sight.h"

namespace thalweg::evaluator {

/// The coverages to which offline tours lead.
inline constexpr std::array kTourCoverages = {0.95, 0.99, 0.995, 0.998};

/// A tour of a robot that knows the world. An upper bound of the shortest: the search may miss shorter ones.
struct OfflineTour {
  std::optional<double> length;  ///< [m] Empty: no tour over the places leads that far.
  double coverage = 0.0;  ///< Share of all observable voxels seen along it; at least the one asked for.
  std::size_t stops = 0;  ///< Besides the start.
  /// [m] In W: the start, and the places that it visits or passes through. Between two of them the path is
  /// straight, or leads around a corner.
  std::vector<Eigen::Vector3d> path_W = {};
  bool operator==(const OfflineTour&) const = default;
};
struct OfflineTours {
  std::array<OfflineTour, kTourCoverages.size()> to = {};  ///< To each of kTourCoverages.
  std::size_t places = 0;    ///< Number in the lattice; 0: the robot does not fit at the start.
  double spacing = 0.0;      ///< [m] Edge of the lattice's cells.
  int iterations = 0;        ///< Made by the search, all tours together.
  bool out_of_time = false;  ///< The budget ended the search: the tours may differ from machine to machine.
  bool operator==(const OfflineTours&) const = default;
};

/// What a robot that knows the world plans its tours with: places that it reaches with its clearance, and
/// what it sees from each of them. Starts that are connected share one ground.
///
/// The robot sees, at each place of a lattice that it visits or passes through, all around, or what a level
/// camera sees when it turns. A voxel counts as seen by the tests of the truth itself (VoxelSight).
///
/// Only a random sample of the observable voxels is looked for from every place. The coverage of each
/// round's tour is then counted on all of them; only tours that see enough count, and the next round asks for
/// more or less of the sample accordingly.
///
/// Memory: places * samples / 8 bytes for what is seen, and up to 8 * places^2 bytes of shortest paths for
/// each search: 8 and 72 MB at most with the default options, beside about 30 bytes per voxel of the world
/// and 24 per point of its surfaces that is looked at.
/// Threading: const calls from any number of threads.
class TourGround {
 public:
  struct Options {
    double clearance = 0.15;  ///< [m] From the robot's center, or axis, to the nearest surface.
    double spacing = 0.3;     ///< [m] Least spacing of the lattice.
    std::size_t max_places = 3000;
    std::size_t max_samples = 20'000;
    std::uint32_t seed = 1;
    /// Made by the search for each tour, in each of kRounds rounds.
    int iterations = 300;
    double budget = 60.0;  ///< [s] For all tours from a start.
    bool operator==(const Options&) const = default;
  };
  static constexpr int kRounds = 8;

  /// @param truth   Truth of the start, shared.
  /// @param options_of_truth  With which it was made.
  /// @param stop    When requested, the construction ends soon, and the object must not be used.
  /// Throws std::invalid_argument when the robot does not fit at the start with its clearance.
  TourGround(const simulator::World& world, std::shared_ptr<const simulator::TrueMap> truth,
             const simulator::TrueMap::Options& options_of_truth, const Eigen::Vector3d& start_W,
             const Options& options, const std::stop_token& stop = {});

  /// Whether a robot with that clearance fits at a start.
  static bool Fits(const simulator::World& world, const RobotModel& robot, const Eigen::Vector3d& start_W,
                   double clearance);
  /// Whether a robot that starts there is on this ground.
  bool HoldsFor(const Eigen::Vector3d& start_W) const;
  const ViewLattice& lattice() const { return lattice_; }
  std::size_t samples() const { return samples_.size(); }

  /// Finds tours from a start for which HoldsFor is true; they begin with the path to the center of its
  /// voxel. The same options give the same tours unless the budget ends the search.
  /// @param elapsed  [s] How long the search has taken so far, for the budget. Empty: it takes what it takes.
  OfflineTours ToursFrom(const Eigen::Vector3d& start_W, const std::stop_token& stop = {},
                         const std::function<double()>& elapsed = {}) const;

 private:
  Eigen::Vector3d PositionOf(const VoxelIndex& place) const;
  /// Share of all observable voxels seen from the places of a path, which begins with the start.
  double CoverageFrom(std::span<const Eigen::Vector3d> places_W) const;

  Options options_;
  double voxel_size_;
  std::shared_ptr<const simulator::TrueMap> truth_;
  RobotModel robot_;
  Eigen::Vector3d first_start_W_;
  DenseGrid<std::uint8_t> reachable_;  ///< With the clearance.
  simulator::VoxelSight sight_;
  ViewLattice lattice_;
  std::vector<std::size_t> samples_;  ///< Indices into sight_.voxels().
  BitTable seen_;                     ///< The samples, from each place.
};

}  // namespace thalweg::evaluator
