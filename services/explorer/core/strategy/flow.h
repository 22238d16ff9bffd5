#pragma once

#include "common/base/option_visitor.h"
#include "services/explorer/core/path/coarse_map.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/strategy/tour.h"

namespace thalweg::explorer {

/// Our own: a tour through all that is left, replanned at every decision, and of its first stop the place
/// from which most of the tour is done with.
///
/// Stops are clusters, those that lie near each other and far from the robot together (the further, the
/// coarser, so that their number is bounded). A tour is short, and it is early where much is unknown: a stop
/// weighs as much as its clusters and the unknown region behind them. The former tour, as far as it still
/// stands, is a first guess, and kept unless another is clearly better.
///
/// The order of the places where a robot stopped is hardly longer than the best one, known afterwards; how
/// many these are makes the way. So the first stop is looked at from where the whole tour costs least when
/// all clusters seen from there are left out: the way there, and on from there. A cluster in sight whose stop
/// remains is worth a little way, too: it is one thing less to come back for, and shows what lies behind.
class Flow final : public Strategy {
 public:
  struct Options {
    double eagerness = 3.0;    ///< [m] of tour accepted to have all that there is to see one meter earlier
    double hysteresis = 0.02;  ///< A tour must be shorter by that share to replace the one before.
    /// [m/m^2] of tour that a frontier in sight of the first stop is worth, where the rest of its own stop is
    /// not in sight.
    double sight_worth = 2.0;
  };
  explicit Flow(const Options& options) : options_(options) {}
  Choice Choose(const Situation& situation) override;

 private:
  struct Stop {
    std::vector<std::size_t> candidates;  ///< The first is the nearest to the robot.
    VoxelIndex place;
    double weight = 0.0;
  };
  std::vector<Stop> MakeStops(const Situation& situation) const;
  /// The stops in the order of the former tour, those that it did not know where they cost least.
  Tour AsBefore(const Situation& situation, const std::vector<Stop>& stops, const TourProblem& problem) const;
  /// Of the places from which the tour's first stop is seen the one from which the tour costs least.
  Choice SeeMost(const Situation& situation, CoarseMap& coarse, const std::vector<Stop>& stops,
                 const TourProblem& problem, const Tour& tour);

  Options options_;
  PathSearch onward_;                      ///< From the tour's second stop.
  std::vector<Eigen::Vector3d> former_W_;  ///< [m] Stops of the last tour, in its order.
};

void Visit(OptionVisitor& visitor, Flow::Options& options);  ///< Block `flow`.

}  // namespace thalweg::explorer
