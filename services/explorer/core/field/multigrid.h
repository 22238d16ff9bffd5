#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "services/explorer/core/field/fine_problem.h"
#include "services/explorer/core/field/kernels.h"
#include "services/explorer/core/field/layout.h"
#include "services/explorer/core/field/team.h"

namespace thalweg::explorer::field {

inline constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// A link that the regular grid cannot represent, because one of its ends is a further node of a block.
struct Link {
  std::size_t a, b;
  float weight;
  std::size_t parent_a = kNone, parent_b = kNone;
};

/// A node whose aggregate is not the one that its position implies.
struct Moved {
  std::size_t node;
  std::size_t implied;  ///< Its block in the next level; kNone for further nodes, which no sweep touches.
  std::size_t parent;   ///< Its aggregate; kNone when it has no links and needs no correction.
};

/// One grid of the hierarchy. When the cells of a block form several connected parts, the largest part has
/// its node in the grid, and each other part has a `further` node, stored at an offset beyond the layout.
struct Level {
  Layout layout;
  Segments segments;
  std::size_t unknowns = 0;
  std::size_t further = 0;
  std::vector<std::size_t> further_place;  ///< The block in `layout` of each further node.
  std::vector<Link> links;
  std::vector<Moved> moved;
  std::vector<int> part_begin;  ///< First plane of each thread, even; one more entry at the end.

  Buffer<float> diagonal, weight_x, weight_y, weight_z;  // not on the finest level
  Buffer<float> slack, mass;
  Buffer<float> r, z, work;

  bool irregular() const { return further > 0 || !moved.empty(); }
  bool Active(std::size_t i) const { return diagonal[i] > 0.0F; }
  float Diagonal(std::size_t i) const { return diagonal[i]; }
  float Weight(int axis, std::size_t i, std::size_t /*stride*/) const {
    return axis == 0 ? weight_x[i] : axis == 1 ? weight_y[i] : weight_z[i];
  }
  float Slack(std::size_t i) const { return slack[i]; }
  float Mass(std::size_t i) const { return mass[i]; }
  CoarseOperator Operator() const {
    return {diagonal.data(),
            weight_x.data(),
            weight_y.data(),
            weight_z.data(),
            static_cast<std::ptrdiff_t>(layout.stride_y),
            static_cast<std::ptrdiff_t>(layout.stride_z)};
  }
};

/// A symmetric multigrid cycle on the voxel grid: the preconditioner of the field's conjugate gradients.
///
/// Coarse cells are the connected parts of 2x2x2 blocks, and interpolation is constant on each. The coarse
/// operator is the Galerkin operator, halved because it takes a gradient over twice the distance for one over
/// a single cell [Braess: Towards algebraic multigrid for elliptic problems of second order, Computing 55,
/// 1995]. Each level uses one sweep of damped Jacobi before and after the coarse correction, and visits the
/// next coarser level twice (a W-cycle, in which that halving keeps the preconditioner positive definite;
/// docs/decisions/0017).
///
/// On large levels memory bandwidth is the limit. On the finest, the sweeps before the coarse correction are
/// fused with the conjugate gradient step, and those after it with each other; intermediate results live in
/// three planes. On the others a sweep follows the one before it plane by plane.
/// Threading: Build is called by one thread, everything else by all members of the team at the same time.
class Multigrid {
 public:
  Multigrid();
  ~Multigrid();

  /// Builds the hierarchy for `problem`, which must outlive this object.
  void Build(const FineProblem& problem, Team& team);

  /// r -= alpha q; then the first half of a cycle for r, up to the coarse problem.
  /// @param dots  r . r of each plane.
  void Advance(const Team::Member& member, float alpha, const float* q, float* r, double* dots);

  /// out = B r, where r is that of the preceding Advance, from which all members must have returned.
  /// @param dots  r . out of each plane.
  void Precondition(const Team::Member& member, const float* r, float* out, double* dots);

  /// The member's planes on the finest level.
  std::pair<int, int> PlanesOf(const Team::Member& member) const { return PlanesOf(0, member); }
  std::size_t depth() const { return depth_; }
  /// Bytes that an iteration reads and writes if nothing stays in a cache.
  double BytesAnIteration() const;

 private:
  /// Three planes of a vector on the finest level, as a sliding window over the whole vector.
  class Window;

  void BuildBottom();
  void SolveBottom(const float* r, float* z) const;
  void SolveLast(std::size_t l, const float* r, float* z) const;
  void SolveCoarse(std::size_t l, const Team::Member& member);
  enum class Onto : std::uint8_t { kNothing, kFormer };
  void Visit(std::size_t l, const Team::Member& member, Onto onto);
  void ClearCoarse(std::size_t l, const Team::Member& member);
  void RestrictFurther(std::size_t l, const float* r, const float* z);
  void RestrictMovedFinest(const float* r);
  void CorrectMoved(std::size_t l, std::span<const Moved> moved, float* z) const;
  static void SubtractFurther(Level& level);
  float ResidualAt(const Level& level, std::size_t i) const;

  std::pair<int, int> PlanesOf(std::size_t l, const Team::Member& member) const;
  std::span<const Segment> SegmentsOf(std::size_t l, const Team::Member& member) const;
  std::span<const Segment> SegmentsOfPlane(std::size_t l, int plane) const;
  std::span<const Moved> MovedOfPlane(std::size_t l, int plane) const;
  std::span<const Moved> MovedFurther(std::size_t l) const;

  const FineProblem* problem_ = nullptr;
  const Kernels& kernels_ = BestKernels();
  std::vector<Level> levels_;  ///< Kept beyond depth_ for their memory.
  std::size_t depth_ = 0;
  std::vector<std::unique_ptr<Window>> windows_;  ///< One per thread.
  std::vector<std::size_t> bottom_nodes_;
  /// Empty when the last level has no links, because its diagonal is then enough.
  Eigen::MatrixXf bottom_inverse_;
};

}  // namespace thalweg::explorer::field
