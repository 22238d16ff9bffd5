#pragma once

#include "services/explorer/core/field/device/coarse_graph.h"

/// The coarse levels' cycle. It is written against an execution, which runs a body for each of a number of
/// nodes before it goes on: by kernels, or by one group of threads of a kernel.
namespace thalweg::explorer::field::device {

constexpr int kMostLevels = 20;
struct Hierarchy {
  CoarseLevel level[kMostLevels];
  int depth = 0;  ///< Coarse levels.
  /// The last level's; nullptr where it has no links, because then its diagonal is enough.
  float* inverse = nullptr;
  /// The cycle is linear. That of a level with few nodes, with all levels below, is applied as the dense
  /// matrix that it amounts to: sweeps over so few nodes take longer than the memory needs for the matrix.
  int dense = kMostLevels;
  float* matrix = nullptr;
};

/// level.z = B level.r for one level and all below it, by two visits of each (a W-cycle).
template <class Execution>
THALWEG_PORTABLE void SolveCoarse(const Hierarchy& h, int from, Execution& execution) {
  int visits[kMostLevels] = {};
  int l = from;
  bool down = true;
  while (true) {
    const CoarseLevel& level = h.level[l];
    if (down && (l == h.dense || l + 1 == h.depth)) {
      if (l == h.dense) {
        execution.Product(h.matrix, level.count, level.r, level.z);
      } else if (h.inverse != nullptr) {
        execution.Product(h.inverse, level.count, level.r, level.z);
      } else {
        execution.ForEach(level.count, Divide{level});
      }
      if (l == from) return;
      down = false;
      --l;
    } else if (down) {
      execution.ForEach(level.count, SmoothedResidual{level});
      execution.ForEach(h.level[l + 1].count, Restrict{level, h.level[l + 1]});
      visits[++l] = 0;
    } else {
      execution.ForEach(level.count, Correct{level, h.level[l + 1].z});
      execution.ForEach(level.count, Finish{level, visits[l] == 1});
      if (visits[l]++ == 0) {
        execution.ForEach(level.count, Subtract{level});
        down = true;
      } else {
        if (l == from) return;
        --l;
      }
    }
  }
}

struct CopyMatrix {
  CoarseLevel level;
  double* matrix;  ///< count x count.

  THALWEG_PORTABLE void operator()(Index i) const {
    for (Index j = 0; j < level.count; ++j) matrix[i * level.count + j] = 0.0;
    matrix[i * level.count + i] = static_cast<double>(level.diagonal[i]);
    double* row = matrix + i * level.count;
    level.ForRow(i, [row](Index other, float w) { row[other] -= static_cast<double>(w); });
  }
};

/// One step of the inversion, for the pivot `k`: what it needs of its row and column is set aside first.
struct TakePivot {
  const double* matrix;
  Index count, k;
  double least;  ///< A pivot below it belongs to a part that nothing reaches: its rows become 0.
  double *row, *column;

  THALWEG_PORTABLE void operator()(Index i) const {
    const double pivot = matrix[k * count + k];
    const double inverse = pivot > least ? 1.0 / pivot : 0.0;
    row[i] = i == k ? inverse : matrix[k * count + i] * inverse;
    column[i] = i == k ? 0.0 : matrix[i * count + k];
    if (inverse == 0.0) column[i] = row[i] = 0.0;
  }
};

struct Eliminate {
  double* matrix;
  Index count, k;
  const double *row, *column;

  THALWEG_PORTABLE void operator()(Index entry) const {
    const Index i = entry / count;
    const Index j = entry % count;
    if (i == k) {
      matrix[entry] = row[j];
    } else if (j == k) {
      matrix[entry] = -column[i] * row[k];
    } else {
      matrix[entry] -= column[i] * row[j];
    }
  }
};

struct RoundMatrix {
  const double* matrix;
  float* rounded;

  THALWEG_PORTABLE void operator()(Index entry) const { rounded[entry] = static_cast<float>(matrix[entry]); }
};

/// Inverts the last level's matrix in place by Gauss and Jordan; symmetric and positive definite, it needs no
/// search for pivots.
struct InvertBottom {
  CoarseLevel level;
  double* matrix;  ///< count x count, then two rows.
  float* inverse;

  template <class Execution>
  THALWEG_PORTABLE void operator()(Execution& execution, Index) const {
    const Index n = level.count;
    double* row = matrix + n * n;
    double* column = row + n;
    execution.ForEach(n, CopyMatrix{level, matrix});
    for (Index k = 0; k < n; ++k) {
      // Rounding leaves some 1e-8 of the diagonal, which is summed in single precision.
      const double least = 1e-7 * static_cast<double>(level.diagonal[k]);
      execution.ForEach(n, TakePivot{matrix, n, k, least, row, column});
      execution.ForEach(n * n, Eliminate{matrix, n, k, row, column});
    }
    execution.ForEach(n * n, RoundMatrix{matrix, inverse});
  }
};

/// One column of the matrix of a level's cycle, by one group of threads, which keeps the vectors in memory of
/// its own. The matrix is symmetric, so its columns are stored as rows.
struct ApplyCycle {
  Hierarchy hierarchy;
  int from;
  float* matrix;

  /// [bytes] that the group's memory must have.
  std::size_t Room() const {
    std::size_t nodes = 0;
    for (int l = from; l < hierarchy.depth; ++l) nodes += hierarchy.level[l].count;
    return sizeof(Hierarchy) + 3 * sizeof(float) * nodes;
  }

  struct MoveVectors {
    const Hierarchy* hierarchy;
    int from;
    Hierarchy* moved;
    THALWEG_PORTABLE void operator()(Index) const {
      *moved = *hierarchy;
      auto* next = reinterpret_cast<float*>(moved + 1);
      for (int l = from; l < hierarchy->depth; ++l) {
        CoarseLevel& level = moved->level[l];
        level.r = next;
        level.z = next + level.count;
        level.work = next + 2 * level.count;
        next += 3 * level.count;
      }
    }
  };
  struct SetUnit {
    CoarseLevel level;
    Index one;
    THALWEG_PORTABLE void operator()(Index i) const { level.r[i] = i == one ? 1.0F : 0.0F; }
  };
  struct Keep {
    CoarseLevel level;
    float* row;
    THALWEG_PORTABLE void operator()(Index i) const { row[i] = level.z[i]; }
  };

  template <class Execution>
  THALWEG_PORTABLE void operator()(Execution& execution, Index column) const {
    auto* moved = static_cast<Hierarchy*>(execution.Memory());
    execution.ForEach(1, MoveVectors{&hierarchy, from, moved});
    const CoarseLevel& top = moved->level[from];
    execution.ForEach(top.count, SetUnit{top, column});
    SolveCoarse(*moved, from, execution);
    execution.ForEach(top.count, Keep{top, matrix + static_cast<std::size_t>(column) * top.count});
  }
};

/// Marks the last level's nodes that a source or a sink reaches.
struct ReachBottom {
  CoarseLevel level;
  Index* reached;

  struct Begin {
    CoarseLevel level;
    Index* reached;
    THALWEG_PORTABLE void operator()(Index i) const { reached[i] = level.slack[i] > 0.0F ? 1U : 0U; }
  };
  struct Spread {
    CoarseLevel level;
    Index* reached;
    THALWEG_PORTABLE void operator()(Index i) const {
      const Index* from = reached;
      Index any = from[i];
      level.ForRow(i, [&any, from](Index other, float w) {
        if (w > 0.0F) any |= from[other];
      });
      if (any != 0) reached[i] = 1;
    }
  };
  template <class Execution>
  THALWEG_PORTABLE void operator()(Execution& execution, Index) const {
    execution.ForEach(level.count, Begin{level, reached});
    for (Index round = 1; round < level.count && round < kBottomNodes; ++round) {
      execution.ForEach(level.count, Spread{level, reached});
    }
  }
};

}  // namespace thalweg::explorer::field::device
