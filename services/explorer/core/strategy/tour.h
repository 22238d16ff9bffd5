#pragma once

#include <cstddef>
#include <vector>

namespace thalweg::explorer {

/// An ordering problem: visit all stops, beginning at a start and ending at any stop.
struct TourProblem {
  std::vector<double> from_start;             ///< [m] Path length from the start to each stop.
  std::vector<std::vector<double>> distance;  ///< [m] Path lengths between stops, symmetric.
  std::vector<double> delay_price;            ///< For each stop, the cost of reaching it one meter later.
};
using Tour = std::vector<std::size_t>;  ///< Indices of all stops in the order of visits.

inline constexpr double kLeastTourGain = 1e-9;  ///< [m] Smaller gains of a tour are rounding errors.

/// [m] Length of the tour + sum over the stops of (length of the tour up to the stop * its delay_price).
double TourCost(const TourProblem& problem, const Tour& tour);

/// The tour that always continues to the nearest remaining stop.
Tour NearestNeighborTour(const TourProblem& problem);

/// Improves a tour until no single move reduces its cost. The moves reverse a part of the tour (2-opt) or
/// insert up to three consecutive stops elsewhere, in either direction (Or-opt) [Lin 1965; Or 1976]. The
/// result never costs more than the given tour.
Tour ImprovedTour(const TourProblem& problem, Tour tour);

}  // namespace thalweg::explorer
