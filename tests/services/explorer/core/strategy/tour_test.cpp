#include "services/explorer/core/strategy/tour.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

/// Stops at random positions in a square, with the start in its middle.
TourProblem RandomProblem(std::mt19937& random, std::size_t count, double eagerness) {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t n = 0; n < count; ++n) {
    places.emplace_back(test::RandomDouble(random, -5.0, 5.0), test::RandomDouble(random, -5.0, 5.0));
  }
  TourProblem problem;
  for (const Eigen::Vector2d& place : places) {
    problem.from_start.push_back(place.norm());
    problem.distance.emplace_back();
    for (const Eigen::Vector2d& other : places) problem.distance.back().push_back((place - other).norm());
    problem.delay_price.push_back(eagerness * test::RandomDouble(random, 0.0, 1.0));
  }
  return problem;
}

double LeastCost(const TourProblem& problem) {
  Tour tour(problem.from_start.size());
  std::iota(tour.begin(), tour.end(), std::size_t{0});
  double least = std::numeric_limits<double>::infinity();
  do {
    least = std::min(least, TourCost(problem, tour));
  } while (std::next_permutation(tour.begin(), tour.end()));
  return least;
}

class Tours : public testing::TestWithParam<unsigned> {
 protected:
  std::mt19937 random_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Seeds, Tours, testing::Range(1U, 31U));

TEST_P(Tours, OfFewStopsAreNearTheBestOfAllOrders) {
  for (const double eagerness : {0.0, 0.3}) {
    const TourProblem problem = RandomProblem(random_, 7, eagerness);
    const double cost = TourCost(problem, ImprovedTour(problem, NearestNeighborTour(problem)));
    const double least = LeastCost(problem);
    EXPECT_GE(cost, least - 1e-9);
    EXPECT_LE(cost, 1.15 * least);
  }
}

TEST_P(Tours, AreNoWorseThanWhatTheyWereMadeFromAndVisitEveryStopOnce) {
  for (const double eagerness : {0.0, 0.3}) {
    const TourProblem problem = RandomProblem(random_, 25, eagerness);
    Tour tour(25);
    std::iota(tour.begin(), tour.end(), std::size_t{0});
    for (const Tour& given : {tour, NearestNeighborTour(problem)}) {
      Tour improved = ImprovedTour(problem, given);
      EXPECT_LE(TourCost(problem, improved), TourCost(problem, given));
      std::sort(improved.begin(), improved.end());
      EXPECT_EQ(improved, tour);
    }
  }
}

TEST_P(Tours, AreNotImprovedByAnyReversalNorByMovingUpToThreeStops) {
  for (const double eagerness : {0.0, 0.3}) {
    const TourProblem problem = RandomProblem(random_, 20, eagerness);
    const Tour tour = ImprovedTour(problem, NearestNeighborTour(problem));
    const double least = TourCost(problem, tour) - 1e-6;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      for (std::size_t j = i + 1; j <= tour.size(); ++j) {
        const auto first = static_cast<std::ptrdiff_t>(i);
        const auto end = static_cast<std::ptrdiff_t>(j);
        Tour other = tour;
        std::reverse(other.begin() + first, other.begin() + end);
        EXPECT_GE(TourCost(problem, other), least) << "reversed from " << i << " to " << j;
        if (j - i > 3) continue;
        for (const bool reversed : {false, true}) {
          Tour stops(tour.begin() + first, tour.begin() + end);
          if (reversed) std::ranges::reverse(stops);
          Tour rest = tour;
          rest.erase(rest.begin() + first, rest.begin() + end);
          for (std::size_t to = 0; to <= rest.size(); ++to) {
            other = rest;
            other.insert(other.begin() + static_cast<std::ptrdiff_t>(to), stops.begin(), stops.end());
            EXPECT_GE(TourCost(problem, other), least) << i << ' ' << j << ' ' << to << ' ' << reversed;
          }
        }
      }
    }
  }
}

TEST(TourCost, CountsTheLengthAndWhatWaits) {
  const TourProblem problem{
      .from_start = {1.0, 4.0}, .distance = {{0.0, 2.0}, {2.0, 0.0}}, .delay_price = {0.5, 10.0}};
  EXPECT_DOUBLE_EQ(TourCost(problem, {0, 1}), 3.0 + 0.5 * 1.0 + 10.0 * 3.0);
  EXPECT_DOUBLE_EQ(TourCost(problem, {1, 0}), 6.0 + 10.0 * 4.0 + 0.5 * 6.0);
}

TEST(ImprovedTour, GoesFirstWhereDelayIsDear) {
  TourProblem problem{
      .from_start = {1.0, 1.5}, .distance = {{0.0, 2.5}, {2.5, 0.0}}, .delay_price = {0.0, 0.0}};
  EXPECT_EQ(ImprovedTour(problem, {1, 0}), (Tour{0, 1}));
  problem.delay_price[1] = 1.0;
  EXPECT_EQ(ImprovedTour(problem, {0, 1}), (Tour{1, 0}));
}

}  // namespace
}  // namespace thalweg::explorer
