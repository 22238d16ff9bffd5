#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace thalweg::surface {

/// The undirected graph of what was seen: a vertex per surface point, an edge between points that are
/// neighbors in an image, weighted by their distance.
///
/// Source: the surface graph of Chapter 5 of the source thesis. The edges of a vertex are a linked list that
/// runs through the edges themselves, so that adding an edge takes constant time and no memory of its own; a
/// vertex typically has four. Removed edges leave gaps in the numbering.
/// Threading: one thread owns a graph.
class SurfaceGraph {
 public:
  using Vertex = std::uint32_t;
  using Edge = std::uint32_t;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  void Reserve(std::size_t vertices, std::size_t edges);
  /// Numbers run from 0. @param p_W  Finite.
  Vertex AddVertex(const Eigen::Vector3f& p_W);
  /// Adds an edge between two different vertices, whether or not there is one.
  Edge AddEdge(Vertex a, Vertex b);
  /// Costs as much as its ends have edges.
  void RemoveEdge(Edge edge);
  /// Takes back what was added last. Edges that remain must have ends that remain, and none of those taken
  /// back may have been removed.
  void TruncateTo(std::size_t vertices, std::size_t edge_numbers);

  std::size_t vertex_count() const { return positions_.size(); }
  std::size_t edge_count() const { return edge_count_; }
  /// Edges are numbered below it; those that were removed keep their numbers.
  std::size_t edge_numbers() const { return links_.size(); }
  bool Exists(Edge edge) const { return links_[edge].ends[0] != kNone; }

  const Eigen::Vector3f& Position(Vertex vertex) const { return positions_[vertex]; }
  /// [m] Distance between the edge's ends.
  float Weight(Edge edge) const { return links_[edge].weight; }
  /// @param side  0 or 1
  Vertex End(Edge edge, int side) const { return links_[edge].ends[side]; }
  bool AreNeighbors(Vertex a, Vertex b) const;

  /// Calls visit(edge, neighbor) for each edge of a vertex.
  template <class Visit>
  void ForEachEdge(Vertex vertex, Visit&& visit) const {
    for (Edge edge = first_[vertex]; edge != kNone;) {
      const Link& link = links_[edge];
      const int side = link.ends[1] == vertex ? 1 : 0;
      visit(edge, link.ends[1 - side]);
      edge = link.next[side];
    }
  }

 private:
  struct Link {
    Vertex ends[2];
    Edge next[2];  ///< The next edge of each end.
    float weight;
  };
  void Unlink(Vertex vertex, Edge edge);

  std::vector<Eigen::Vector3f> positions_;
  std::vector<Edge> first_;  ///< The first edge of each vertex.
  std::vector<Link> links_;
  std::size_t edge_count_ = 0;
};

}  // namespace thalweg::surface
