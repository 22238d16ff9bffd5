#pragma once

#include "services/explorer/core/strategy.h"
#include "services/explorer/core/tour.h"

namespace thalweg::explorer {

/// Our own: a tour through all that is left, replanned at every decision, of which the first stop is gone to.
///
/// Going to the nearest leaves work behind that is come back for: the tours of nearest neighbours through
/// what is left are a quarter longer than good ones. Stops are clusters, those that lie near each other and
/// far from the robot together (the further, the coarser, so that their number is bounded). A tour is short,
/// and it is early where much is unknown: a stop weighs as much as the unknown region behind it. The former
/// tour, as far as it still stands, is a first guess, and kept unless another is clearly better.
class Flow final : public Strategy {
 public:
  explicit Flow(const FlowOptions& options) : options_(options) {}
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

  FlowOptions options_;
  std::vector<Eigen::Vector3d> former_W_;  ///< [m] Stops of the last tour, in its order.
};

}  // namespace thalweg::explorer
