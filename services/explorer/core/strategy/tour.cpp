#include "services/explorer/core/strategy/tour.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace thalweg::explorer {
namespace {

constexpr std::size_t kLongestMove = 3;  // [stops]

}  // namespace

double TourCost(const TourProblem& problem, const Tour& tour) {
  double length = 0.0;
  double delays = 0.0;
  for (std::size_t n = 0; n < tour.size(); ++n) {
    length += n == 0 ? problem.from_start[tour[0]] : problem.distance[tour[n - 1]][tour[n]];
    delays += problem.delay_price[tour[n]] * length;
  }
  return length + delays;
}

Tour NearestNeighborTour(const TourProblem& problem) {
  Tour left(problem.from_start.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  Tour tour;
  while (!left.empty()) {
    const std::vector<double>& distance = tour.empty() ? problem.from_start : problem.distance[tour.back()];
    const auto nearest = std::min_element(
        left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return distance[a] < distance[b]; });
    tour.push_back(*nearest);
    left.erase(nearest);
  }
  return tour;
}

Tour ImprovedTour(const TourProblem& problem, Tour tour) {
  const std::size_t count = tour.size();
  double cost = TourCost(problem, tour);
  Tour other;
  const auto take_if_better = [&] {
    const double its_cost = TourCost(problem, other);
    if (its_cost >= cost - kLeastTourGain) return false;
    cost = its_cost;
    tour = other;
    return true;
  };
  for (bool improved = true; improved;) {
    improved = false;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        other = tour;
        std::reverse(other.begin() + static_cast<std::ptrdiff_t>(i),
                     other.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        improved |= take_if_better();
      }
    }
    for (std::size_t length = 1; length <= std::min(kLongestMove, count); ++length) {
      for (std::size_t i = 0; i + length <= count; ++i) {
        for (std::size_t to = 0; to + length <= count; ++to) {
          if (to == i) continue;
          const auto begin = static_cast<std::ptrdiff_t>(std::min(i, to));
          const auto middle = static_cast<std::ptrdiff_t>(i < to ? i + length : i);
          const auto end = static_cast<std::ptrdiff_t>(std::max(i, to) + length);
          other = tour;
          std::rotate(other.begin() + begin, other.begin() + middle, other.begin() + end);
          improved |= take_if_better();
          // The moved stops in reverse order.
          std::reverse(other.begin() + static_cast<std::ptrdiff_t>(to),
                       other.begin() + static_cast<std::ptrdiff_t>(to + length));
          improved |= take_if_better();
        }
      }
    }
  }
  return tour;
}

}  // namespace thalweg::explorer
