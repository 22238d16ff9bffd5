#include "common/surface_graph/surface_graph.h"

#include "common/base/check.h"

namespace thalweg::surface {

void SurfaceGraph::Reserve(std::size_t vertices, std::size_t edges) {
  positions_.reserve(vertices);
  first_.reserve(vertices);
  links_.reserve(edges);
}

SurfaceGraph::Vertex SurfaceGraph::AddVertex(const Eigen::Vector3f& p_W) {
  THALWEG_CHECK(positions_.size() < kNone);
  positions_.push_back(p_W);
  first_.push_back(kNone);
  return static_cast<Vertex>(positions_.size() - 1);
}

SurfaceGraph::Edge SurfaceGraph::AddEdge(Vertex a, Vertex b) {
  THALWEG_CHECK(a != b && a < positions_.size() && b < positions_.size() && links_.size() < kNone);
  const auto edge = static_cast<Edge>(links_.size());
  links_.push_back({{a, b}, {first_[a], first_[b]}, (positions_[a] - positions_[b]).norm()});
  first_[a] = edge;
  first_[b] = edge;
  ++edge_count_;
  return edge;
}

void SurfaceGraph::Unlink(Vertex vertex, Edge edge) {
  Edge* from = &first_[vertex];
  while (*from != edge) {
    Link& link = links_[*from];
    from = &link.next[link.ends[1] == vertex ? 1 : 0];
  }
  const Link& link = links_[edge];
  *from = link.next[link.ends[1] == vertex ? 1 : 0];
}

void SurfaceGraph::RemoveEdge(Edge edge) {
  THALWEG_CHECK(Exists(edge));
  Link& link = links_[edge];
  Unlink(link.ends[0], edge);
  Unlink(link.ends[1], edge);
  link = {{kNone, kNone}, {kNone, kNone}, 0.0F};
  --edge_count_;
}

void SurfaceGraph::TruncateTo(std::size_t vertices, std::size_t edge_numbers) {
  while (links_.size() > edge_numbers) {
    const auto edge = static_cast<Edge>(links_.size() - 1);
    const Link& link = links_[edge];
    // The last edge added is the first of both its ends.
    THALWEG_CHECK(Exists(edge) && first_[link.ends[0]] == edge && first_[link.ends[1]] == edge);
    first_[link.ends[0]] = link.next[0];
    first_[link.ends[1]] = link.next[1];
    links_.pop_back();
    --edge_count_;
  }
  while (positions_.size() > vertices) {
    THALWEG_CHECK(first_.back() == kNone);
    positions_.pop_back();
    first_.pop_back();
  }
}

bool SurfaceGraph::AreNeighbors(Vertex a, Vertex b) const {
  for (Edge edge = first_[a]; edge != kNone;) {
    const Link& link = links_[edge];
    const int side = link.ends[1] == a ? 1 : 0;
    if (link.ends[1 - side] == b) return true;
    edge = link.next[side];
  }
  return false;
}

}  // namespace thalweg::surface
