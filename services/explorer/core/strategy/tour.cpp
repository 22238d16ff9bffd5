#include "services/explorer/core/strategy/tour.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

namespace thalweg::explorer {
namespace {

constexpr std::size_t kLongestMove = 3;  // [stops]

/// A part of a tour: the stops from the one numbered `begin` up to, but not including, `end`.
struct Piece {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool reversed = false;
};

/// Replaces a part of a tour by two pieces of the tour, which together are the same stops; the second may be
/// empty.
struct Move {
  std::size_t begin;
  std::size_t end;
  std::array<Piece, 2> pieces;
};

/// A tour that is changed by moves. What a move costs is computed in constant time: the cost of a tour is the
/// sum over its legs of length * (1 + prices of all stops ahead), so that sums over the first legs give the
/// cost of any piece, in either direction.
class MovedTour {
 public:
  MovedTour(const TourProblem& problem, Tour tour) : problem_(problem), tour_(std::move(tour)) { Sum(); }

  const Tour& tour() const { return tour_; }

  /// Makes a move if that reduces the cost. @return Whether it did.
  bool Take(const Move& move) {
    // Sums are as exact as the whole tour's cost.
    const double least = kLeastTourGain * std::max(1.0, Ahead(0) * lengths_.back());
    if (CostAfter(move) >= CostBefore(move) - least) return false;
    Tour stops;
    for (const Piece& piece : move.pieces) {
      const auto first = stops.insert(stops.end(), At(piece.begin), At(piece.end));
      if (piece.reversed) std::reverse(first, stops.end());
    }
    std::ranges::copy(stops, At(move.begin));
    Sum();
    return true;
  }

 private:
  Tour::iterator At(std::size_t n) { return tour_.begin() + static_cast<std::ptrdiff_t>(n); }

  double Ahead(std::size_t n) const { return 1.0 + prices_.back() - prices_[n]; }
  const std::vector<double>& From(std::size_t n) const {  // the stop before the nth
    return n == 0 ? problem_.from_start : problem_.distance[tour_[n - 1]];
  }

  void Sum() {
    prices_.assign(1, 0.0);
    lengths_.assign(1, 0.0);
    priced_.assign(1, 0.0);
    for (std::size_t n = 0; n < tour_.size(); ++n) {
      const double leg = From(n)[tour_[n]];
      lengths_.push_back(lengths_.back() + leg);
      priced_.push_back(priced_.back() + leg * prices_.back());
      prices_.push_back(prices_.back() + problem_.delay_price[tour_[n]]);
    }
  }

  /// The cost of the legs to the stops of the part, and of the one that leads on from it.
  double CostBefore(const Move& move) const {
    const std::size_t end = std::min(move.end + 1, tour_.size());
    return Ahead(0) * (lengths_[end] - lengths_[move.begin]) - (priced_[end] - priced_[move.begin]);
  }

  /// The same once the move is made.
  double CostAfter(const Move& move) const {
    double ahead = Ahead(move.begin);
    double cost = 0.0;
    const std::vector<double>* from = &From(move.begin);
    for (const auto& [begin, end, reversed] : move.pieces) {
      if (begin == end) continue;
      cost += (*from)[tour_[reversed ? end - 1 : begin]] * ahead;
      const double length = lengths_[end] - lengths_[begin + 1];  // within the piece
      const double priced = priced_[end] - priced_[begin + 1];
      cost +=
          reversed ? (ahead - prices_[end]) * length + priced : (ahead + prices_[begin]) * length - priced;
      ahead -= prices_[end] - prices_[begin];
      from = &problem_.distance[tour_[reversed ? begin : end - 1]];
    }
    return move.end < tour_.size() ? cost + (*from)[tour_[move.end]] * ahead : cost;
  }

  const TourProblem& problem_;
  Tour tour_;
  // Sums over the first n stops, and over the legs to them:
  std::vector<double> prices_;
  std::vector<double> lengths_;  ///< [m]
  std::vector<double> priced_;   ///< [m] The length of each leg * the prices of the stops before it.
};

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
  MovedTour moved(problem, std::move(tour));
  for (bool improved = true; improved;) {
    improved = false;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 2; j <= count; ++j) improved |= moved.Take({i, j, {{{i, j, true}}}});
    }
    for (std::size_t length = 1; length <= std::min(kLongestMove, count); ++length) {
      for (std::size_t i = 0; i + length <= count; ++i) {
        for (std::size_t to = 0; to + length <= count; ++to) {
          if (to == i) continue;
          const auto move = [&](bool reversed) {
            const Piece stops{i, i + length, reversed};
            return i < to ? Move{i, to + length, {{{i + length, to + length}, stops}}}
                          : Move{to, i + length, {{stops, {to, i}}}};
          };
          if (moved.Take(move(false))) {
            improved = true;
            moved.Take({to, to + length, {{{to, to + length, true}}}});
          } else {
            improved |= moved.Take(move(true));
          }
        }
      }
    }
  }
  return moved.tour();
}

}  // namespace thalweg::explorer
