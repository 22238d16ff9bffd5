#include "services/explorer/core/strategy/cover_tour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace thalweg::explorer {
namespace {

constexpr double kLeastAdded = 0.1;        // [m] Keeps the gain per added length finite.
constexpr double kLargestRuin = 0.4;       // Share of the stops.
constexpr double kNoise = 0.5;             // Share of the gain that chance may take away.
constexpr std::size_t kMostToOrder = 150;  // [stops] The order of longer tours stays as they were built.

}  // namespace

CoverTourSearch::CoverTourSearch(CoverProblem problem)
    : problem_(std::move(problem)), distances_(problem_.seen.rows()), confirmed_(problem_.seen.rows()) {
  const std::size_t items = problem_.seen.columns();
  if (problem_.from_start.size() != problem_.seen.rows() || problem_.delay_price.size() != items ||
      problem_.worth.size() != items)
    throw std::invalid_argument("a covering problem needs a length per place, a price and a worth per item");
}

const std::vector<double>& CoverTourSearch::From(std::size_t place) {
  if (distances_[place].empty()) distances_[place] = problem_.distances(place);
  return distances_[place];
}

double CoverTourSearch::Step(const Tour& tour, std::size_t n) {
  return n == 0 ? problem_.from_start[tour[0]] : From(tour[n - 1])[tour[n]];
}

void CoverTourSearch::Confirm(std::size_t place) {
  if (confirmed_[place]) return;
  confirmed_[place] = true;
  ForEachNew(Bits(problem_.seen.words(), 0), problem_.seen.Of(place), [&](std::size_t item) {
    if (!problem_.sees(place, item)) problem_.seen.Clear(place, item);
  });
}

double CoverTourSearch::Length(const Tour& tour) {
  double length = 0.0;
  for (std::size_t n = 0; n < tour.size(); ++n) length += Step(tour, n);
  return length;
}

double CoverTourSearch::PriceOfNew(std::size_t place, const Bits& seen) const {
  double price = 0.0;
  ForEachNew(seen, problem_.seen.Of(place), [&](std::size_t item) { price += problem_.delay_price[item]; });
  return price;
}

double CoverTourSearch::Cost(const Tour& tour) {
  Bits seen(problem_.seen.words(), 0);
  double length = 0.0;
  double delays = 0.0;
  for (std::size_t n = 0; n < tour.size(); ++n) {
    Confirm(tour[n]);
    length += Step(tour, n);
    delays += PriceOfNew(tour[n], seen) * length;
    Unite(seen, problem_.seen.Of(tour[n]));
  }
  return length + delays;
}

void CoverTourSearch::Insert(Tour& tour, double power, double noise) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t start = problem_.seen.rows();  // stands for the start among the places
  struct Insertion {
    std::size_t place;
    double favor;
    std::size_t gain;   // [items]
    double value;       // The gain's.
    double added;       // [m] where it is least,
    std::size_t after;  // which is after this stop.
  };
  const auto length = [&](std::size_t from, std::size_t to) {
    return from == start ? problem_.from_start[to] : From(from)[to];
  };
  const auto set_gain = [&](Insertion& insertion, std::size_t gain) {
    if (gain == insertion.gain) return;
    insertion.gain = gain;
    insertion.value = insertion.favor * std::pow(static_cast<double>(gain), power);
  };
  // Considers an insertion before the nth stop.
  const auto consider = [&](Insertion& insertion, std::size_t n) {
    const std::size_t after = n == 0 ? start : tour[n - 1];
    double added = length(after, insertion.place);
    if (n < tour.size()) added += From(tour[n])[insertion.place] - Step(tour, n);
    if (added >= insertion.added) return;
    insertion.added = added;
    insertion.after = after;
  };
  const auto consider_all = [&](Insertion& insertion) {
    insertion.added = kInfinity;
    for (std::size_t n = 0; n <= tour.size(); ++n) consider(insertion, n);
  };

  Bits seen(problem_.seen.words(), 0);
  for (const std::size_t place : tour) {
    Confirm(place);
    Unite(seen, problem_.seen.Of(place));
  }
  std::vector<Insertion> open;
  for (std::size_t place = 0; place < start; ++place) {
    const std::size_t gain = CountNew(seen, problem_.seen.Of(place));
    if (gain == 0) continue;
    open.push_back({place, noise > 0.0 ? 1.0 - noise * random_.Share() : 1.0, 0, 0.0, kInfinity, start});
    set_gain(open.back(), gain);
    consider_all(open.back());
  }
  while (!open.empty()) {
    const auto score = [](const Insertion& insertion) {
      return insertion.value / (std::max(0.0, insertion.added) + kLeastAdded);
    };
    const auto best = std::max_element(open.begin(), open.end(), [&](const Insertion& a, const Insertion& b) {
      return score(a) < score(b);
    });
    if (!confirmed_[best->place]) {  // it may see less than it seems to
      Confirm(best->place);
      set_gain(*best, CountNew(seen, problem_.seen.Of(best->place)));
      if (best->gain == 0) open.erase(best);
      continue;
    }
    const Insertion inserted = *best;
    const auto after = std::find(tour.begin(), tour.end(), inserted.after);
    const std::ptrdiff_t at = inserted.after == start ? 0 : after - tour.begin() + 1;
    tour.insert(tour.begin() + at, inserted.place);
    Unite(seen, problem_.seen.Of(inserted.place));
    std::erase_if(open, [&](Insertion& insertion) {
      set_gain(insertion, CountNew(seen, problem_.seen.Of(insertion.place)));
      if (insertion.gain == 0) return true;
      if (insertion.after == inserted.after) {  // what it would have split is split already
        consider_all(insertion);
      } else {
        consider(insertion, static_cast<std::size_t>(at));
        consider(insertion, static_cast<std::size_t>(at) + 1);
      }
      return false;
    });
  }
}

void CoverTourSearch::DropIdle(Tour& tour) {
  for (std::size_t n = tour.size(); n-- > 0;) {
    Bits others(problem_.seen.words(), 0);
    for (std::size_t m = 0; m < tour.size(); ++m) {
      if (m != n) Unite(others, problem_.seen.Of(tour[m]));
    }
    if (CountNew(others, problem_.seen.Of(tour[n])) > 0) continue;
    Tour without = tour;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(n));
    if (Cost(without) <= Cost(tour)) tour = std::move(without);
  }
}

void CoverTourSearch::ImproveOrder(Tour& tour) {
  if (tour.size() > kMostToOrder) return;
  TourProblem stops;
  Bits seen(problem_.seen.words(), 0);
  for (const std::size_t place : tour) {
    stops.from_start.push_back(problem_.from_start[place]);
    stops.delay_price.push_back(PriceOfNew(place, seen));  // of what it shows first in the present order
    Unite(seen, problem_.seen.Of(place));
    std::vector<double>& distance = stops.distance.emplace_back();
    for (const std::size_t other : tour) distance.push_back(From(place)[other]);
  }
  Tour order(tour.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Tour ordered;
  for (const std::size_t n : ImprovedTour(stops, order)) ordered.push_back(tour[n]);
  if (Cost(ordered) < Cost(tour)) tour = std::move(ordered);
}

void CoverTourSearch::Ruin(Tour& tour) {
  const auto below = [&](std::size_t count) {
    return static_cast<std::size_t>(random_.Share() * static_cast<double>(count));
  };
  const auto most = static_cast<std::size_t>(kLargestRuin * static_cast<double>(tour.size()));
  const std::size_t count = std::min(tour.size(), 1 + below(std::max<std::size_t>(2, most)));
  if (random_.Share() < 0.5) {
    const auto first = tour.begin() + static_cast<std::ptrdiff_t>(below(tour.size() - count + 1));
    tour.erase(first, first + static_cast<std::ptrdiff_t>(count));
    return;
  }
  const std::vector<double>& distances = From(tour[below(tour.size())]);
  std::vector<double> sorted;
  for (const std::size_t place : tour) sorted.push_back(distances[place]);
  std::ranges::sort(sorted);
  std::erase_if(tour, [&](std::size_t place) { return distances[place] <= sorted[count - 1]; });
}

Tour CoverTourSearch::Completed(Tour tour) {
  Insert(tour, 1.0, 0.0);
  DropIdle(tour);
  return tour;
}

Tour CoverTourSearch::Improved(Tour tour, int iterations) {
  if (tour.empty()) return tour;
  ImproveOrder(tour);
  double cost = Cost(tour);
  for (int n = 0; n < iterations; ++n) {
    Tour other = tour;
    Ruin(other);
    Insert(other, 0.5 + random_.Share(), kNoise);
    DropIdle(other);
    ImproveOrder(other);
    const double its_cost = Cost(other);
    if (its_cost >= cost - kLeastTourGain) continue;
    cost = its_cost;
    tour = std::move(other);
  }
  return tour;
}

Tour CoverTourSearch::WorthItsPath(Tour tour) {
  const Bits nothing(problem_.seen.words(), 0);
  while (true) {
    std::vector<std::size_t> seers(problem_.seen.columns(), 0);
    for (const std::size_t place : tour) {
      ForEachNew(nothing, problem_.seen.Of(place), [&](std::size_t item) { ++seers[item]; });
    }
    double most_saved = kLeastTourGain;
    std::size_t best_first = 0;
    std::size_t best_end = 0;
    for (std::size_t first = 0; first < tour.size(); ++first) {
      std::vector<std::size_t> left = seers;
      double lost = 0.0;    // [m] worth of what would not be seen
      double length = 0.0;  // [m] of the ways to the stops removed
      for (std::size_t n = first; n < tour.size(); ++n) {
        length += Step(tour, n);
        ForEachNew(nothing, problem_.seen.Of(tour[n]), [&](std::size_t item) {
          if (--left[item] == 0) lost += problem_.worth[item];
        });
        double saved = length;
        if (n + 1 < tour.size()) {
          const double past =
              first == 0 ? problem_.from_start[tour[n + 1]] : From(tour[first - 1])[tour[n + 1]];
          saved += Step(tour, n + 1) - past;
        }
        if (saved - lost <= most_saved) continue;
        most_saved = saved - lost;
        best_first = first;
        best_end = n + 1;
      }
    }
    if (best_end == 0) return tour;
    tour.erase(tour.begin() + static_cast<std::ptrdiff_t>(best_first),
               tour.begin() + static_cast<std::ptrdiff_t>(best_end));
  }
}

}  // namespace thalweg::explorer
