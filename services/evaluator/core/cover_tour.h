#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/base/bit_table.h"
#include "common/base/split_mix.h"
#include "services/evaluator/core/place_graph.h"

namespace thalweg::evaluator {

/// An open tour that begins at the first of its stops and goes from stop to stop on shortest paths.
struct CoverTour {
  std::vector<std::size_t> stops;
  double length = 0.0;   ///< [m]
  std::size_t seen = 0;  ///< Items seen from the places that it visits or passes through.
};

/// Searches for a short open tour from a given place that sees enough items. Everything is seen from each
/// place that the tour visits or passes through.
///
/// Ruin and recreate [Schrimpf et al.: Record breaking optimization results using the ruin and recreate
/// principle, J. Comput. Phys. 159, 2000]: a part of the stops is removed; while too little is seen, a place
/// that sees an unseen item is inserted where it costs least, the one with the most items per added length of
/// a random sample; then the order is improved by reversing parts (2-opt) and moving up to three stops
/// (Or-opt), stops that are not needed are dropped, and stops slide to neighboring places from which the tour
/// is shorter. A tour is accepted if it is not longer than the present one by more than a share that falls to
/// 0 (threshold accepting [Dueck, Scheuer 1990]). The best tour found is no proof of the optimum, which is
/// at most as long.
///
/// The same input, seed and number of iterations give the same tour, unless `stop` ends the search.
class CoverTourSearch {
 public:
  struct Options {
    std::uint32_t seed = 1;
    int iterations = 2000;
  };
  /// @param paths, seen  Paths between the places, and for each the items seen there. Must outlive the
  /// object.
  CoverTourSearch(ShortestPaths& paths, const BitTable& seen, std::size_t start);

  /// The number of items seen from all places that can be reached together.
  std::size_t most() const { return most_; }
  /// Searches for a tour that sees at least `wanted` items, which must not be more than most().
  /// @param from  A tour from the start to begin with; may be empty or see too little.
  /// @param stop  Asked once per iteration whether to end the search.
  CoverTour Search(std::size_t wanted, const CoverTour& from, const Options& options,
                   const std::function<bool()>& stop = {});
  int iterations() const { return iterations_; }  ///< Made by all searches together.

  /// The places that a tour visits and passes through, in order.
  std::vector<std::size_t> PlacesOf(const CoverTour& tour);
  /// The tour up to the place at which it has seen `wanted` items; the whole tour if it never has.
  CoverTour BeginningOf(const CoverTour& tour, std::size_t wanted);

 private:
  using Stops = std::vector<std::size_t>;
  double LengthOf(const Stops& stops);
  void AddPlace(std::size_t place, Bits& bits) const;
  void AddLeg(std::size_t from, std::size_t to, Bits& bits);  ///< What is seen on the way, and at `to`.
  std::size_t SeenBy(const Stops& stops, Bits& bits);
  /// befores[n]: seen up to stop n; afters[n]: seen on the legs after stop n.
  void CumulateInto(const Stops& stops, std::vector<Bits>& befores, std::vector<Bits>& afters);

  void Ruin(Stops& stops, SplitMix& random);
  void Recreate(Stops& stops, std::size_t wanted, SplitMix& random);
  /// A random place that sees the item; empty after too many tries.
  std::size_t RandomSeerOf(std::size_t item, SplitMix& random) const;
  void ImproveOrder(Stops& stops);
  void Drop(Stops& stops, std::size_t wanted);
  void Slide(Stops& stops, std::size_t wanted);

  ShortestPaths& paths_;
  const BitTable& seen_;
  std::size_t start_;
  std::size_t most_ = 0;
  int iterations_ = 0;
  std::vector<std::vector<std::uint32_t>> seers_;  ///< By item: a sample of the places that see it.
  std::vector<Bits> befores_, afters_;             ///< Kept to spare allocations.
  Bits scratch_;
};

}  // namespace thalweg::evaluator
