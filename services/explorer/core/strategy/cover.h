#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/voxel/grid_order.h"
#include "services/explorer/core/strategy/cover_stops.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Our own strategy for short paths to the very end: plans a tour over the fewest and nearest positions from
/// which everything left is seen, leaves out what is not worth its path, and goes to its first stop.
///
/// What is left when most is known are many small pockets. A tour from pocket to pocket is long; one over
/// positions that each show several of them, from up to `look_range` away, is shorter (CoverTourSearch):
///   1. What can be seen from the present position is looked at first: turning costs no path.
///   2. Items are samples of all clusters. Rays from them outward cross the positions that may see them; in
///      each cell of a lattice the voxel crossed by most rays is a position to consider. Near an item,
///      unknown voxels do not block the sight: they are likely to be the same pocket.
///   3. The tour should be short, and show early what is much: see Flow for the weights. The search
///      begins with the previous tour.
///   4. What lies at the end of a path of more than 10 m is planned for by zones (ZoneStops), and one by one
///      when the robot comes near, before it matters which position shows it.
///   5. Stops, alone or in a row, that cost more path than what they show is worth are left out. When no stop
///      is worth its path, there is no choice.
/// Where time counts (Situation::time), the stops are views: a position together with an orientation, the
/// present position among them in place of 1. Prices are times (StopPrices): a turn that fits into the
/// travel costs nothing, so that the tour prefers to look where the robot comes by with the camera turned
/// the right way, and turns on the spot only for what is worth the turn. A meter stands for the time in which
/// the robot travels it at its usual speed there.
class Cover final : public Strategy {
 public:
  struct Options {
    double eagerness = 2.0;     ///< [m] Tour length accepted in order to see everything one meter earlier.
    double least_yield = 0.15;  ///< [m^2/m] Area that is worth a meter of path. 0 = any is.
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit Cover(const Options& options);
  /// Without a path when nothing is worth its path.
  Choice Choose(const Situation& situation) override;
  bool weighs_looks() const override { return true; }

  /// A stop of the previous tour.
  struct FormerStop {
    Eigen::Vector3d p_W;  ///< [m]
    std::optional<Eigen::Matrix3d> R_WB;
  };

 private:
  /// Whether a voxel was looked at from nearly that position by a turn on the spot.
  bool LookedAt(const VoxelIndex& unknown, const Eigen::Vector3d& p_W) const;
  /// Whether a body at `p_W` would see an unknown voxel if others near it did not block the sight.
  bool MaySee(const Situation& situation, const Eigen::Vector3d& p_W, const VoxelIndex& unknown) const;
  /// Turns to the view from here that shows most, if that is enough.
  std::optional<Choice> LookFromHere(const Situation& situation);
  /// Whether a stop shows an unknown voxel, or may show it where the robot is not yet.
  bool Shows(const Situation& situation, const CoverStop& stop, const VoxelIndex& unknown) const;
  /// Goes to a stop to look at all that it shows.
  Choice GoTo(const Situation& situation, const CoverStop& stop);
  /// Goes to the first stop of the tour; without a path when nothing is worth its path.
  /// @param far  [m] Path from which on clusters are planned for by zones.
  Choice ChooseByTour(const Situation& situation, double far);
  std::vector<CoverStop> FindStops(const Situation& situation, const std::vector<CoverItem>& items);

  Options options_;
  std::vector<std::vector<RayStep>> rays_;                          ///< Made at the first choice.
  std::map<VoxelIndex, Eigen::Vector3d, GridOrder> looked_from_W_;  ///< [m] By unknown voxel.
  std::vector<FormerStop> formers_;                                 ///< In the tour's order.
};

void Visit(OptionVisitor& visitor, Cover::Options& options);  ///< Block `cover`.

}  // namespace thalweg::explorer
