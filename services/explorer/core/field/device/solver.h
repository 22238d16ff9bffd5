#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "services/explorer/core/field/device/cycle.h"
#include "services/explorer/core/field/device/device_solver.h"
#include "services/explorer/core/field/device/jacobi.h"

namespace thalweg::explorer::field::device {

/// The harmonic field by conjugate gradients with the multigrid cycle of the CPU's solver, all of it where
/// the execution runs: the cells are copied in once, phi is copied out once, and in between only sums and
/// counts are read. Its buffers stay for the next solve.
template <class Execution>
class Solver : public DeviceSolver {
 public:
  template <class... Arguments>
  explicit Solver(Arguments&&... arguments) : execution_(std::forward<Arguments>(arguments)...) {}

  Outcome Solve(const std::uint8_t* cells, const int size[3], const Parameters& parameters,
                float* phi) override {
    const std::size_t total = TakeCells(cells, size);
    parameters_ = parameters;
    scalars_.Resize(1);
    execution_.Clear(scalars_.data(), 1);
    Outcome outcome;
    StoreBricks();
    BuildHierarchy();
    outcome.unknowns = CountUnknowns();
    if (outcome.unknowns > 0) Iterate(outcome);
    const float nothing = std::numeric_limits<float>::quiet_NaN();
    execution_.ForEach(static_cast<Index>(total),
                       WritePhi{shape_, codes_.data(), in_rows_.data(), high_.data(), low_.data(),
                                parameters_.weak_sink, nothing, phi_.data()});
    execution_.CopyOut(phi_.data(), phi, total);
    return outcome;
  }

  Relaxed Relax(const std::uint8_t* cells, const int size[3], float largest_change, int max_sweeps,
                float* phi) override {
    const std::size_t total = TakeCells(cells, size);
    phi_next_.Resize(total);
    changed_.Resize(kSweepsAtOnce);
    const float nothing = std::numeric_limits<float>::quiet_NaN();
    execution_.ForEach(static_cast<Index>(total),
                       StartJacobi{codes_.data(), nothing, phi_.data(), phi_next_.data()});
    Relaxed outcome;
    while (!outcome.stopped && outcome.sweeps < max_sweeps) {
      execution_.Clear(changed_.data(), kSweepsAtOnce);
      int sweep = 0;
      for (; sweep < kSweepsAtOnce && outcome.sweeps < max_sweeps; ++sweep, ++outcome.sweeps) {
        execution_.Sweep(JacobiSweep{shape_, codes_.data(), phi_.data(), phi_next_.data(), largest_change,
                                     changed_.data() + sweep});
        std::swap(phi_, phi_next_);
      }
      Index changed[kSweepsAtOnce];
      execution_.CopyOut(changed_.data(), changed, kSweepsAtOnce);
      for (int k = 0; k < sweep; ++k) outcome.stopped |= changed[k] == 0;
    }
    execution_.CopyOut(phi_.data(), phi, total);
    return outcome;
  }

 private:
  template <class T>
  using Buffer = typename Execution::template Buffer<T>;

  /// Twice the largest field that is a target, and far below what 32 bits can number.
  static constexpr std::size_t kMostCells = std::size_t{1} << 28;
  static constexpr int kMostCodeBits = 27;

  /// The memory of one coarse level.
  struct Storage {
    Buffer<Index> slice, column, key, parent, member_begin, member_end, reached;
    Buffer<float> weight, diagonal, step, slack, mass, r, z, work, matrix;
  };

  /// @return The number of cells.
  std::size_t TakeCells(const std::uint8_t* cells, const int size[3]) {
    shape_ = ShapeOf(size[0], size[1], size[2]);
    const std::size_t total = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                              static_cast<std::size_t>(size[2]);
    if (total > kMostCells || shape_.CodeBits() > kMostCodeBits) {
      throw std::length_error("the map is too large for the field's solver on a device");
    }
    codes_.Resize(total);
    phi_.Resize(total);
    execution_.CopyIn(cells, codes_.data(), total);
    return total;
  }

  Scalars ReadScalars() {
    Scalars scalars;
    execution_.CopyOut(scalars_.data(), &scalars, 1);
    return scalars;
  }

  void StoreBricks() {
    const Index codes = 1U << shape_.CodeBits();
    flag_.Resize(codes);
    before_.Resize(codes);
    execution_.ForEach(codes, FlagBricks{shape_, codes_.data(), flag_.data()});
    bricks_.count = execution_.SumBefore(flag_.data(), before_.data(), codes) + 1;
    code_of_.Resize(bricks_.count);
    in_rows_.Resize(shape_.BrickInRows(0, 0, shape_.bricks[2]));
    execution_.Clear(code_of_.data(), 1);
    execution_.ForEach(codes,
                       NumberBricks{shape_, flag_.data(), before_.data(), code_of_.data(), in_rows_.data()});
    neighbor_.Resize(6 * std::size_t{bricks_.count});
    execution_.ForEach(bricks_.count, JoinBricks{shape_, code_of_.data(), in_rows_.data(), neighbor_.data()});

    const std::size_t cells = bricks_.cells();
    degree_.Resize(cells);
    given_.Resize(cells);
    for (Buffer<float>* b : {&right_, &high_, &low_, &r_, &r_next_, &p_, &p_next_, &q_, &out_})
      b->Resize(cells);
    bricks_.neighbor = neighbor_.data();
    bricks_.degree = degree_.data();
    bricks_.given = given_.data();
    bricks_.screening = parameters_.screening;
    bricks_.step[0] = 0.0F;
    for (int degree = 1; degree <= 6; ++degree) {
      bricks_.step[degree] = kRelaxation / (static_cast<float>(degree) + parameters_.screening);
    }
    execution_.ForEach(bricks_.blocks(), ReadCells{shape_, codes_.data(), code_of_.data(),
                                                   parameters_.weak_sink, degree_.data(), given_.data(),
                                                   right_.data(), high_.data(), low_.data(), p_.data()});
  }

  void BuildHierarchy() {
    hierarchy_ = {};
    const Index blocks = bricks_.blocks();
    part_.Resize(blocks);
    first_.Resize(blocks);
    count_.Resize(blocks);
    execution_.ForEach(blocks, FindParts{bricks_, part_.data(), count_.data()});
    const Index nodes = execution_.SumBefore(count_.data(), first_.data(), blocks);
    parts_ = {first_.data(), part_.data()};
    if (nodes == 0) return;
    block_of_.Resize(nodes);
    storage_[0].key.Resize(nodes);
    execution_.ForEach(blocks, PlaceParts{first_.data(), count_.data(), code_of_.data(), block_of_.data(),
                                          storage_[0].key.data()});
    hierarchy_.level[0].key = storage_[0].key.data();
    const FromCells rows{bricks_, parts_, block_of_.data()};
    WriteLevel(rows, nodes, CollectRows(rows, nodes));
    while (hierarchy_.level[hierarchy_.depth - 1].count > kBottomNodes && hierarchy_.depth < kMostLevels) {
      if (!Coarsen()) break;
    }
    const CoarseLevel& last = hierarchy_.level[hierarchy_.depth - 1];
    if (last.count <= kBottomNodes) {
      matrix_.Resize(std::size_t{last.count} * (last.count + 2));
      inverse_.Resize(std::size_t{last.count} * last.count);
      execution_.Together(1, InvertBottom{last, matrix_.data(), inverse_.data()});
      hierarchy_.inverse = inverse_.data();
    }
    FormCycle();
  }

  /// Forms the matrix of the cycle for the levels that are small enough, each by that of the level below. It
  /// is read in every iteration, so it must stay in the device's cache.
  void FormCycle() {
    for (int l = hierarchy_.depth - 2; l >= 0; --l) {
      const std::size_t nodes = hierarchy_.level[l].count;
      const ApplyCycle cycle{hierarchy_, l, nullptr};
      if (2 * sizeof(float) * nodes * nodes > execution_.CacheBytes() ||
          cycle.Room() > execution_.MemoryOfGroup()) {
        return;
      }
      storage_[l].matrix.Resize(nodes * nodes);
      float* matrix = storage_[l].matrix.data();
      execution_.Together(static_cast<Index>(nodes), ApplyCycle{hierarchy_, l, matrix}, cycle.Room());
      hierarchy_.dense = l;
      hierarchy_.matrix = matrix;
    }
  }

  /// Collects the rows of the next level. @return Whose slices WriteLevel will fill.
  template <class From>
  Storage& CollectRows(const From& from, Index nodes) {
    Storage& s = storage_[hierarchy_.depth];
    neighbors_.Resize(nodes);
    s.slack.Resize(nodes);
    s.mass.Resize(nodes);
    execution_.ForEach(nodes, CountNeighbors<From>{from, neighbors_.data(), s.slack.data(), s.mass.data()});
    return s;
  }

  template <class From>
  void WriteLevel(const From& from, Index nodes, Storage& s) {
    const Index slices = (nodes + kSlice - 1) / kSlice;
    entries_.Resize(slices + 1);
    s.slice.Resize(slices + 1);
    execution_.ForEach(slices + 1, SizeSlices{nodes, neighbors_.data(), entries_.data()});
    const Index entries = execution_.SumBefore(entries_.data(), s.slice.data(), slices + 1);
    s.column.Resize(entries);
    s.weight.Resize(entries);
    for (Buffer<float>* b : {&s.diagonal, &s.step, &s.r, &s.z, &s.work}) b->Resize(nodes);
    execution_.ForEach(slices * kSlice,
                       WriteRows<From>{from, nodes, s.slice.data(), SlackFactor(hierarchy_.depth + 1),
                                       s.column.data(), s.weight.data(), s.diagonal.data(), s.step.data()});
    CoarseLevel& level = hierarchy_.level[hierarchy_.depth++];
    level.count = nodes;
    level.slice = s.slice.data();
    level.column = s.column.data();
    level.weight = s.weight.data();
    level.diagonal = s.diagonal.data();
    level.step = s.step.data();
    level.slack = s.slack.data();
    level.mass = s.mass.data();
    level.r = s.r.data();
    level.z = s.z.data();
    level.work = s.work.data();
  }

  /// Adds the level above the last one. @return false if no node of the last one has a link.
  bool Coarsen() {
    const int l = hierarchy_.depth - 1;
    CoarseLevel& fine = hierarchy_.level[l];
    int shift = 3;  // a brick has two blocks along each axis
    if (l > 0) {
      shift = 0;
      for (const int bits : shape_.bits) shift += bits > l - 1 ? 1 : 0;
    }
    flag_.Resize(fine.count);
    before_.Resize(fine.count);
    execution_.ForEach(fine.count, FlagGroups{fine.key, shift, flag_.data()});
    const Index groups = execution_.SumBefore(flag_.data(), before_.data(), fine.count);
    group_begin_.Resize(groups + 1);
    execution_.ForEach(fine.count,
                       BeginGroups{flag_.data(), before_.data(), fine.count, groups, group_begin_.data()});
    label_.Resize(fine.count);
    group_count_.Resize(groups);
    group_first_.Resize(groups);
    const LabelParts label{fine, group_begin_.data(), label_.data(), group_count_.data()};
    execution_.ForEach(groups, label);
    const Index nodes = execution_.SumBefore(group_count_.data(), group_first_.data(), groups);
    if (nodes == 0) return false;
    storage_[l].parent.Resize(fine.count);
    fine.parent = storage_[l].parent.data();
    Storage& s = storage_[l + 1];
    for (Buffer<Index>* b : {&s.key, &s.member_begin, &s.member_end}) b->Resize(nodes);
    execution_.ForEach(groups, NumberNodes{label, group_first_.data(), shift, storage_[l].parent.data(),
                                           s.key.data(), s.member_begin.data(), s.member_end.data()});
    CoarseLevel& coarse = hierarchy_.level[l + 1];
    coarse.key = s.key.data();
    coarse.member_begin = s.member_begin.data();
    coarse.member_end = s.member_end.data();
    most_.Resize(nodes);
    room_.Resize(nodes);
    execution_.ForEach(nodes, BoundRow{fine, coarse.member_begin, coarse.member_end, most_.data()});
    const Index entries = execution_.SumBefore(most_.data(), room_.data(), nodes);
    others_.Resize(entries);
    weights_.Resize(entries);
    CollectRows(FromLevel{fine, coarse.member_begin, coarse.member_end, room_.data(), others_.data(),
                          weights_.data()},
                nodes);
    WriteLevel(FromRoom{room_.data(), others_.data(), weights_.data(), neighbors_.data(), s.slack.data(),
                        s.mass.data()},
               nodes, s);
    return true;
  }

  std::size_t CountUnknowns() {
    const int depth = hierarchy_.depth;
    for (int l = depth - 1; l >= 0; --l) {
      const CoarseLevel& level = hierarchy_.level[l];
      storage_[l].reached.Resize(level.count);
      Index* reached = storage_[l].reached.data();
      if (l == depth - 1) {
        execution_.Together(1, ReachBottom{level, reached});
      } else {
        execution_.ForEach(level.count, ReachedFromParent{level, storage_[l + 1].reached.data(), reached});
      }
    }
    const Index* reached = depth > 0 ? storage_[0].reached.data() : nullptr;
    execution_.Sum(bricks_.blocks(), CountReached{bricks_, parts_, reached}, scalars_.data(), StoreSquare{});
    return static_cast<std::size_t>(ReadScalars().r_r);
  }

  void SumTrueResidual() {
    execution_.Sum(bricks_.blocks(),
                   TrueResidual{bricks_, right_.data(), high_.data(), low_.data(), r_.data()},
                   scalars_.data(), StoreSquare{});
  }
  double TrueSquare() {
    SumTrueResidual();
    return ReadScalars().r_r;
  }

  /// The step of the conjugate gradients whose length is in the scalars, then the way to the coarse levels.
  void AdvanceStep() {
    float* coarse = hierarchy_.depth > 0 ? hierarchy_.level[0].r : nullptr;
    execution_.Sum(bricks_.blocks(),
                   Advance{bricks_, parts_, scalars_.data(), p_.data(), q_.data(), r_.data(), low_.data(),
                           r_next_.data(), coarse},
                   scalars_.data(), StoreSquare{});
    std::swap(r_, r_next_);
  }

  /// As HarmonicField on the CPU: the recursive residual is replaced by the true one whenever it has dropped
  /// by kFold, and before the end, so that the reported residual is the true one.
  void Iterate(Outcome& outcome) {
    const double b_b = TrueSquare();
    double square = b_b;
    const double goal = parameters_.relative_residual * parameters_.relative_residual * b_b;
    double fold_at = kFold * kFold * square;
    execution_.ForEach(1, ForgetStep{scalars_.data()});
    execution_.Clear(q_.data(), bricks_.cells());  // multiplied by the first step's length, which is 0
    bool reached = square <= goal;
    while (!reached) {
      AdvanceStep();
      const Scalars sums = ReadScalars();
      if (outcome.iterations > 0 && !(sums.p_q > 0.0)) break;  // r is 0, or only rounding is left
      square = sums.r_r;
      if (square <= goal || square <= fold_at) {
        if (square <= goal) square = TrueSquare();
        reached = square <= goal;
        if (reached) break;
        execution_.ForEach(bricks_.cells(), Fold{high_.data(), low_.data()});
        square = TrueSquare();
        fold_at = kFold * kFold * square;
        execution_.ForEach(1, ForgetStep{scalars_.data()});
        AdvanceStep();
      }
      if (outcome.iterations >= parameters_.max_iterations) break;
      ++outcome.iterations;
      if (hierarchy_.depth > 0) SolveCoarse(hierarchy_, 0, execution_);
      const float* coarse = hierarchy_.depth > 0 ? hierarchy_.level[0].z : nullptr;
      execution_.Sum(bricks_.blocks(), Precondition{bricks_, parts_, r_.data(), coarse, out_.data()},
                     scalars_.data(), StoreTurn{outcome.iterations == 1});
      execution_.Sum(bricks_.blocks(),
                     Direct{bricks_, scalars_.data(), out_.data(), p_.data(), p_next_.data(), q_.data()},
                     scalars_.data(), StoreStep{});
      std::swap(p_, p_next_);
    }
    if (!reached) square = TrueSquare();
    outcome.relative_residual = b_b > 0.0 ? std::sqrt(square / b_b) : 0.0;
  }

  Execution execution_;
  Parameters parameters_;
  GridShape shape_{};
  Bricks bricks_{};
  Parts parts_{};
  Hierarchy hierarchy_;
  Storage storage_[kMostLevels];
  Buffer<std::uint8_t> codes_, degree_, given_;
  Buffer<Index> changed_, flag_, before_, code_of_, in_rows_, neighbor_, part_, first_, count_, block_of_;
  Buffer<Index> neighbors_, entries_, most_, room_, others_, group_begin_, label_, group_count_, group_first_;
  Buffer<float> right_, high_, low_, r_, r_next_, p_, p_next_, q_, out_, phi_, phi_next_, weights_, inverse_;
  Buffer<double> matrix_;
  Buffer<Scalars> scalars_;
};

}  // namespace thalweg::explorer::field::device
