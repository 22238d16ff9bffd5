#include "services/evaluator/core/cover_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace thalweg::evaluator {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Points in a square, each linked to some others, that see random items.
struct Puzzle {
  Puzzle(std::uint32_t seed, std::size_t places, std::size_t items, double links, double sees)
      : seen(places, items) {
    std::mt19937 random(seed);
    const auto share = [&] { return static_cast<double>(random()) / std::mt19937::max(); };
    std::vector<std::pair<double, double>> points;
    for (std::size_t n = 0; n < places; ++n) points.emplace_back(10.0 * share(), 10.0 * share());
    graph.links.resize(places);
    for (std::size_t a = 0; a < places; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (b + 1 != a && share() > links) continue;  // a chain links all of them
        graph.Connect(a, b,
                      std::hypot(points[a].first - points[b].first, points[a].second - points[b].second));
      }
      for (std::size_t item = 0; item < items; ++item) {
        if (share() < sees) seen.Set(a, item);
      }
    }
  }

  PlaceGraph graph;
  BitTable seen;
};

using Lengths = std::vector<std::vector<double>>;

/// All shortest paths [Floyd 1962, Warshall 1962].
Lengths AllLengths(const PlaceGraph& graph) {
  Lengths lengths(graph.size(), std::vector<double>(graph.size(), kNever));
  for (std::size_t a = 0; a < graph.size(); ++a) {
    lengths[a][a] = 0.0;
    for (const auto& link : graph.links[a]) {
      lengths[a][link.to] = std::min(lengths[a][link.to], static_cast<double>(link.length));
    }
  }
  for (std::size_t k = 0; k < graph.size(); ++k) {
    for (std::size_t a = 0; a < graph.size(); ++a) {
      for (std::size_t b = 0; b < graph.size(); ++b) {
        lengths[a][b] = std::min(lengths[a][b], lengths[a][k] + lengths[k][b]);
      }
    }
  }
  return lengths;
}

std::size_t CountSeen(const BitTable& seen, const std::vector<std::size_t>& places) {
  std::size_t count = 0;
  for (std::size_t item = 0; item < seen.columns(); ++item) {
    count += std::any_of(places.begin(), places.end(), [&](std::size_t p) { return seen.Get(p, item); });
  }
  return count;
}

/// The least length for each number of seen items, over all orders of all subsets of the places that begin
/// with the start. A shortest walk is among them: its places in the order of its first visits.
std::vector<double> LeastLengths(const Puzzle& puzzle, std::size_t start) {
  const Lengths lengths = AllLengths(puzzle.graph);
  std::vector<double> best(puzzle.seen.columns() + 1, kNever);
  std::vector<std::size_t> order = {start};
  const auto visit = [&](const auto& self, double length) -> void {
    for (std::size_t n = 0; n <= CountSeen(puzzle.seen, order); ++n) best[n] = std::min(best[n], length);
    for (std::size_t next = 0; next < puzzle.graph.size(); ++next) {
      if (std::find(order.begin(), order.end(), next) != order.end()) continue;
      const double on = lengths[order.back()][next];
      if (on == kNever) continue;
      order.push_back(next);
      self(self, length + on);
      order.pop_back();
    }
  };
  visit(visit, 0.0);
  return best;
}

TEST(ShortestPaths, AreThoseOfFloydAndWarshall) {
  const Puzzle puzzle(3, 40, 1, 0.08, 0.5);
  const Lengths expected = AllLengths(puzzle.graph);
  ShortestPaths paths(puzzle.graph);
  for (std::size_t a = 0; a < puzzle.graph.size(); ++a) {
    for (std::size_t b = 0; b < puzzle.graph.size(); ++b) {
      EXPECT_NEAR(paths.Length(a, b), expected[a][b], 1e-4);
      std::size_t at = b;
      double length = 0.0;
      paths.ForEachBetween(a, b, [&](std::size_t place) {
        length += expected[at][place];
        at = place;
      });
      EXPECT_NEAR(length + expected[a][at], expected[a][b], 1e-4) << "its places lie on it";
    }
  }
}

TEST(CoverTour, IsAsShortAsTheBestOfAllOrdersOfAllSubsets) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const Puzzle puzzle(seed, 7, 20, 0.4, 0.25);
    const std::vector<double> expected = LeastLengths(puzzle, 2);
    ShortestPaths paths(puzzle.graph);
    CoverTourSearch search(paths, puzzle.seen, 2);
    EXPECT_LT(expected[search.most()], kNever);
    EXPECT_TRUE(search.most() == puzzle.seen.columns() || expected[search.most() + 1] == kNever);
    for (const std::size_t missed : {0, 1, 2, 5}) {
      const std::size_t wanted = search.most() - missed;
      const CoverTour tour = search.Search(wanted, {}, {.seed = seed, .iterations = 150});
      EXPECT_NEAR(tour.length, expected[wanted], 2e-3) << "seed " << seed << ", " << wanted;
      EXPECT_GE(tour.seen, wanted);
    }
  }
}

TEST(CoverTour, SeesWhatItClaimsAndIsAsLongAsItClaims) {
  const Puzzle puzzle(5, 120, 400, 0.05, 0.03);
  const Lengths lengths = AllLengths(puzzle.graph);
  ShortestPaths paths(puzzle.graph);
  CoverTourSearch search(paths, puzzle.seen, 7);
  for (const double share : {0.5, 0.9, 1.0}) {
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(search.most()));
    const CoverTour tour = search.Search(wanted, {}, {.iterations = 60});
    EXPECT_EQ(tour.stops.front(), 7U);
    const std::vector<std::size_t> places = search.PlacesOf(tour);
    EXPECT_EQ(CountSeen(puzzle.seen, places), tour.seen);
    EXPECT_GE(tour.seen, wanted);
    double length = 0.0;
    for (std::size_t n = 1; n < places.size(); ++n) length += lengths[places[n - 1]][places[n]];
    EXPECT_NEAR(length, tour.length, 1e-3);
  }
}

TEST(CoverTour, BecomesShorterWithIterationsAndIsTheSameForTheSameSeed) {
  const Puzzle puzzle(6, 150, 500, 0.04, 0.02);
  const auto tour_after = [&](int iterations) {
    ShortestPaths paths(puzzle.graph);
    return CoverTourSearch(paths, puzzle.seen, 0).Search(400, {}, {.iterations = iterations});
  };
  const CoverTour quick = tour_after(0);
  const CoverTour better = tour_after(100);
  EXPECT_LT(better.length, 0.95 * quick.length);
  EXPECT_EQ(better.stops, tour_after(100).stops);
}

TEST(CoverTour, ItsBeginningSeesEnoughAndNoEarlierOneDoes) {
  const Puzzle puzzle(8, 80, 300, 0.05, 0.04);
  ShortestPaths paths(puzzle.graph);
  CoverTourSearch search(paths, puzzle.seen, 0);
  const CoverTour tour = search.Search(search.most(), {}, {.iterations = 20});
  const std::vector<std::size_t> places = search.PlacesOf(tour);
  for (const std::size_t wanted : {std::size_t{1}, search.most() / 2, search.most() - 3, search.most()}) {
    const CoverTour beginning = search.BeginningOf(tour, wanted);
    std::vector<std::size_t> of = search.PlacesOf(beginning);
    ASSERT_LE(of.size(), places.size());
    EXPECT_TRUE(std::equal(of.begin(), of.end(), places.begin()));
    EXPECT_GE(CountSeen(puzzle.seen, of), wanted);
    EXPECT_LE(beginning.length, tour.length + 1e-3);
    if (of.size() == 1) continue;
    of.pop_back();
    EXPECT_LT(CountSeen(puzzle.seen, of), wanted);
  }
}

TEST(CoverTour, LeavesOutWhatCannotBeReached) {
  Puzzle puzzle(9, 10, 30, 0.3, 0.3);
  puzzle.graph.links.emplace_back();  // an island that sees an item of its own
  BitTable seen(11, 31);
  for (std::size_t place = 0; place < 10; ++place) {
    for (std::size_t item = 0; item < 30; ++item) {
      if (puzzle.seen.Get(place, item)) seen.Set(place, item);
    }
  }
  seen.Set(10, 30);
  ShortestPaths paths(puzzle.graph);
  EXPECT_LE(CoverTourSearch(paths, seen, 0).most(), 30U);
}

TEST(CoverTour, EndsWhenToldTo) {
  const Puzzle puzzle(6, 150, 500, 0.04, 0.02);
  ShortestPaths paths(puzzle.graph);
  CoverTourSearch search(paths, puzzle.seen, 0);
  int asked = 0;
  const CoverTour tour = search.Search(400, {}, {.iterations = 1'000'000}, [&] { return ++asked > 5; });
  EXPECT_EQ(search.iterations(), 5);
  EXPECT_GE(tour.seen, 400U);
}

}  // namespace
}  // namespace thalweg::evaluator
