#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace thalweg::explorer {

/// z of the product of two vectors in the plane: positive where b points to the left of a.
inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The direction turned to the left by an angle.
Eigen::Vector2d Turned(const Eigen::Vector2d& direction, double angle);

/// Free space of a point robot in the plane: the inside of a closed chain of walls, simply connected.
class Polygon {
 public:
  /// @param vertices  [m] Counterclockwise, so that free space lies to the left of every edge.
  /// Throws std::invalid_argument when there are fewer than three, in clockwise order, or when walls touch.
  explicit Polygon(std::vector<Eigen::Vector2d> vertices);

  const std::vector<Eigen::Vector2d>& vertices() const { return vertices_; }
  const Eigen::Vector2d& operator[](std::size_t vertex) const { return vertices_[vertex]; }
  std::size_t size() const { return vertices_.size(); }
  std::size_t Next(std::size_t vertex) const { return vertex + 1 == size() ? 0 : vertex + 1; }
  std::size_t Previous(std::size_t vertex) const { return vertex == 0 ? size() - 1 : vertex - 1; }

  bool IsReflex(std::size_t vertex) const;  ///< Its inner angle exceeds pi.
  double Area() const;
  double Perimeter() const;
  bool Contains(const Eigen::Vector2d& point) const;

  /// Whether no wall lies between two points that are inside or vertices, but no neighbors. O(n). A vertex
  /// that is exactly on the line of sight does not block it.
  bool Sees(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// Where a ray first meets a wall; walls that begin or end in its origin are not counted. O(n).
  /// @param origin  Inside, or a vertex from which the direction leads inside.
  Eigen::Vector2d FirstHit(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction) const;

  /// Distance from a vertex to the nearest place that is not on its own two walls, these walls' far ends
  /// included: nothing else lies within a circle of that radius.
  double RoomAround(std::size_t vertex) const;

 private:
  std::vector<Eigen::Vector2d> vertices_;
};

}  // namespace thalweg::explorer
