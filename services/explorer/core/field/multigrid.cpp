#include "services/explorer/core/field/multigrid.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "services/explorer/core/field/coarsening.h"

namespace thalweg::explorer::field {
namespace {

/// Levels of so few nodes are solved by their dense inverse.
constexpr std::size_t kBottomNodes = 64;
/// Levels of fewer cells are left to one thread.
constexpr std::size_t kWorthTeam = 30000;

/// First plane of each thread's part: about the same number of cells each, pairs of planes kept together.
std::vector<int> SplitPlanes(const Segments& segments, int planes, int threads) {
  std::vector<std::size_t> cells_before{0};
  for (int z = 0; z < planes; ++z) {
    std::size_t cells = cells_before.back();
    for (std::size_t s = segments.plane_begin[static_cast<std::size_t>(z)];
         s < segments.plane_begin[static_cast<std::size_t>(z) + 1]; ++s) {
      cells += segments.list[s].length;
    }
    cells_before.push_back(cells);
  }
  std::vector<int> begin{0};
  for (int t = 1; t < threads; ++t) {
    const std::size_t share =
        cells_before.back() * static_cast<std::size_t>(t) / static_cast<std::size_t>(threads);
    const auto at = std::lower_bound(cells_before.begin(), cells_before.end(), share) - cells_before.begin();
    begin.push_back(std::max(begin.back(), std::min(planes, (static_cast<int>(at) + 1) / 2 * 2)));
  }
  begin.push_back(planes);
  return begin;
}

}  // namespace

void Multigrid::Build(const FineProblem& problem, Team& team) {
  problem_ = &problem;
  if (levels_.empty()) levels_.resize(1);
  levels_[0].layout = problem.layout();
  levels_[0].segments = problem.segments();
  levels_[0].unknowns = problem.unknowns();
  depth_ = 1;
  for (std::size_t l = 0; levels_[l].unknowns > kBottomNodes; ++l) {
    if (levels_.size() == l + 1) levels_.emplace_back();
    Level& fine = levels_[l];
    Level& coarse = levels_[l + 1];
    if (l == 0) {
      Coarsen(problem, fine, coarse, 1, team);
    } else {
      Coarsen(fine, fine, coarse, static_cast<int>(l) + 1, team);
    }
    if (coarse.unknowns == 0) break;  // no links: Jacobi is all there is to do
    ++depth_;
  }
  if (levels_[depth_ - 1].unknowns <= kBottomNodes) {
    levels_[depth_ - 1].moved.clear();
  }
  for (std::size_t l = 0; l < depth_; ++l) {
    levels_[l].part_begin = SplitPlanes(levels_[l].segments, levels_[l].layout.nz, team.count());
  }
  BuildBottom();
}

void Multigrid::BuildBottom() {
  const Level& bottom = levels_[depth_ - 1];
  bottom_nodes_.clear();
  bottom_inverse_.resize(0, 0);
  if (bottom.unknowns > kBottomNodes) return;
  const bool finest = depth_ == 1;
  const auto diagonal = [&](std::size_t i) { return finest ? problem_->Diagonal(i) : bottom.Diagonal(i); };
  for (const Segment& s : bottom.segments.list) {
    for (std::size_t i = s.begin; i < s.begin + s.length; ++i) {
      if (diagonal(i) > 0.0F) bottom_nodes_.push_back(i);
    }
  }
  for (std::size_t k = 0; k < bottom.further; ++k) bottom_nodes_.push_back(bottom.layout.total + k);

  const std::size_t strides[3] = {1, bottom.layout.stride_y, bottom.layout.stride_z};
  const auto number = static_cast<Eigen::Index>(bottom_nodes_.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(number, number);
  const auto index_of = [&](std::size_t node) {
    return std::lower_bound(bottom_nodes_.begin(), bottom_nodes_.end(), node) - bottom_nodes_.begin();
  };
  const auto link = [&](Eigen::Index a, Eigen::Index b, float weight) {
    matrix(a, b) -= static_cast<double>(weight);
    matrix(b, a) -= static_cast<double>(weight);
  };
  for (Eigen::Index k = 0; k < number; ++k) {
    const std::size_t i = bottom_nodes_[static_cast<std::size_t>(k)];
    matrix(k, k) += static_cast<double>(diagonal(i));
    if (i >= bottom.layout.total) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const float weight =
          finest ? problem_->Weight(axis, i, strides[axis]) : bottom.Weight(axis, i, strides[axis]);
      if (weight > 0.0F) link(k, index_of(i + strides[axis]), weight);
    }
  }
  for (const Link& l : bottom.links) link(index_of(l.a), index_of(l.b), l.weight);
  bottom_inverse_ = matrix.ldlt().solve(Eigen::MatrixXd::Identity(number, number)).cast<float>();
}

void Multigrid::SolveBottom(const float* r, float* z) const {
  const auto number = static_cast<Eigen::Index>(bottom_nodes_.size());
  Eigen::Matrix<float, Eigen::Dynamic, 1, 0, kBottomNodes, 1> values(number);
  for (Eigen::Index k = 0; k < number; ++k) values[k] = r[bottom_nodes_[static_cast<std::size_t>(k)]];
  const Eigen::Matrix<float, Eigen::Dynamic, 1, 0, kBottomNodes, 1> solution = bottom_inverse_ * values;
  for (Eigen::Index k = 0; k < number; ++k) z[bottom_nodes_[static_cast<std::size_t>(k)]] = solution[k];
}

std::pair<int, int> Multigrid::PlanesOf(std::size_t l, const Team::Member& member) const {
  const Level& level = levels_[l];
  if (member.count == 1) return {0, level.layout.nz};
  const auto t = static_cast<std::size_t>(member.index);
  return {level.part_begin[t], level.part_begin[t + 1]};
}

std::span<const Segment> Multigrid::SegmentsOf(std::size_t l, const Team::Member& member) const {
  const auto [begin, end] = PlanesOf(l, member);
  const Segments& s = levels_[l].segments;
  return {s.list.data() + s.plane_begin[static_cast<std::size_t>(begin)],
          s.list.data() + s.plane_begin[static_cast<std::size_t>(end)]};
}

void Multigrid::Apply(const Team::Member& member, const float* r, float* z, float* out, double* dots) {
  const auto [begin, end] = PlanesOf(0, member);
  const FineOperator a = problem_->Operator();
  const Segments& segments = levels_[0].segments;
  if (depth_ == 1 && !bottom_nodes_.empty()) {
    member.Wait();
    if (member.leads()) SolveBottom(r, z);
    member.Wait();
  } else {
    member.Wait();
    if (depth_ > 1) {
      Restrict(0, a, kernels_.fine, member, r, z);
      SolveCoarse(1, member);
      Correct(0, a, kernels_.fine, member, z);
    }
  }
  for (int plane = begin; plane < end; ++plane) {
    const auto p = static_cast<std::size_t>(plane);
    dots[p] = kernels_.fine.finish(a, segments.list.data() + segments.plane_begin[p],
                                   segments.list.data() + segments.plane_begin[p + 1], r, z, out);
  }
}

/// coarse.r = P^T (r - A z) / 2. All of r and z must be there; coarse.r is, afterwards.
template <class Operator>
void Multigrid::Restrict(std::size_t l, const Operator& a, const Sweeps<Operator>& sweeps,
                         const Team::Member& member, const float* r, const float* z) {
  const Level& fine = levels_[l];
  Level& coarse = levels_[l + 1];
  const auto [begin, end] = PlanesOf(l, member);
  for (int plane = begin / 2; plane < (end + 1) / 2; ++plane) {
    const auto p = static_cast<std::size_t>(plane);
    for (std::size_t s = coarse.segments.plane_begin[p]; s < coarse.segments.plane_begin[p + 1]; ++s) {
      const Segment& segment = coarse.segments.list[s];
      std::fill_n(coarse.r.data() + segment.begin, segment.length, 0.0F);
    }
  }
  const std::span<const Segment> segments = SegmentsOf(l, member);
  sweeps.restrict_residual(a, segments.data(), segments.data() + segments.size(), r, z, coarse.r.data());
  member.Wait();
  if (fine.irregular()) {
    if (member.leads()) RestrictIrregular(l, r, z);
    member.Wait();
  }
}

/// What the sweep over the regular grid has put into the wrong block, or left out.
void Multigrid::RestrictIrregular(std::size_t l, const float* r, const float* z) {
  const Level& fine = levels_[l];
  Level& coarse = levels_[l + 1];
  float* into = coarse.r.data();
  std::fill_n(into + coarse.layout.total, coarse.further, 0.0F);
  for (const Moved& m : fine.moved) {
    const float half = 0.5F * (m.implied == kNone ? r[m.node] - fine.diagonal[m.node] * z[m.node]
                                                  : ResidualAt(l, m.node, r, z));
    if (m.implied != kNone) into[m.implied] -= half;
    if (m.parent != kNone) into[m.parent] += half;
  }
  for (const Link& link : fine.links) {
    into[link.parent_a] += 0.5F * link.weight * z[link.b];
    into[link.parent_b] += 0.5F * link.weight * z[link.a];
  }
}

float Multigrid::ResidualAt(std::size_t l, std::size_t i, const float* r, const float* z) const {
  const Layout& layout = levels_[l].layout;
  float residual = r[i] - (l == 0 ? problem_->Diagonal(i) : levels_[l].diagonal[i]) * z[i];
  int axis = 0;
  for (const std::size_t stride : {std::size_t{1}, layout.stride_y, layout.stride_z}) {
    if (l == 0) {
      residual += z[i - stride] + z[i + stride];
    } else {
      residual += levels_[l].Weight(axis, i, stride) * z[i + stride] +
                  levels_[l].Weight(axis, i - stride, stride) * z[i - stride];
    }
    ++axis;
  }
  return residual;
}

/// z += P coarse.z
template <class Operator>
void Multigrid::Correct(std::size_t l, const Operator& a, const Sweeps<Operator>& sweeps,
                        const Team::Member& member, float* z) {
  const Level& fine = levels_[l];
  const float* coarse = levels_[l + 1].z.data();
  const std::span<const Segment> segments = SegmentsOf(l, member);
  sweeps.correct(a, segments.data(), segments.data() + segments.size(), coarse, z);
  member.Wait();
  if (!fine.irregular()) return;
  if (member.leads()) {
    for (const Moved& m : fine.moved) {
      if (m.implied != kNone) z[m.node] -= coarse[m.implied];
      if (m.parent != kNone) z[m.node] += coarse[m.parent];
    }
  }
  member.Wait();
}

/// Level l's z from its r by two cycles, or exactly.
void Multigrid::SolveCoarse(std::size_t l, const Team::Member& member) {
  Level& level = levels_[l];
  if (member.count > 1 && level.layout.total < kWorthTeam) {
    if (member.leads()) SolveCoarse(l, member.Alone());
    member.Wait();
    return;
  }
  if (l + 1 == depth_) {
    if (member.leads()) SolveLast(level);
    member.Wait();
    return;
  }
  const std::span<const Segment> part = SegmentsOf(l, member);
  const Segment* first = part.data();
  const Segment* last = first + part.size();
  Visit(l, member);
  kernels_.coarse.subtract(level.Operator(), first, last, level.z.data(), level.r.data());
  for (const Segment& s : part) std::copy_n(level.z.data() + s.begin, s.length, level.sum.data() + s.begin);
  if (level.further > 0) {
    member.Wait();
    if (member.leads()) {
      SubtractFurther(level);
      std::copy_n(level.z.data() + level.layout.total, level.further, level.sum.data() + level.layout.total);
    }
  }
  member.Wait();
  Visit(l, member);
  kernels_.add(first, last, level.sum.data(), level.z.data());
  if (member.leads()) {
    for (std::size_t i = level.layout.total; i < level.layout.total + level.further; ++i) {
      level.z[i] += level.sum[i];
    }
  }
  member.Wait();
}

void Multigrid::SolveLast(Level& level) const {
  if (!bottom_nodes_.empty()) return SolveBottom(level.r.data(), level.z.data());
  for (const Segment& s : level.segments.list) {
    for (std::size_t i = s.begin; i < s.begin + s.length; ++i) {
      level.z[i] = level.diagonal[i] > 0.0F ? level.r[i] / level.diagonal[i] : 0.0F;
    }
  }
  for (std::size_t i = level.layout.total; i < level.layout.total + level.further; ++i) {
    level.z[i] = level.r[i] / level.diagonal[i];
  }
}

/// r -= A z, as far as the sweep over the regular grid does not see it.
void Multigrid::SubtractFurther(Level& level) {
  for (std::size_t i = level.layout.total; i < level.layout.total + level.further; ++i) {
    level.r[i] -= level.diagonal[i] * level.z[i];
  }
  for (const Link& link : level.links) {
    level.r[link.a] += link.weight * level.z[link.b];
    level.r[link.b] += link.weight * level.z[link.a];
  }
}

/// One cycle on level l > 0 from zero: z = B r.
void Multigrid::Visit(std::size_t l, const Team::Member& member) {
  Level& level = levels_[l];
  const CoarseOperator a = level.Operator();
  const Sweeps<CoarseOperator>& sweeps = kernels_.coarse;
  const std::span<const Segment> part = SegmentsOf(l, member);
  const Segment* first = part.data();
  const Segment* last = first + part.size();
  const std::size_t further_end = level.layout.total + level.further;
  float* r = level.r.data();
  float* work = level.work.data();
  float* z = level.z.data();

  sweeps.start(a, first, last, r, work);
  if (member.leads()) {
    for (std::size_t i = level.layout.total; i < further_end; ++i) {
      work[i] = kRelaxation * r[i] / level.diagonal[i];
    }
  }
  member.Wait();
  Restrict(l, a, sweeps, member, r, work);
  SolveCoarse(l + 1, member);
  Correct(l, a, sweeps, member, work);
  sweeps.finish(a, first, last, r, work, z);
  member.Wait();
  if (level.further == 0) return;
  if (member.leads()) {
    for (std::size_t i = level.layout.total; i < further_end; ++i) {
      z[i] = (1.0F - kRelaxation) * work[i] + kRelaxation * r[i] / level.diagonal[i];
    }
    for (const Link& link : level.links) {
      z[link.a] += kRelaxation * link.weight * work[link.b] / level.diagonal[link.a];
      z[link.b] += kRelaxation * link.weight * work[link.a] / level.diagonal[link.b];
    }
  }
  member.Wait();
}

}  // namespace thalweg::explorer::field
