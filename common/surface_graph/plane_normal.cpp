#include "common/surface_graph/plane_normal.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace thalweg::surface {
namespace {

using Vertex = SurfaceGraph::Vertex;
using Edge = SurfaceGraph::Edge;

/// The normal at a vertex, with either sign.
std::optional<Eigen::Vector3d> NormalAt(const SurfaceGraph& graph, Vertex vertex) {
  const auto position = [&](Vertex v) -> Eigen::Vector3d { return graph.Position(v).cast<double>(); };
  Eigen::Vector3d mean = position(vertex);
  int count = 1;
  graph.ForEachEdge(vertex, [&](Edge, Vertex neighbor) {
    mean += position(neighbor);
    ++count;
  });
  if (count < 3) return std::nullopt;
  mean /= count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  const auto add = [&](Vertex v) {
    const Eigen::Vector3d d = position(v) - mean;
    scatter += d * d.transpose();
  };
  add(vertex);
  graph.ForEachEdge(vertex, [&](Edge, Vertex neighbor) { add(neighbor); });
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);  // ascending
  // Points on a line are parallel to many planes. Positions have 24 bits, squares of their errors 48.
  constexpr double kRounding = 1e-10;
  if (!(solver.eigenvalues()[1] > kRounding * solver.eigenvalues()[2])) return std::nullopt;
  return solver.eigenvectors().col(0);
}

}  // namespace

std::optional<Eigen::Vector3d> PlaneNormal(const SurfaceGraph& graph, Vertex vertex,
                                           const Eigen::Vector3d& camera_W) {
  const std::optional<Eigen::Vector3d> normal = NormalAt(graph, vertex);
  if (!normal) return std::nullopt;
  const double side = normal->dot(camera_W - graph.Position(vertex).cast<double>());
  return side < 0.0 ? Eigen::Vector3d(-*normal) : *normal;
}

std::optional<Eigen::Vector3d> RiftNormal(const SurfaceGraph& graph, const Rift& rift,
                                          const Eigen::Vector3d& camera_W) {
  const std::optional<Eigen::Vector3d> normal = NormalAt(graph, rift.vertex);
  if (!normal) return std::nullopt;
  Eigen::Vector3d beside = Eigen::Vector3d::Zero();
  for (const Edge edge : rift.edges) {
    Eigen::Vector3d nearer = graph.Position(graph.End(edge, 0)).cast<double>() - camera_W;
    Eigen::Vector3d farther = graph.Position(graph.End(edge, 1)).cast<double>() - camera_W;
    if (nearer.squaredNorm() > farther.squaredNorm()) std::swap(nearer, farther);
    beside += (farther.normalized() - nearer.normalized()).normalized();
  }
  const double open_side = normal->dot(beside) / static_cast<double>(rift.edges.size());
  const double camera_side = normal->dot((camera_W - rift.center_W.cast<double>()).normalized());
  const double side = std::abs(open_side) > std::abs(camera_side) ? open_side : camera_side;
  return side < 0.0 ? Eigen::Vector3d(-*normal) : *normal;
}

}  // namespace thalweg::surface
