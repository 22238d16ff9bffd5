#include "services/explorer/core/strategy/cover_tour.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer {
namespace {

/// Places at random positions in a square with the start in its middle, and items, each seen from a few
/// places.
struct Puzzle {
  Puzzle(std::mt19937& random, std::size_t count, std::size_t items, double eagerness) : sees(count) {
    for (std::size_t n = 0; n < count; ++n) {
      places.emplace_back(test::RandomDouble(random, -5.0, 5.0), test::RandomDouble(random, -5.0, 5.0));
      for (std::size_t item = 0; item < items; ++item)
        sees[n].push_back(test::RandomDouble(random, 0.0, 1.0) < 0.3);
    }
    for (std::size_t item = 0; item < items; ++item) {
      delay_price.push_back(eagerness * test::RandomDouble(random, 0.0, 0.3));
      worth.push_back(test::RandomDouble(random, 0.0, 3.0));
    }
  }

  /// @param hopes  The problem says that each place may see everything.
  CoverProblem Problem(bool hopes = false) const {
    CoverProblem problem{.from_start = {},
                         .delay_price = delay_price,
                         .worth = worth,
                         .seen = BitTable(places.size(), worth.size()),
                         .sees = [this](std::size_t place, std::size_t item) { return sees[place][item]; },
                         .distances =
                             [this](std::size_t place) {
                               std::vector<double> distances;
                               for (const Eigen::Vector2d& other : places)
                                 distances.push_back((places[place] - other).norm());
                               return distances;
                             }};
    for (std::size_t n = 0; n < places.size(); ++n) {
      problem.from_start.push_back(places[n].norm());
      for (std::size_t item = 0; item < worth.size(); ++item) {
        if (hopes || sees[n][item]) problem.seen.Set(n, item);
      }
    }
    return problem;
  }
  double Length(const Tour& tour) const {
    double length = 0.0;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    for (const std::size_t place : tour) {
      length += (places[place] - at).norm();
      at = places[place];
    }
    return length;
  }
  bool Seen(const Tour& tour, std::size_t item) const {
    return std::ranges::any_of(tour, [&](std::size_t place) { return sees[place][item]; });
  }
  double Cost(const Tour& tour) const {
    double cost = Length(tour);
    for (std::size_t item = 0; item < worth.size(); ++item) {
      for (std::size_t n = 0; n < tour.size(); ++n) {
        if (!sees[tour[n]][item]) continue;
        cost += delay_price[item] * Length({tour.begin(), tour.begin() + static_cast<std::ptrdiff_t>(n) + 1});
        break;
      }
    }
    return cost;
  }
  bool SeesAll(const Tour& tour) const {
    Tour everywhere(places.size());
    std::iota(everywhere.begin(), everywhere.end(), std::size_t{0});
    for (std::size_t item = 0; item < worth.size(); ++item) {
      if (Seen(everywhere, item) && !Seen(tour, item)) return false;
    }
    return true;
  }
  /// Length of a tour less the worth of what it sees.
  double Balance(const Tour& tour) const {
    double balance = Length(tour);
    for (std::size_t item = 0; item < worth.size(); ++item) balance -= Seen(tour, item) ? worth[item] : 0.0;
    return balance;
  }

  std::vector<Eigen::Vector2d> places;
  std::vector<std::vector<bool>> sees;
  std::vector<double> delay_price;
  std::vector<double> worth;
};

/// Visits every order of every subset of the places.
template <class Visit>
void ForEachTour(std::size_t places, const Visit& visit) {
  Tour tour;
  const auto extend = [&](const auto& self) -> void {
    visit(tour);
    for (std::size_t place = 0; place < places; ++place) {
      if (std::ranges::find(tour, place) != tour.end()) continue;
      tour.push_back(place);
      self(self);
      tour.pop_back();
    }
  };
  extend(extend);
}

class CoverTours : public testing::TestWithParam<unsigned> {
 protected:
  std::mt19937 random_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Seeds, CoverTours, testing::Range(1U, 21U));

TEST_P(CoverTours, OfFewPlacesAreNearTheBestOrderOfTheBestSubset) {
  for (const double eagerness : {0.0, 1.0}) {
    const Puzzle puzzle(random_, 6, 8, eagerness);
    double least = std::numeric_limits<double>::infinity();
    ForEachTour(6, [&](const Tour& tour) {
      if (puzzle.SeesAll(tour)) least = std::min(least, puzzle.Cost(tour));
    });
    CoverTourSearch search(puzzle.Problem());
    const Tour tour = search.Improved(search.Completed({}), 60);
    EXPECT_TRUE(puzzle.SeesAll(tour));
    EXPECT_NEAR(search.Length(tour), puzzle.Length(tour), 1e-9);
    EXPECT_NEAR(search.Cost(tour), puzzle.Cost(tour), 1e-9);
    EXPECT_GE(puzzle.Cost(tour), least - 1e-9);
    EXPECT_LE(puzzle.Cost(tour), 1.1 * least);
  }
}

TEST_P(CoverTours, AreNoLongerAfterMoreIterationsAndTheSameEachTime) {
  const Puzzle puzzle(random_, 40, 60, 0.5);
  CoverTourSearch search(puzzle.Problem());
  const Tour first = search.Completed({});
  EXPECT_TRUE(puzzle.SeesAll(first));
  const Tour better = search.Improved(first, 20);
  EXPECT_TRUE(puzzle.SeesAll(better));
  EXPECT_LE(puzzle.Cost(better), puzzle.Cost(first) + 1e-9);
  CoverTourSearch again(puzzle.Problem());
  EXPECT_EQ(again.Completed({}), first);
  EXPECT_EQ(again.Improved(first, 20), better);
}

TEST_P(CoverTours, RelyOnlyOnWhatAPlaceTrulySees) {
  const Puzzle puzzle(random_, 12, 20, 0.0);
  CoverTourSearch hopeful(puzzle.Problem(true));
  const Tour tour = hopeful.Improved(hopeful.Completed({}), 10);
  EXPECT_TRUE(puzzle.SeesAll(tour));
  for (const std::size_t place : tour) {
    for (std::size_t item = 0; item < 20; ++item)
      EXPECT_EQ(hopeful.Sees(place, item), puzzle.sees[place][item]);
  }
}

TEST_P(CoverTours, KeepWhatIsWorthItsPath) {
  const Puzzle puzzle(random_, 7, 12, 0.0);
  CoverTourSearch search(puzzle.Problem());
  const Tour all = search.Improved(search.Completed({}), 20);
  const Tour kept = search.WorthItsPath(all);
  EXPECT_LE(puzzle.Balance(kept), puzzle.Balance(all) + 1e-9);
  EXPECT_LE(puzzle.Balance(kept), 1e-9) << "no tour at all balances out";
  for (std::size_t first = 0; first < kept.size(); ++first) {
    for (std::size_t end = first + 1; end <= kept.size(); ++end) {
      Tour fewer = kept;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(first),
                  fewer.begin() + static_cast<std::ptrdiff_t>(end));
      EXPECT_GE(puzzle.Balance(fewer), puzzle.Balance(kept) - 1e-9);
    }
  }
}

TEST(CoverTour, IncludesADistantGroupThatIsWorthItsPathTogether) {
  std::mt19937 random(1);
  Puzzle puzzle(random, 2, 2, 0.0);
  puzzle.places = {{10.0, 0.0}, {10.5, 0.0}};
  puzzle.sees = {{true, false}, {false, true}};
  puzzle.worth = {6.0, 6.0};
  CoverTourSearch search(puzzle.Problem());
  EXPECT_EQ(search.WorthItsPath(search.Completed({})).size(), 2U);
  puzzle.worth = {6.0, 0.4};
  CoverTourSearch poorer(puzzle.Problem());
  EXPECT_TRUE(poorer.WorthItsPath(poorer.Completed({})).empty());
}

TEST(CoverTour, IsEmptyWhereThereIsNothingToSee) {
  std::mt19937 random(1);
  for (const std::size_t items : {0U, 5U}) {
    Puzzle puzzle(random, 4, items, 0.0);
    for (std::vector<bool>& sees : puzzle.sees) sees.assign(items, false);
    CoverTourSearch search(puzzle.Problem(true));
    EXPECT_TRUE(search.Completed({}).empty());
    EXPECT_TRUE(search.Improved({}, 10).empty());
    EXPECT_TRUE(search.WorthItsPath({}).empty());
  }
}

TEST(CoverTour, OfAnIncompleteProblemIsRefused) {
  std::mt19937 random(1);
  const Puzzle puzzle(random, 3, 4, 0.0);
  CoverProblem problem = puzzle.Problem();
  problem.worth.pop_back();
  EXPECT_THROW(CoverTourSearch{problem}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::explorer
