#pragma once

#include "services/explorer/core/field/device/portable.h"
#include "services/explorer/core/field/field_cell.h"
#include "services/explorer/core/field/multigrid_constants.h"

/// The finest level on the device. Only bricks of 4 x 4 x 4 cells that hold a free cell are stored, in the
/// order of a Z-curve over the grid, so memory and time follow the free space and not its box. A brick has 8
/// blocks of 2 x 2 x 2 cells, and a block's 8 cells lie side by side, which is 32 bytes of a vector of
/// floats:
///   cell = 8 * block + k,   block = 8 * brick + b,
/// with bits 0, 1, 2 of k and of b for x, y, z. Brick 0 is empty and stands for all that is not stored: its
/// cells are no unknowns, and every vector is 0 there, so that no sweep asks whether a neighbor exists.
namespace thalweg::explorer::field::device {

constexpr int kBrickEdge = 4;
constexpr Index kBlocksPerBrick = 8;
constexpr Index kCellsPerBlock = 8;

/// The codes of cells, which arrive as bytes.
constexpr auto kWallCell = static_cast<std::uint8_t>(FieldCell::kWall);
constexpr auto kFreeCell = static_cast<std::uint8_t>(FieldCell::kFree);
constexpr auto kSourceCell = static_cast<std::uint8_t>(FieldCell::kSource);
constexpr auto kSinkCell = static_cast<std::uint8_t>(FieldCell::kSink);

/// The grid of cells, x fastest, and the order of its bricks.
struct GridShape {
  int size[3];  ///< [cells]
  int bricks[3];
  int bits[3];  ///< How many a brick's number along each axis has.

  THALWEG_PORTABLE int CodeBits() const { return bits[0] + bits[1] + bits[2]; }
  THALWEG_PORTABLE Index Cell(int x, int y, int z) const {
    return (static_cast<Index>(z) * static_cast<Index>(size[1]) + static_cast<Index>(y)) *
               static_cast<Index>(size[0]) +
           static_cast<Index>(x);
  }
  THALWEG_PORTABLE bool Contains(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2];
  }
  THALWEG_PORTABLE bool ContainsBrick(const int at[3]) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < bricks[0] && at[1] < bricks[1] &&
           at[2] < bricks[2];
  }
  THALWEG_PORTABLE Index BrickInRows(int x, int y, int z) const {
    return (static_cast<Index>(z) * static_cast<Index>(bricks[1]) + static_cast<Index>(y)) *
               static_cast<Index>(bricks[0]) +
           static_cast<Index>(x);
  }
  /// Place along the Z-curve: the bits of the three numbers by turns, of those axes that still have any.
  THALWEG_PORTABLE Index CodeOf(const int at[3]) const {
    Index code = 0;
    int place = 0;
    for (int bit = 0; place < CodeBits(); ++bit) {
      for (int axis = 0; axis < 3; ++axis) {
        if (bit < bits[axis]) code |= (static_cast<Index>(at[axis]) >> bit & 1U) << place++;
      }
    }
    return code;
  }
  THALWEG_PORTABLE void BrickOf(Index code, int at[3]) const {
    at[0] = at[1] = at[2] = 0;
    int place = 0;
    for (int bit = 0; place < CodeBits(); ++bit) {
      for (int axis = 0; axis < 3; ++axis) {
        if (bit < bits[axis]) at[axis] |= static_cast<int>(code >> place++ & 1U) << bit;
      }
    }
  }
};

THALWEG_PORTABLE GridShape ShapeOf(int nx, int ny, int nz) {
  GridShape shape{{nx, ny, nz}, {}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    shape.bricks[axis] = (shape.size[axis] + kBrickEdge - 1) / kBrickEdge;
    while ((1 << shape.bits[axis]) < shape.bricks[axis]) ++shape.bits[axis];
  }
  return shape;
}

/// What the sweeps need to know of the stored cells.
struct Bricks {
  Index count;                 ///< Brick 0 among them.
  const Index* neighbor;       ///< [6 * brick + face], faces -x +x -y +y -z +z; 0 = none.
  const std::uint8_t* degree;  ///< By cell: the number of open faces; 0 = not an unknown.
  const std::uint8_t* given;   ///< By cell: how many of them lead to sources and sinks.
  float screening;             ///< k^2, a part of the diagonal.
  float step[7];               ///< kRelaxation / diagonal, by degree; 0 for degree 0.

  THALWEG_PORTABLE Index blocks() const { return count * kBlocksPerBrick; }
  THALWEG_PORTABLE Index cells() const { return blocks() * kCellsPerBlock; }
  THALWEG_PORTABLE float Diagonal(std::uint8_t of_degree) const {
    return static_cast<float>(of_degree) + screening;
  }
  THALWEG_PORTABLE Index NeighborBlock(Index block, int face) const {
    const Index b = block % kBlocksPerBrick;
    const Index bit = 1U << (face / 2);
    const bool inside = ((b & bit) != 0) != (face % 2 == 1);
    const Index brick = block / kBlocksPerBrick;
    return (inside ? brick : neighbor[6 * brick + static_cast<Index>(face)]) * kBlocksPerBrick + (b ^ bit);
  }
};

/// around[k] = the sum of value over the six neighbors of a block's k-th cell.
/// @param own    The values of the block's cells.
/// @param value  value(block, out[8]) for any block.
template <class Number, class Value>
THALWEG_PORTABLE void SumAround(const Bricks& bricks, Index block, const Number own[8], const Value& value,
                                Number around[8]) {
  for (Index k = 0; k < kCellsPerBlock; ++k) around[k] = own[k ^ 1] + own[k ^ 2] + own[k ^ 4];
  for (int axis = 0; axis < 3; ++axis) {
    const Index bit = 1U << axis;
    for (int side = 0; side < 2; ++side) {
      Number other[8];
      value(bricks.NeighborBlock(block, 2 * axis + side), other);
      for (Index k = 0; k < kCellsPerBlock; ++k) {
        if (((k & bit) != 0) == (side == 1)) around[k] += other[k ^ bit];
      }
    }
  }
}

/// The connected parts of each block, which are the nodes of the first coarse level.
struct Parts {
  const Index* first;  ///< By block: the number of its first node.
  const Index* part;   ///< By block: for the k-th cell, bits 3k to 3k + 2 hold its part, or kNoPart.

  static constexpr Index kNoPart = 7;
  static THALWEG_PORTABLE Index Unpack(Index packed, Index k) { return packed >> (3 * k) & 7U; }
  /// kNoNode for cells that are no unknowns or have no neighbors that are.
  THALWEG_PORTABLE Index NodeOf(Index cell) const {
    const Index p = Unpack(part[cell / kCellsPerBlock], cell % kCellsPerBlock);
    return p == kNoPart ? kNoNode : first[cell / kCellsPerBlock] + p;
  }
};

// ---- Set-up -----------------------------------------------------------------------------------------------

/// flag[code] = 1 for each brick of the grid that holds a free cell.
struct FlagBricks {
  GridShape shape;
  const std::uint8_t* cells;
  Index* flag;

  THALWEG_PORTABLE void operator()(Index code) const {
    int at[3];
    shape.BrickOf(code, at);
    Index any = 0;
    if (shape.ContainsBrick(at)) {
      const int x_end = kBrickEdge * at[0] + kBrickEdge;
      for (int z = kBrickEdge * at[2]; z < kBrickEdge * at[2] + kBrickEdge && z < shape.size[2]; ++z) {
        for (int y = kBrickEdge * at[1]; y < kBrickEdge * at[1] + kBrickEdge && y < shape.size[1]; ++y) {
          const std::uint8_t* row = cells + shape.Cell(0, y, z);
          for (int x = kBrickEdge * at[0]; x < x_end && x < shape.size[0]; ++x) {
            any |= row[x] == kFreeCell ? 1U : 0U;
          }
        }
      }
    }
    flag[code] = any;
  }
};

/// Numbers the stored bricks. @param before  How many are flagged before each code.
struct NumberBricks {
  GridShape shape;
  const Index* flag;
  const Index* before;
  Index* code_of;  ///< By brick.
  Index* in_rows;  ///< By place in the grid of bricks, x fastest: the brick, or 0.

  THALWEG_PORTABLE void operator()(Index code) const {
    int at[3];
    shape.BrickOf(code, at);
    if (!shape.ContainsBrick(at)) return;
    const Index brick = flag[code] != 0 ? before[code] + 1 : 0;
    in_rows[shape.BrickInRows(at[0], at[1], at[2])] = brick;
    if (brick != 0) code_of[brick] = code;
  }
};

struct JoinBricks {
  GridShape shape;
  const Index* code_of;
  const Index* in_rows;
  Index* neighbor;

  THALWEG_PORTABLE void operator()(Index brick) const {
    int at[3] = {0, 0, 0};
    if (brick != 0) shape.BrickOf(code_of[brick], at);
    for (int face = 0; face < 6; ++face) {
      Index other = 0;
      if (brick != 0) {
        int next[3] = {at[0], at[1], at[2]};
        next[face / 2] += face % 2 == 1 ? 1 : -1;
        if (shape.ContainsBrick(next)) other = in_rows[shape.BrickInRows(next[0], next[1], next[2])];
      }
      neighbor[6 * brick + static_cast<Index>(face)] = other;
    }
  }
};

/// Counts the faces of a block's cells, sums the given values beyond them, and clears the solution.
struct ReadCells {
  GridShape shape;
  const std::uint8_t* codes;
  const Index* code_of;
  float weak_sink;  ///< phi of weak sinks.
  std::uint8_t* degree;
  std::uint8_t* given;
  float* right;  ///< b: the sum of given phi over the faces.
  float* high;
  float* low;
  float* direction;

  THALWEG_PORTABLE void operator()(Index block) const {
    const Index brick = block / kBlocksPerBrick;
    const Index b = block % kBlocksPerBrick;
    int at[3] = {0, 0, 0};
    if (brick != 0) shape.BrickOf(code_of[brick], at);
    for (Index k = 0; k < kCellsPerBlock; ++k) {
      const Index cell = block * kCellsPerBlock + k;
      int faces = 0;
      int to_given = 0;
      float sum = 0.0F;
      int place[3];
      for (int axis = 0; axis < 3; ++axis) {
        place[axis] =
            kBrickEdge * at[axis] + 2 * static_cast<int>(b >> axis & 1U) + static_cast<int>(k >> axis & 1U);
      }
      if (brick != 0 && CodeAt(place[0], place[1], place[2]) == kFreeCell) {
        for (int face = 0; face < 6; ++face) {
          int next[3] = {place[0], place[1], place[2]};
          next[face / 2] += face % 2 == 1 ? 1 : -1;
          const std::uint8_t code = CodeAt(next[0], next[1], next[2]);
          if (code == kWallCell) continue;
          ++faces;
          if (code == kFreeCell) continue;
          ++to_given;
          sum += code == kSourceCell ? 1.0F : code == kSinkCell ? -1.0F : weak_sink;
        }
      }
      degree[cell] = static_cast<std::uint8_t>(faces);
      given[cell] = static_cast<std::uint8_t>(to_given);
      right[cell] = sum;
      high[cell] = low[cell] = direction[cell] = 0.0F;
    }
  }

 private:
  THALWEG_PORTABLE std::uint8_t CodeAt(int x, int y, int z) const {
    return shape.Contains(x, y, z) ? codes[shape.Cell(x, y, z)] : kWallCell;
  }
};

/// Finds the connected parts of each block. A part of a single cell counts only if it has a neighbor among
/// the unknowns: without one, the smoother alone is enough.
struct FindParts {
  Bricks bricks;
  Index* part;
  Index* count;

  THALWEG_PORTABLE void operator()(Index block) const {
    const Index cell = block * kCellsPerBlock;
    unsigned left = 0;
    for (Index k = 0; k < kCellsPerBlock; ++k) left |= (bricks.degree[cell + k] != 0 ? 1U : 0U) << k;
    Index parts = 0;
    Index packed = 0xFFFFFFU;
    while (left != 0) {
      unsigned seen = left & (~left + 1U);
      for (int round = 0; round < 4; ++round) {  // no two cells are farther apart
        const unsigned along_x = (seen & 0x55U) << 1 | (seen & 0xAAU) >> 1;
        seen |= along_x & left;
        const unsigned along_y = (seen & 0x33U) << 2 | (seen & 0xCCU) >> 2;
        seen |= along_y & left;
        const unsigned along_z = (seen & 0x0FU) << 4 | (seen & 0xF0U) >> 4;
        seen |= along_z & left;
      }
      left &= ~seen;
      const bool single = (seen & (seen - 1U)) == 0;
      bool node = !single;
      for (Index k = 0; k < kCellsPerBlock && !node; ++k) {
        node = (seen >> k & 1U) != 0 && bricks.degree[cell + k] > bricks.given[cell + k];
      }
      if (!node) continue;
      for (Index k = 0; k < kCellsPerBlock; ++k) {
        if ((seen >> k & 1U) != 0) packed = (packed & ~(7U << (3 * k))) | parts << (3 * k);
      }
      ++parts;
    }
    part[block] = packed;
    count[block] = parts;
  }
};

// ---- The conjugate gradients ------------------------------------------------------------------------------

/// Sums and step lengths, which stay on the device.
struct Scalars {
  double r_r = 0.0;
  double r_z = 0.0;
  double p_q = 0.0;
  float alpha = 0.0F;
  float beta = 0.0F;
};

struct StoreSquare {
  THALWEG_PORTABLE void operator()(Scalars& s, double sum) const { s.r_r = sum; }
};
struct StoreStep {
  THALWEG_PORTABLE void operator()(Scalars& s, double sum) const {
    s.p_q = sum;
    s.alpha = sum > 0.0 ? static_cast<float>(s.r_z / sum) : 0.0F;
  }
};
struct StoreTurn {
  bool first;
  THALWEG_PORTABLE void operator()(Scalars& s, double sum) const {
    s.beta = first ? 0.0F : static_cast<float>(sum / s.r_z);
    s.r_z = sum;
  }
};
struct ForgetStep {
  Scalars* scalars;
  THALWEG_PORTABLE void operator()(Index) const { scalars->alpha = 0.0F; }
};

/// p_new = z + beta p; q = A p_new. @return p_new . q
struct Direct {
  Bricks bricks;
  const Scalars* scalars;
  const float *z, *p;
  float *p_new, *q;

  THALWEG_PORTABLE double operator()(Index block) const {
    const float beta = scalars->beta;
    const auto value = [this, beta](Index of, float out[8]) {
      float direction[8];
      LoadEight(z + of * kCellsPerBlock, out);
      LoadEight(p + of * kCellsPerBlock, direction);
      for (Index k = 0; k < kCellsPerBlock; ++k) out[k] += beta * direction[k];
    };
    float own[8];
    float around[8];
    std::uint8_t degree[8];
    value(block, own);
    SumAround(bricks, block, own, value, around);
    LoadEight(bricks.degree + block * kCellsPerBlock, degree);
    double sum = 0.0;
    for (Index k = 0; k < kCellsPerBlock; ++k) {
      around[k] = degree[k] != 0 ? bricks.Diagonal(degree[k]) * own[k] - around[k] : 0.0F;
      sum += static_cast<double>(own[k]) * static_cast<double>(around[k]);
    }
    StoreEight(own, p_new + block * kCellsPerBlock);
    StoreEight(around, q + block * kCellsPerBlock);
    return sum;
  }
};

/// x += alpha p; r_new = r - alpha q; coarse r = P^T (r_new - A w D^-1 r_new) / 2. @return r_new . r_new
struct Advance {
  Bricks bricks;
  Parts parts;
  const Scalars* scalars;
  const float *p, *q, *r;
  float *x, *r_new, *coarse;

  THALWEG_PORTABLE double operator()(Index block) const {
    const float alpha = scalars->alpha;
    const Index cell = block * kCellsPerBlock;
    const auto residual_of = [this, alpha](Index of, float out[8]) {
      float step[8];
      LoadEight(r + of * kCellsPerBlock, out);
      LoadEight(q + of * kCellsPerBlock, step);
      for (Index k = 0; k < kCellsPerBlock; ++k) out[k] -= alpha * step[k];
    };
    const auto smoothed = [this, &residual_of](Index of, float out[8]) {
      std::uint8_t degree[8];
      residual_of(of, out);
      LoadEight(bricks.degree + of * kCellsPerBlock, degree);
      for (Index k = 0; k < kCellsPerBlock; ++k) out[k] *= bricks.step[degree[k]];
    };
    float residual[8];
    float own[8];
    float around[8];
    residual_of(block, residual);
    smoothed(block, own);
    SumAround(bricks, block, own, smoothed, around);
    StoreEight(residual, r_new + cell);
    float solution[8];
    float direction[8];
    LoadEight(x + cell, solution);
    LoadEight(p + cell, direction);
    double sum = 0.0;
    for (Index k = 0; k < kCellsPerBlock; ++k) {
      solution[k] += alpha * direction[k];
      sum += static_cast<double>(residual[k]) * static_cast<double>(residual[k]);
    }
    StoreEight(solution, x + cell);
    const Index packed = parts.part[block];
    float restricted[4] = {0.0F, 0.0F, 0.0F, 0.0F};
    Index count = 0;
    for (Index k = 0; k < kCellsPerBlock; ++k) {
      const Index part = Parts::Unpack(packed, k);
      if (part == Parts::kNoPart) continue;
      const float left = (1.0F - kRelaxation) * residual[k] + around[k];
      for (Index n = 0; n < 4; ++n) restricted[n] += n == part ? left : 0.0F;
      count = part + 1 > count ? part + 1 : count;
    }
    const Index first = parts.first[block];
    for (Index n = 0; n < 4; ++n) {
      if (n < count) coarse[first + n] = 0.5F * restricted[n];
    }
    return sum;
  }
};

/// z = w D^-1 r + P coarse; out = z + w D^-1 (r - A z). @return r . out
struct Precondition {
  Bricks bricks;
  Parts parts;
  const float *r, *coarse;
  float* out;

  THALWEG_PORTABLE double operator()(Index block) const {
    const auto value = [this](Index of, float result[8]) {
      std::uint8_t degree[8];
      LoadEight(r + of * kCellsPerBlock, result);
      LoadEight(bricks.degree + of * kCellsPerBlock, degree);
      const Index packed = parts.part[of];
      const Index first = parts.first[of];
      for (Index k = 0; k < kCellsPerBlock; ++k) {
        const Index part = Parts::Unpack(packed, k);
        result[k] =
            bricks.step[degree[k]] * result[k] + (part == Parts::kNoPart ? 0.0F : coarse[first + part]);
      }
    };
    float own[8];
    float around[8];
    float right[8];
    std::uint8_t degree[8];
    value(block, own);
    SumAround(bricks, block, own, value, around);
    LoadEight(r + block * kCellsPerBlock, right);
    LoadEight(bricks.degree + block * kCellsPerBlock, degree);
    double sum = 0.0;
    for (Index k = 0; k < kCellsPerBlock; ++k) {
      own[k] = (1.0F - kRelaxation) * own[k] + bricks.step[degree[k]] * (right[k] + around[k]);
      sum += static_cast<double>(right[k]) * static_cast<double>(own[k]);
    }
    StoreEight(own, out + block * kCellsPerBlock);
    return sum;
  }
};

/// high += low; low = 0
struct Fold {
  float *high, *low;

  THALWEG_PORTABLE void operator()(Index cell) const {
    high[cell] += low[cell];
    low[cell] = 0.0F;
  }
};

/// r = b - A (high + low) in double precision. @return r . r
struct TrueResidual {
  Bricks bricks;
  const float *right, *high, *low;
  float* r;

  THALWEG_PORTABLE double operator()(Index block) const {
    const Index cell = block * kCellsPerBlock;
    const auto value = [this](Index of, double out[8]) {
      float upper[8];
      float lower[8];
      LoadEight(high + of * kCellsPerBlock, upper);
      LoadEight(low + of * kCellsPerBlock, lower);
      for (Index k = 0; k < kCellsPerBlock; ++k) {
        out[k] = static_cast<double>(upper[k]) + static_cast<double>(lower[k]);
      }
    };
    double own[8];
    double around[8];
    value(block, own);
    SumAround(bricks, block, own, value, around);
    double sum = 0.0;
    for (Index k = 0; k < kCellsPerBlock; ++k) {
      const Index i = cell + k;
      const double diagonal = static_cast<double>(bricks.degree[i]) + static_cast<double>(bricks.screening);
      const double exact = static_cast<double>(right[i]) + around[k] - diagonal * own[k];
      const float rounded = bricks.degree[i] != 0 ? static_cast<float>(exact) : 0.0F;
      r[i] = rounded;
      sum += static_cast<double>(rounded) * static_cast<double>(rounded);
    }
    return sum;
  }
};

/// phi of every cell of the grid; `nothing` in walls.
struct WritePhi {
  GridShape shape;
  const std::uint8_t* codes;
  const Index* in_rows;
  const float *high, *low;
  float weak_sink;
  float nothing;
  float* phi;

  THALWEG_PORTABLE void operator()(Index index) const {
    const std::uint8_t code = codes[index];
    float value = nothing;
    if (code == kFreeCell) {
      const auto nx = static_cast<Index>(shape.size[0]);
      const auto ny = static_cast<Index>(shape.size[1]);
      const Index x = index % nx;
      const Index y = index / nx % ny;
      const Index z = index / nx / ny;
      const Index brick =
          in_rows[shape.BrickInRows(static_cast<int>(x / kBrickEdge), static_cast<int>(y / kBrickEdge),
                                    static_cast<int>(z / kBrickEdge))];
      const Index b = (x >> 1 & 1U) | (y >> 1 & 1U) << 1 | (z >> 1 & 1U) << 2;
      const Index k = (x & 1U) | (y & 1U) << 1 | (z & 1U) << 2;
      const Index cell = (brick * kBlocksPerBrick + b) * kCellsPerBlock + k;
      value = high[cell] + low[cell];
    } else if (code != kWallCell) {
      value = code == kSourceCell ? 1.0F : code == kSinkCell ? -1.0F : weak_sink;
    }
    phi[index] = value;
  }
};

}  // namespace thalweg::explorer::field::device
