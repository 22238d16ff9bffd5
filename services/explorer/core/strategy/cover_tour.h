#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "common/base/bit_table.h"
#include "common/base/split_mix.h"
#include "services/explorer/core/strategy/tour.h"

namespace thalweg::explorer {

/// A covering problem: from a start, visit places from which items are seen, as far as they are worth the
/// path. A length may include what a stop costs besides.
struct CoverProblem {
  std::vector<double> from_start;   ///< [m] Path length from the start to each place.
  std::vector<double> delay_price;  ///< For each item, the cost of seeing it one meter later.
  std::vector<double> worth;        ///< [m] For each item, the path length that is accepted to see it.
  BitTable seen;                    ///< For each place, the items that it may see.
  /// Whether a place sees an item that it may see. Asked once, and only for places that enter a tour.
  std::function<bool(std::size_t place, std::size_t item)> sees;
  /// [m] Path lengths from a place to all places. Asked once, and only for places that enter a tour.
  std::function<std::vector<double>(std::size_t place)> distances;
};

/// Searches for a short open tour over places from which everything is seen, then leaves out what is not
/// worth the path: a prize-collecting covering tour [Gendreau, Laporte, Semet: The covering tour problem,
/// Oper. Res. 45(4), 1997; Balas: The prize collecting traveling salesman problem, Networks 19, 1989].
///
/// Ruin and recreate [Schrimpf et al., J. Comput. Phys. 159, 2000]: stops are removed, in a row or near each
/// other; the place that shows most per added length is inserted until everything is seen; stops that are not
/// needed are dropped; the order is improved as in ImprovedTour. A tour is accepted if it costs less.
/// The result is no proof of the optimum. The same problem and the same calls give the same tours.
class CoverTourSearch {
 public:
  /// Throws std::invalid_argument when the sizes do not agree.
  explicit CoverTourSearch(CoverProblem problem);

  /// A tour of places, completed so that it sees all items that any place sees.
  Tour Completed(Tour tour);
  /// A tour that costs no more than a given one that sees everything, and sees everything, too.
  Tour Improved(Tour tour, int iterations);
  /// Removes stops, one or several in a row, as long as that saves more length than the items were worth that
  /// are then not seen. May leave none.
  Tour WorthItsPath(Tour tour);

  double Length(const Tour& tour);  ///< [m]
  /// Length of the tour + sum over the items seen of (length up to the first stop that sees it *
  /// delay_price).
  double Cost(const Tour& tour);
  /// Whether a place sees an item, as is known by now.
  bool Sees(std::size_t place, std::size_t item) const { return problem_.seen.Get(place, item); }

 private:
  const std::vector<double>& From(std::size_t place);
  double Step(const Tour& tour, std::size_t n);  ///< [m] Length of the way to the nth stop.
  void Confirm(std::size_t place);
  double PriceOfNew(std::size_t place, const Bits& seen) const;
  void Insert(Tour& tour, double power, double noise);
  void DropIdle(Tour& tour);
  void ImproveOrder(Tour& tour);
  void Ruin(Tour& tour);

  CoverProblem problem_;
  std::vector<std::vector<double>> distances_;  ///< For each place, once asked for.
  std::vector<bool> confirmed_;
  SplitMix random_;
};

}  // namespace thalweg::explorer
