#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thalweg::evaluator {

/// Places and the lengths of the paths between neighboring ones, the same in both directions.
struct PlaceGraph {
  struct Link {
    std::uint32_t to = 0;
    float length = 0.0F;  ///< [m]
  };
  std::vector<std::vector<Link>> links;  ///< By place.

  std::size_t size() const { return links.size(); }
  void Connect(std::size_t a, std::size_t b, double length);
  bool Connected(std::size_t a, std::size_t b) const;
};

/// Shortest paths of a graph [Dijkstra 1959], by one flood from each place that is asked for. Keeps what it
/// has computed: 8 bytes for each pair of a source and a place.
/// Threading: one thread.
class ShortestPaths {
 public:
  /// @param graph  Must outlive the object.
  explicit ShortestPaths(const PlaceGraph& graph) : graph_(graph), rows_(graph.size()) {}

  const PlaceGraph& graph() const { return graph_; }
  /// [m] Infinite if there is no path.
  double Length(std::size_t from, std::size_t to) { return RowOf(from).length[to]; }
  /// Calls visit(place) for each place that the path passes through, between its ends, from `to` backwards.
  template <class Visit>
  void ForEachBetween(std::size_t from, std::size_t to, Visit&& visit) {
    const Row& row = RowOf(from);
    for (std::uint32_t at = row.before[to]; at != from && at != kNone; at = row.before[at]) visit(at);
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  struct Row {
    std::vector<float> length;
    std::vector<std::uint32_t> before;  ///< The place before each one on the path to it.
  };
  const Row& RowOf(std::size_t from) {
    if (rows_[from].length.empty()) Flood(from);
    return rows_[from];
  }
  void Flood(std::size_t from);

  const PlaceGraph& graph_;
  std::vector<Row> rows_;
};

}  // namespace thalweg::evaluator
