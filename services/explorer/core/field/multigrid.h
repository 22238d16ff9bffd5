#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "services/explorer/core/field/fine_problem.h"
#include "services/explorer/core/field/kernels.h"
#include "services/explorer/core/field/layout.h"
#include "services/explorer/core/field/team.h"

namespace thalweg::explorer::field {

inline constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// A link that the regular grid cannot hold, because at one end is a further node of a block.
struct Link {
  std::size_t a, b;
  float weight;
  std::size_t parent_a = kNone, parent_b = kNone;
};

/// A node whose aggregate is not the one that its place implies.
struct Moved {
  std::size_t node;
  std::size_t implied;  ///< Its block in the next level; kNone for further nodes, which no sweep touches.
  std::size_t parent;   ///< Its aggregate; kNone where it has no links and needs no correction.
};

/// One grid of the hierarchy. Nodes at offsets beyond the layout are `further` nodes: blocks whose cells fall
/// apart into several connected parts have one node in the grid for the largest part and one for each other.
struct Level {
  Layout layout;
  Segments segments;
  std::size_t unknowns = 0;
  std::size_t further = 0;
  std::vector<std::size_t> further_place;  ///< The block, in `layout`, of each further node.
  std::vector<Link> links;
  std::vector<Moved> moved;
  std::vector<int> part_begin;  ///< First plane of each thread, even; one more at the end.

  Buffer<float> diagonal, weight_x, weight_y, weight_z;  // not on the finest level
  Buffer<float> slack, mass;
  Buffer<float> r, z, work, sum;

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

/// A symmetric multigrid cycle on the voxel grid, the preconditioner of the field's conjugate gradients.
///
/// Coarse cells are the connected parts of 2x2x2 blocks; interpolation is constant on each; the coarse
/// operator is Galerkin's, halved, because it takes a gradient over twice the distance for one over a single
/// cell [Braess: Towards algebraic multigrid for elliptic problems of second order, Computing 55, 1995]. One
/// sweep of damped Jacobi before and after, and every coarse level is visited twice (a W-cycle, in which that
/// halving keeps the preconditioner positive definite; see README).
/// Threading: Apply is called by all members of the team at once.
class Multigrid {
 public:
  /// Hierarchy for `problem`, which must outlive it.
  void Build(const FineProblem& problem, Team& team);

  /// out = B r, given z = w D^-1 r, which is overwritten. Vectors of the finest level.
  /// @param dots  r . out of each plane
  void Apply(const Team::Member& member, const float* r, float* z, float* out, double* dots);

  /// Of the finest level, the member's planes.
  std::pair<int, int> PlanesOf(const Team::Member& member) const { return PlanesOf(0, member); }
  std::size_t level_count() const { return depth_; }

 private:
  void BuildBottom();
  void SolveBottom(const float* r, float* z) const;
  void Visit(std::size_t l, const Team::Member& member);
  void SolveCoarse(std::size_t l, const Team::Member& member);
  void SolveLast(Level& level) const;
  static void SubtractFurther(Level& level);
  void RestrictIrregular(std::size_t l, const float* r, const float* z);
  float ResidualAt(std::size_t l, std::size_t i, const float* r, const float* z) const;
  template <class Operator>
  void Restrict(std::size_t l, const Operator& a, const Sweeps<Operator>& sweeps, const Team::Member& member,
                const float* r, const float* z);
  template <class Operator>
  void Correct(std::size_t l, const Operator& a, const Sweeps<Operator>& sweeps, const Team::Member& member,
               float* z);

  std::pair<int, int> PlanesOf(std::size_t l, const Team::Member& member) const;
  std::span<const Segment> SegmentsOf(std::size_t l, const Team::Member& member) const;

  const FineProblem* problem_ = nullptr;
  const Kernels& kernels_ = BestKernels();
  std::vector<Level> levels_;  ///< Kept beyond depth_ for their memory.
  std::size_t depth_ = 0;
  std::vector<std::size_t> bottom_nodes_;
  Eigen::MatrixXf bottom_inverse_;  ///< Empty where the last level has no links: its diagonal is enough.
};

}  // namespace thalweg::explorer::field
