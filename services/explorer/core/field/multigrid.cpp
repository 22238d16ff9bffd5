#include "services/explorer/core/field/multigrid.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "services/explorer/core/field/coarsening.h"
#include "services/explorer/core/field/multigrid_constants.h"

namespace thalweg::explorer::field {
namespace {

/// Levels with fewer cells, or a smaller share (1 / kWorthTeamShare) of the finest, are left to one thread:
/// the other threads would save less time than waiting costs, even more so when the machine has other work to
/// do.
constexpr std::size_t kWorthTeam = 10000;
constexpr std::size_t kWorthTeamShare = 20;

/// First plane of each thread's part. Parts have about equally many cells, and pairs of planes stay together.
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

class Multigrid::Window {
 public:
  void Reset(const Layout& layout, const Segments& segments) {
    layout_ = &layout;
    segments_ = &segments;
    margin_ = layout.stride_y + kChunk;  // how far the neighbors of a row reach beyond the plane
    slot_size_ = layout.stride_z + 2 * margin_;
    memory_.Reset(3 * slot_size_);
    held_ = {kNoPlane, kNoPlane, kNoPlane};
  }
  /// Starts over; the first plane requested will be begin - 1.
  void Start(int begin) { oldest_ = begin - 1; }

  /// Zeroed memory for a plane. Overwrites the plane three before.
  float* Next(int plane) {
    const std::size_t slot = Slot(plane);
    if (held_[slot] >= 0 && held_[slot] < layout_->nz) {
      const auto p = static_cast<std::size_t>(held_[slot]);
      for (std::size_t s = segments_->plane_begin[p]; s < segments_->plane_begin[p + 1]; ++s) {
        const Segment& segment = segments_->list[s];
        std::fill_n(At(slot, held_[slot]) + segment.begin, segment.length, 0.0F);
      }
    }
    held_[slot] = plane;
    return At(slot, plane);
  }
  Planes Around(int plane) {
    return {At(Slot(plane - 1), plane - 1), At(Slot(plane), plane), At(Slot(plane + 1), plane + 1)};
  }

 private:
  static constexpr int kNoPlane = -2;
  std::size_t Slot(int plane) const { return static_cast<std::size_t>(plane - oldest_) % 3; }
  /// A pointer shifted so that a cell's offset in the level addresses its place in the slot.
  float* At(std::size_t slot, int plane) {
    const std::size_t plane_begin = static_cast<std::size_t>(plane + 1) * layout_->stride_z;
    return memory_.data() + (slot * slot_size_ + margin_) - plane_begin;
  }

  const Layout* layout_ = nullptr;
  const Segments* segments_ = nullptr;
  Buffer<float> memory_;
  std::size_t margin_ = 0;
  std::size_t slot_size_ = 0;
  std::array<int, 3> held_{};
  int oldest_ = 0;
};

Multigrid::Multigrid() = default;
Multigrid::~Multigrid() = default;

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
    if (coarse.unknowns == 0) break;  // without links Jacobi is already exact
    ++depth_;
  }
  if (levels_[depth_ - 1].unknowns <= kBottomNodes) {
    levels_[depth_ - 1].moved.clear();
  }
  for (std::size_t l = 0; l < depth_; ++l) {
    levels_[l].part_begin = SplitPlanes(levels_[l].segments, levels_[l].layout.nz, team.count());
  }
  BuildBottom();
  while (windows_.size() < static_cast<std::size_t>(team.count()))
    windows_.push_back(std::make_unique<Window>());
  for (const std::unique_ptr<Window>& w : windows_) w->Reset(levels_[0].layout, levels_[0].segments);
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

std::span<const Segment> Multigrid::SegmentsOfPlane(std::size_t l, int plane) const {
  const Segments& s = levels_[l].segments;
  const auto p = static_cast<std::size_t>(plane);
  return {s.list.data() + s.plane_begin[p], s.list.data() + s.plane_begin[p + 1]};
}

std::span<const Moved> Multigrid::MovedOfPlane(std::size_t l, int plane) const {
  const Level& level = levels_[l];
  const auto from = [&level](std::size_t node) {
    return std::ranges::lower_bound(level.moved, node, {}, &Moved::node);
  };
  return {from(level.layout.Offset(-1, -1, plane)), from(level.layout.Offset(-1, -1, plane + 1))};
}

std::span<const Moved> Multigrid::MovedFurther(std::size_t l) const {
  const Level& level = levels_[l];
  return {std::ranges::lower_bound(level.moved, level.layout.total, {}, &Moved::node), level.moved.end()};
}

void Multigrid::Advance(const Team::Member& member, float alpha, const float* q, float* r, double* dots) {
  const FineOperator a = problem_->Operator();
  const auto [begin, end] = PlanesOf(0, member);
  const bool restricts = depth_ > 1;
  if (restricts) ClearCoarse(1, member);
  // The members beside this one read its outermost planes, so these are up to date before all others.
  const bool shared = member.count > 1;
  const auto outermost = [first = begin, last = end - 1](int plane) {
    return plane == first || plane == last;
  };
  for (int plane = begin; shared && plane < end; plane += std::max(1, end - 1 - begin)) {
    const std::span<const Segment> s = SegmentsOfPlane(0, plane);
    dots[plane] = kernels_.descend(s.data(), s.data() + s.size(), alpha, q, r);
  }
  member.Wait();
  Window& window = *windows_[static_cast<std::size_t>(member.index)];
  window.Start(begin);
  for (int plane = begin - 1; plane <= end; ++plane) {
    float* z = window.Next(plane);
    if (plane >= 0 && plane < levels_[0].layout.nz) {
      const std::span<const Segment> s = SegmentsOfPlane(0, plane);
      const Segment* first = s.data();
      const Segment* last = first + s.size();
      const bool inside = plane >= begin && plane < end;
      if (inside && !(shared && outermost(plane))) {
        dots[plane] = kernels_.advance(a, first, last, alpha, q, r, z);
      } else if (restricts) {
        kernels_.start_finest(a, first, last, r, z);
      }
    }
    if (!restricts || plane <= begin) continue;
    const std::span<const Segment> s = SegmentsOfPlane(0, plane - 1);
    kernels_.fine.restrict_residual(a, s.data(), s.data() + s.size(), r, window.Around(plane - 1),
                                    levels_[1].r.data());
  }
  member.Wait();
  if (restricts && !levels_[0].moved.empty()) {
    if (member.leads()) RestrictMovedFinest(r);
    member.Wait();
  }
}

void Multigrid::Precondition(const Team::Member& member, const float* r, float* out, double* dots) {
  const FineOperator a = problem_->Operator();
  const Level& finest = levels_[0];
  const auto [begin, end] = PlanesOf(0, member);
  if (depth_ == 1) {
    if (member.leads()) SolveLast(0, r, out);
    member.Wait();
    for (int plane = begin; plane < end; ++plane) {
      dots[plane] = 0.0;
      for (const Segment& s : SegmentsOfPlane(0, plane)) {
        for (std::size_t i = s.begin; i < s.begin + s.length; ++i)
          dots[plane] += double{r[i]} * double{out[i]};
      }
    }
    return;
  }
  SolveCoarse(1, member);
  const float* coarse = levels_[1].z.data();
  Window& window = *windows_[static_cast<std::size_t>(member.index)];
  window.Start(begin);
  for (int plane = begin - 1; plane <= end; ++plane) {
    float* z = window.Next(plane);
    if (plane >= 0 && plane < finest.layout.nz) {
      const std::span<const Segment> s = SegmentsOfPlane(0, plane);
      kernels_.start_corrected(a, s.data(), s.data() + s.size(), coarse, r, z);
      CorrectMoved(0, MovedOfPlane(0, plane), z);
    }
    if (plane <= begin) continue;
    const std::span<const Segment> s = SegmentsOfPlane(0, plane - 1);
    dots[plane - 1] =
        kernels_.fine.finish(a, s.data(), s.data() + s.size(), r, window.Around(plane - 1), out);
  }
}

/// coarse.r = 0, in the member's part according to the finer level.
void Multigrid::ClearCoarse(std::size_t l, const Team::Member& member) {
  Level& coarse = levels_[l];
  const auto [begin, end] = PlanesOf(l - 1, member);
  for (int plane = begin / 2; plane < (end + 1) / 2; ++plane) {
    const auto p = static_cast<std::size_t>(plane);
    for (std::size_t s = coarse.segments.plane_begin[p]; s < coarse.segments.plane_begin[p + 1]; ++s) {
      const Segment& segment = coarse.segments.list[s];
      std::fill_n(coarse.r.data() + segment.begin, segment.length, 0.0F);
    }
  }
  if (member.leads()) std::fill_n(coarse.r.data() + coarse.layout.total, coarse.further, 0.0F);
}

/// Moves contributions that the sweep over the finest level added to the wrong block into the right one.
void Multigrid::RestrictMovedFinest(const float* r) {
  const Layout& layout = levels_[0].layout;
  const auto z = [&](std::size_t i) {
    return problem_->Active(i) ? kRelaxation * r[i] / problem_->Diagonal(i) : 0.0F;
  };
  float* into = levels_[1].r.data();
  for (const Moved& m : levels_[0].moved) {
    const std::size_t i = m.node;
    const float around = z(i - 1) + z(i + 1) + z(i - layout.stride_y) + z(i + layout.stride_y) +
                         z(i - layout.stride_z) + z(i + layout.stride_z);
    const float half = 0.5F * ((1.0F - kRelaxation) * r[i] + around);
    into[m.implied] -= half;
    if (m.parent != kNone) into[m.parent] += half;
  }
}

/// The same on a coarse level, plus the contributions of its further nodes and links.
void Multigrid::RestrictFurther(std::size_t l, const float* r, const float* z) {
  const Level& fine = levels_[l];
  float* into = levels_[l + 1].r.data();
  for (const Moved& m : fine.moved) {
    const float half = 0.5F * (m.implied == kNone ? r[m.node] - fine.diagonal[m.node] * z[m.node]
                                                  : ResidualAt(fine, m.node));
    if (m.implied != kNone) into[m.implied] -= half;
    if (m.parent != kNone) into[m.parent] += half;
  }
  for (const Link& link : fine.links) {
    into[link.parent_a] += 0.5F * link.weight * z[link.b];
    into[link.parent_b] += 0.5F * link.weight * z[link.a];
  }
}

/// r - A work at a node of the grid, without links.
float Multigrid::ResidualAt(const Level& level, std::size_t i) const {
  const float* z = level.work.data();
  float residual = level.r[i] - level.diagonal[i] * z[i];
  int axis = 0;
  for (const std::size_t stride : {std::size_t{1}, level.layout.stride_y, level.layout.stride_z}) {
    residual += level.Weight(axis, i, stride) * z[i + stride] +
                level.Weight(axis, i - stride, stride) * z[i - stride];
    ++axis;
  }
  return residual;
}

void Multigrid::CorrectMoved(std::size_t l, std::span<const Moved> moved, float* z) const {
  const float* coarse = levels_[l + 1].z.data();
  for (const Moved& m : moved) {
    if (m.implied != kNone) z[m.node] -= coarse[m.implied];
    if (m.parent != kNone) z[m.node] += coarse[m.parent];
  }
}

/// Computes level l's z from its r by two cycles, or exactly on the last level.
void Multigrid::SolveCoarse(std::size_t l, const Team::Member& member) {
  Level& level = levels_[l];
  if (member.count > 1 &&
      level.layout.total < std::max(kWorthTeam, levels_[0].layout.total / kWorthTeamShare)) {
    if (member.leads()) SolveCoarse(l, member.Alone());
    member.Wait();
    return;
  }
  if (l + 1 == depth_) {
    if (member.leads()) SolveLast(l, level.r.data(), level.z.data());
    member.Wait();
    return;
  }
  Visit(l, member, Onto::kNothing);
  const std::span<const Segment> part = SegmentsOf(l, member);
  kernels_.subtract(level.Operator(), part.data(), part.data() + part.size(), level.z.data(), level.r.data());
  member.Wait();
  if (level.further > 0) {
    if (member.leads()) SubtractFurther(level);
    member.Wait();
  }
  Visit(l, member, Onto::kFormer);
}

/// Solves exactly on a level that has no coarser one.
void Multigrid::SolveLast(std::size_t l, const float* r, float* z) const {
  if (!bottom_nodes_.empty()) return SolveBottom(r, z);
  const Level& level = levels_[l];
  const auto diagonal = [&](std::size_t i) { return l == 0 ? problem_->Diagonal(i) : level.diagonal[i]; };
  for (const Segment& s : level.segments.list) {
    for (std::size_t i = s.begin; i < s.begin + s.length; ++i) {
      z[i] = diagonal(i) > 0.0F ? r[i] / diagonal(i) : 0.0F;
    }
  }
  for (std::size_t i = level.layout.total; i < level.layout.total + level.further; ++i) {
    z[i] = r[i] / level.diagonal[i];
  }
}

/// r -= A z for the part of A that the sweep over the regular grid does not cover.
void Multigrid::SubtractFurther(Level& level) {
  for (std::size_t i = level.layout.total; i < level.layout.total + level.further; ++i) {
    level.r[i] -= level.diagonal[i] * level.z[i];
  }
  for (const Link& link : level.links) {
    level.r[link.a] += link.weight * level.z[link.b];
    level.r[link.b] += link.weight * level.z[link.a];
  }
}

/// One cycle on level l > 0 with zero initial guess: z = B r, or z += B r.
void Multigrid::Visit(std::size_t l, const Team::Member& member, Onto onto) {
  Level& level = levels_[l];
  const CoarseOperator a = level.Operator();
  const auto [begin, end] = PlanesOf(l, member);
  const std::size_t further_end = level.layout.total + level.further;
  float* r = level.r.data();
  float* work = level.work.data();
  float* z = level.z.data();
  const Planes planes{work, work, work};
  const auto leader_does = [&member](auto&& task) {
    if (member.leads()) task();
    member.Wait();
  };
  const auto over = [this, l](int plane, auto&& sweep) {
    const std::span<const Segment> s = SegmentsOfPlane(l, plane);
    sweep(s.data(), s.data() + s.size());
  };

  ClearCoarse(l + 1, member);
  Team::Pipeline(
      member, begin, end,
      [&](int plane) {
        over(plane,
             [&](const Segment* first, const Segment* last) { kernels_.start(a, first, last, r, work); });
      },
      [&](int plane) {
        over(plane, [&](const Segment* first, const Segment* last) {
          kernels_.coarse.restrict_residual(a, first, last, r, planes, levels_[l + 1].r.data());
        });
      });
  member.Wait();
  if (level.irregular()) {
    leader_does([&] {
      for (std::size_t i = level.layout.total; i < further_end; ++i) {
        work[i] = kRelaxation * r[i] / level.diagonal[i];
      }
      RestrictFurther(l, r, work);
    });
  }
  SolveCoarse(l + 1, member);
  Team::Pipeline(
      member, begin, end,
      [&](int plane) {
        over(plane, [&](const Segment* first, const Segment* last) {
          kernels_.correct(a, first, last, levels_[l + 1].z.data(), work);
        });
        CorrectMoved(l, MovedOfPlane(l, plane), work);
      },
      [&](int plane) {
        over(plane, [&](const Segment* first, const Segment* last) {
          if (onto == Onto::kNothing) {
            kernels_.coarse.finish(a, first, last, r, planes, z);
          } else {
            kernels_.coarse.finish_onto(a, first, last, r, planes, z);
          }
        });
      });
  member.Wait();
  if (level.further == 0) return;
  leader_does([&] {
    CorrectMoved(l, MovedFurther(l), work);
    for (std::size_t i = level.layout.total; i < further_end; ++i) {
      const float value = (1.0F - kRelaxation) * work[i] + kRelaxation * r[i] / level.diagonal[i];
      z[i] = onto == Onto::kNothing ? value : z[i] + value;
    }
    for (const Link& link : level.links) {
      z[link.a] += kRelaxation * link.weight * work[link.b] / level.diagonal[link.a];
      z[link.b] += kRelaxation * link.weight * work[link.a] / level.diagonal[link.b];
    }
  });
}

double Multigrid::BytesAnIteration() const {
  const auto cells = [](const Segments& segments) {
    std::size_t count = 0;
    for (const Segment& s : segments.list) count += s.length;
    return static_cast<double>(count);
  };
  // direction and apply 6 floats, advance 3, second half 2, and half a byte of topology in each
  double bytes = cells(levels_[0].segments) * (11 * sizeof(float) + 1.5);
  double visits = 2.0;
  for (std::size_t l = 1; l + 1 < depth_; ++l, visits *= 2.0) {
    // per visit: start and restrict 6, correct and finish 9, clear 1; in every second: subtract 7, the former
    // z 1
    bytes += cells(levels_[l].segments) * (visits * 16 + visits / 2.0 * 8) * sizeof(float);
  }
  return bytes;
}

}  // namespace thalweg::explorer::field
