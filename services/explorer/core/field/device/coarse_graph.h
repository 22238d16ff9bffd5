#pragma once

#include "services/explorer/core/field/device/bricks.h"

/// The coarse levels on the device: graphs whose nodes are the connected parts of 2 x 2 x 2 blocks of the
/// level below, as on the CPU (Multigrid), but all of them stored as a sparse matrix, since a block with
/// several parts has no place in a grid. Nodes are numbered along the Z-curve of their blocks, so the nodes
/// of one block of the next level are neighbors in memory.
///
/// Rows are stored in slices of 32 nodes ("sliced ELLPACK" [Monakov, Lokhmotov, Avetisyan: Automatically
/// tuning sparse matrix-vector multiplication for GPU architectures, HiPEAC 2010]): the k-th entries of a
/// slice's nodes lie side by side, and shorter rows are filled up with entries of weight 0.
namespace thalweg::explorer::field::device {

constexpr Index kSlice = 32;

struct CoarseLevel {
  Index count = 0;
  const Index* slice = nullptr;   ///< By slice: its first entry; one more at the end.
  const Index* column = nullptr;  ///< By entry.
  const float* weight = nullptr;
  const float* diagonal = nullptr;
  const float* step = nullptr;  ///< kRelaxation / diagonal.
  const float* slack = nullptr;
  const float* mass = nullptr;
  const Index* key = nullptr;     ///< Place of the node's block along the Z-curve.
  const Index* parent = nullptr;  ///< Its node in the next level, or kNoNode; none on the last level.
  /// By node: those of the level below that may belong to it. Not on the first coarse level.
  const Index* member_begin = nullptr;
  const Index* member_end = nullptr;
  float* r = nullptr;
  float* z = nullptr;
  float* work = nullptr;

  /// Calls visit(other, weight) for each entry of a row, those of weight 0 included.
  template <class Visit>
  THALWEG_PORTABLE void ForRow(Index node, const Visit& visit) const {
    const Index end = slice[node / kSlice + 1];
    for (Index e = slice[node / kSlice] + node % kSlice; e < end; e += kSlice) visit(column[e], weight[e]);
  }
  /// The sum of weight times v over a row.
  THALWEG_PORTABLE float Around(Index node, const float* v) const {
    float sum = 0.0F;
    ForRow(node, [&sum, v](Index other, float w) { sum += w * v[other]; });
    return sum;
  }
};

// ---- The cycle --------------------------------------------------------------------------------------------

/// work = r - A w D^-1 r
struct SmoothedResidual {
  CoarseLevel level;

  THALWEG_PORTABLE void operator()(Index i) const {
    const float* r = level.r;
    const float* step = level.step;
    float sum = (1.0F - kRelaxation) * r[i];
    level.ForRow(i, [&sum, r, step](Index other, float w) { sum += w * step[other] * r[other]; });
    level.work[i] = sum;
  }
};

/// coarse r = P^T work / 2
struct Restrict {
  CoarseLevel fine, coarse;

  THALWEG_PORTABLE void operator()(Index node) const {
    float sum = 0.0F;
    for (Index m = coarse.member_begin[node]; m < coarse.member_end[node]; ++m) {
      sum += fine.parent[m] == node ? fine.work[m] : 0.0F;
    }
    coarse.r[node] = 0.5F * sum;
  }
};

/// work = w D^-1 r + P coarse z
struct Correct {
  CoarseLevel level;
  const float* coarse_z;

  THALWEG_PORTABLE void operator()(Index i) const {
    const Index parent = level.parent[i];
    level.work[i] = level.step[i] * level.r[i] + (parent == kNoNode ? 0.0F : coarse_z[parent]);
  }
};

/// z = work + w D^-1 (r - A work), added to z in the second of two visits.
struct Finish {
  CoarseLevel level;
  bool adds;

  THALWEG_PORTABLE void operator()(Index i) const {
    const float result =
        (1.0F - kRelaxation) * level.work[i] + level.step[i] * (level.r[i] + level.Around(i, level.work));
    level.z[i] = adds ? level.z[i] + result : result;
  }
};

/// r -= A z
struct Subtract {
  CoarseLevel level;

  THALWEG_PORTABLE void operator()(Index i) const {
    level.r[i] += level.Around(i, level.z) - level.diagonal[i] * level.z[i];
  }
};

/// z = D^-1 r, on a last level without links.
struct Divide {
  CoarseLevel level;

  THALWEG_PORTABLE void operator()(Index i) const {
    level.z[i] = level.diagonal[i] > 0.0F ? level.r[i] / level.diagonal[i] : 0.0F;
  }
};

// ---- Set-up -----------------------------------------------------------------------------------------------

/// The distinct neighbors of one node, with the sums of their weights, in memory that is large enough.
struct Row {
  Index* other;
  float* weight;
  Index count = 0;
  float slack = 0.0F;
  float mass = 0.0F;

  THALWEG_PORTABLE Row(Index* others, float* weights) : other(others), weight(weights) {}
  THALWEG_PORTABLE void Add(Index node, float w) {
    for (Index k = 0; k < count; ++k) {
      if (other[k] == node) {
        weight[k] += w;
        return;
      }
    }
    other[count] = node;
    weight[count++] = w;
  }
};

/// Rows of the first coarse level, from the cells.
struct FromCells {
  Bricks bricks;
  Parts parts;
  const Index* block_of;  ///< By node.

  /// Calls use(row) for a node's row.
  template <class Use>
  THALWEG_PORTABLE void WithRow(Index node, const Use& use) const {
    constexpr int kOuterFaces = 24;  // of a block
    Index others[kOuterFaces];
    float weights[kOuterFaces];
    Row row(others, weights);
    const Index block = block_of[node];
    const Index cell = block * kCellsPerBlock;
    for (Index k = 0; k < kCellsPerBlock; ++k) {
      if (parts.NodeOf(cell + k) != node) continue;
      row.slack += kFaceScale * static_cast<float>(bricks.given[cell + k]);
      row.mass += kMassScale * bricks.screening;
      for (int axis = 0; axis < 3; ++axis) {
        const Index bit = 1U << axis;
        const int face = 2 * axis + ((k & bit) != 0 ? 1 : 0);
        const Index other = parts.NodeOf(bricks.NeighborBlock(block, face) * kCellsPerBlock + (k ^ bit));
        if (other != kNoNode) row.Add(other, kFaceScale);
      }
    }
    use(row);
  }
};

/// Rows of each further level, from the level below.
struct FromLevel {
  CoarseLevel fine;
  const Index* member_begin;
  const Index* member_end;
  const Index* room;  ///< By node: where its share of `others` and `weights` begins.
  Index* others;
  float* weights;

  template <class Use>
  THALWEG_PORTABLE void WithRow(Index node, const Use& use) const {
    Row row(others + room[node], weights + room[node]);
    const Index* parent = fine.parent;
    for (Index m = member_begin[node]; m < member_end[node]; ++m) {
      if (parent[m] != node) continue;
      row.slack += kFaceScale * fine.slack[m];
      row.mass += kMassScale * fine.mass[m];
      fine.ForRow(m, [&row, parent, node](Index other, float w) {
        if (w > 0.0F && parent[other] != node) row.Add(parent[other], kFaceScale * w);
      });
    }
    use(row);
  }
};

/// How many neighbors a node of the next level can have at most.
struct BoundRow {
  CoarseLevel fine;
  const Index* member_begin;
  const Index* member_end;
  Index* most;

  THALWEG_PORTABLE void operator()(Index node) const {
    Index sum = 0;
    for (Index m = member_begin[node]; m < member_end[node]; ++m) {
      if (fine.parent[m] == node) sum += (fine.slice[m / kSlice + 1] - fine.slice[m / kSlice]) / kSlice;
    }
    most[node] = sum;
  }
};

/// The rows that CountNeighbors has collected from a level.
struct FromRoom {
  const Index* room;
  Index* others;
  float* weights;
  const Index* neighbors;
  const float *slack, *mass;

  template <class Use>
  THALWEG_PORTABLE void WithRow(Index node, const Use& use) const {
    Row row(others + room[node], weights + room[node]);
    row.count = neighbors[node];
    row.slack = slack[node];
    row.mass = mass[node];
    use(row);
  }
};

/// The number of distinct neighbors of each node, and its sums.
template <class From>
struct CountNeighbors {
  From from;
  Index* neighbors;
  float *slack, *mass;

  THALWEG_PORTABLE void operator()(Index node) const {
    const CountNeighbors& self = *this;
    from.WithRow(node, [&self, node](const Row& row) {
      self.neighbors[node] = row.count;
      self.slack[node] = row.slack;
      self.mass[node] = row.mass;
    });
  }
};

/// The entries of each slice: those of its longest row for all of its rows.
struct SizeSlices {
  Index count;
  const Index* neighbors;
  Index* entries;

  THALWEG_PORTABLE void operator()(Index slice) const {
    Index longest = 0;
    for (Index node = slice * kSlice; node < (slice + 1) * kSlice && node < count; ++node) {
      longest = neighbors[node] > longest ? neighbors[node] : longest;
    }
    entries[slice] = kSlice * longest;
  }
};

template <class From>
struct WriteRows {
  From from;
  Index count;
  const Index* slice;
  float factor;  ///< The factor of the share of given values in the diagonal.
  Index* column;
  float *weight, *diagonal, *step;

  /// @param node  Up to the end of the last slice, whose missing rows are filled, too.
  THALWEG_PORTABLE void operator()(Index node) const {
    const WriteRows& self = *this;
    if (node < count) {
      from.WithRow(node, [&self, node](const Row& row) { self.Write(node, row); });
    } else {
      Fill(node, Row(nullptr, nullptr));
    }
  }

 private:
  THALWEG_PORTABLE void Write(Index node, const Row& row) const {
    float sum = factor * row.slack + row.mass;
    for (Index k = 0; k < row.count; ++k) sum += row.weight[k];
    diagonal[node] = sum;
    step[node] = sum > 0.0F ? kRelaxation / sum : 0.0F;
    Fill(node, row);
  }
  THALWEG_PORTABLE void Fill(Index node, const Row& row) const {
    Index k = 0;
    for (Index e = slice[node / kSlice] + node % kSlice; e < slice[node / kSlice + 1]; e += kSlice, ++k) {
      column[e] = k < row.count ? row.other[k] : 0;
      weight[e] = k < row.count ? row.weight[k] : 0.0F;
    }
  }
};

/// The place of a first coarse level's nodes.
struct PlaceParts {
  const Index* first;
  const Index* count;
  const Index* code_of;
  Index* block_of;
  Index* key;

  THALWEG_PORTABLE void operator()(Index block) const {
    for (Index n = 0; n < count[block]; ++n) {
      block_of[first[block] + n] = block;
      key[first[block] + n] = code_of[block / kBlocksPerBrick] * kBlocksPerBrick + block % kBlocksPerBrick;
    }
  }
};

/// flag[i] = 1 for the first node of each block of the next level.
struct FlagGroups {
  const Index* key;
  int shift;  ///< By which the next level's keys are shorter.
  Index* flag;

  THALWEG_PORTABLE void operator()(Index i) const {
    flag[i] = i == 0 || key[i] >> shift != key[i - 1] >> shift ? 1 : 0;
  }
};

/// The first node of each group.
struct BeginGroups {
  const Index* flag;
  const Index* before;
  Index count;
  Index groups;
  Index* group_begin;  ///< One more entry at the end.

  THALWEG_PORTABLE void operator()(Index i) const {
    if (flag[i] != 0) group_begin[before[i]] = i;
    if (i == 0) group_begin[groups] = count;
  }
};

/// Labels each node with the least number of its connected part within its group, and counts the parts that
/// become nodes: those with two nodes or more, or with a link to another part.
struct LabelParts {
  CoarseLevel level;
  const Index* group_begin;
  Index* label;
  Index* parts;

  THALWEG_PORTABLE void operator()(Index group) const {
    const Index begin = group_begin[group];
    const Index end = group_begin[group + 1];
    for (Index m = begin; m < end; ++m) label[m] = m;
    for (bool changed = true; changed;) {
      changed = false;
      for (Index m = begin; m < end; ++m) {
        Index least = label[m];
        level.ForRow(m, [this, begin, end, &least](Index other, float w) {
          if (w > 0.0F && other >= begin && other < end && label[other] < least) least = label[other];
        });
        if (least != label[m]) {
          label[m] = least;
          changed = true;
        }
      }
    }
    Index count = 0;
    for (Index m = begin; m < end; ++m) {
      if (label[m] == m && Links(m)) ++count;
    }
    parts[group] = count;
  }
  /// Whether a node has any link: a part of one node without any is left to the smoother.
  THALWEG_PORTABLE bool Links(Index m) const {
    bool any = false;
    level.ForRow(m, [&any](Index, float w) { any |= w > 0.0F; });
    return any;
  }
};

struct NumberNodes {
  LabelParts parts;
  const Index* first;  ///< By group: its first node in the next level.
  int shift;
  Index* parent;
  Index* key;
  Index *member_begin, *member_end;

  THALWEG_PORTABLE void operator()(Index group) const {
    const Index begin = parts.group_begin[group];
    const Index end = parts.group_begin[group + 1];
    Index next = first[group];
    for (Index m = begin; m < end; ++m) {
      if (parts.label[m] != m) {
        parent[m] = parent[parts.label[m]];
      } else if (!parts.Links(m)) {
        parent[m] = kNoNode;
      } else {
        key[next] = parts.level.key[m] >> shift;
        member_begin[next] = begin;
        member_end[next] = end;
        parent[m] = next++;
      }
    }
  }
};

// ---- Which cells a source or a sink reaches ---------------------------------------------------------------

struct ReachedFromParent {
  CoarseLevel level;
  const Index* reached_above;
  Index* reached;

  THALWEG_PORTABLE void operator()(Index i) const {
    const Index parent = level.parent[i];
    reached[i] = parent == kNoNode ? (level.slack[i] > 0.0F ? 1U : 0U) : reached_above[parent];
  }
};

/// @return How many of a block's unknowns are reached.
struct CountReached {
  Bricks bricks;
  Parts parts;
  const Index* reached;

  THALWEG_PORTABLE double operator()(Index block) const {
    Index sum = 0;
    for (Index i = block * kCellsPerBlock; i < (block + 1) * kCellsPerBlock; ++i) {
      if (bricks.degree[i] == 0) continue;
      const Index node = parts.NodeOf(i);
      sum += node == kNoNode ? (bricks.given[i] > 0 ? 1U : 0U) : reached[node];
    }
    return static_cast<double>(sum);
  }
};

}  // namespace thalweg::explorer::field::device
