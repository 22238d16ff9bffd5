#pragma once

#include "common/base/option_visitor.h"
#include "services/explorer/core/path/coarse_map.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/strategy/tour.h"

namespace thalweg::explorer {

/// Our own strategy: plans a tour through all remaining clusters at every decision, and goes to the position
/// from which its first stop is visible and the rest of the tour costs least.
///
/// A stop is a group of clusters that lie near each other. Groups are larger farther from the robot, so that
/// the number of stops is bounded. The tour should be short, and visit early the stops where much is unknown:
/// the weight of a stop is the size of its clusters plus the unknown region behind them. As far as the
/// previous tour is still valid, it is kept unless another is clearly better.
///
/// The order in which a robot visits its stops is hardly longer than the order that is best in hindsight; the
/// path length depends on the number of stops. The first stop is therefore looked at from the position for
/// which the path to it and the tour from there cost least together, where the tour leaves out every stop
/// that is visible from that position. A visible cluster whose stop remains in the tour is worth a short
/// detour, too: the robot need not come back for it, and learns what lies behind it.
class Flow final : public Strategy {
 public:
  struct Options {
    double eagerness = 3.0;    ///< [m] Tour length accepted in order to see everything one meter earlier.
    double hysteresis = 0.02;  ///< A tour replaces the previous one only if its cost is lower by this share.
    /// [m/m^2] Tour length that a visible cluster is worth per area, if the rest of its stop is not visible.
    double sight_worth = 2.0;
  };
  explicit Flow(const Options& options) : options_(options) {}
  Choice Choose(const Situation& situation) override;

 private:
  struct Stop {
    std::vector<std::size_t> candidates;  ///< Indices; the first has the shortest path.
    VoxelIndex place;                     ///< The first goal of the first candidate.
    double weight = 0.0;                  ///< [voxels]
  };
  std::vector<Stop> MakeStops(const Situation& situation) const;
  /// The stops in the order of the previous tour. Stops that are new are inserted where they cost least.
  Tour AsBefore(const Situation& situation, const std::vector<Stop>& stops, const TourProblem& problem) const;
  /// Goes to the position from which the tour's first stop is visible and the tour costs least.
  Choice SeeMost(const Situation& situation, CoarseMap& coarse, const std::vector<Stop>& stops,
                 const TourProblem& problem, const Tour& tour);

  Options options_;
  PathSearch onward_;                      ///< Flooded from the tour's second stop.
  std::vector<Eigen::Vector3d> former_W_;  ///< [m] Positions of the previous tour's stops, in its order.
};

void Visit(OptionVisitor& visitor, Flow::Options& options);  ///< Block `flow`.

}  // namespace thalweg::explorer
