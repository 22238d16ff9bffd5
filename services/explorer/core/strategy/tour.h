#pragma once

#include <cstddef>
#include <vector>

namespace thalweg::explorer {

/// In which order to visit a number of stops, from a start, ending anywhere.
struct TourProblem {
  std::vector<double> from_start;             ///< [m] to each stop
  std::vector<std::vector<double>> distance;  ///< [m] between stops
  std::vector<double> delay_price;            ///< Of each stop, what it costs to be there a meter later.
};
using Tour = std::vector<std::size_t>;  ///< Each stop once, in the order of visits.

/// [m] Length + sum over the stops of (way to the stop * its delay_price).
double TourCost(const TourProblem& problem, const Tour& tour);

/// The tour that always goes on to the nearest stop.
Tour NearestNeighborTour(const TourProblem& problem);

/// Improves a tour by reversing stretches (2-opt) and moving up to three stops in a row elsewhere, either way
/// round (Or-opt) [Lin 1965; Or 1976], until nothing of that helps. Never worse than what it was given.
Tour ImprovedTour(const TourProblem& problem, Tour tour);

}  // namespace thalweg::explorer
