// Source of the inner loops. Each file that includes it defines THALWEG_STEREO_ISA and compiles them for that
// instruction set, using the compiler's vector types. Nothing from the standard library that generates code
// may be used here: the linker could choose this file's version of it for the whole program.
#include <cstddef>

#include "services/stereo/core/kernels.h"

namespace thalweg::stereo::THALWEG_STEREO_ISA {
namespace {

#define THALWEG_INLINE inline __attribute__((always_inline))

using std::ptrdiff_t;
using std::uint16_t;
using std::uint64_t;
using std::uint8_t;
using Bytes = uint8_t __attribute__((vector_size(32)));
using HalfBytes = uint8_t __attribute__((vector_size(16)));
using Words = uint16_t __attribute__((vector_size(32)));
static_assert(sizeof(Bytes) == kLanes);

template <class V, class T>
THALWEG_INLINE V Load(const T* p) {
  V v;
  __builtin_memcpy(&v, p, sizeof(V));
  return v;
}
template <class V, class T>
THALWEG_INLINE void Store(T* p, const V& v) {
  __builtin_memcpy(p, &v, sizeof(V));
}
THALWEG_INLINE Bytes AllBytes(uint8_t value) {
  return value - Bytes{};
}
THALWEG_INLINE Words AllWords(uint16_t value) {
  return value - Words{};
}
template <class V>
THALWEG_INLINE V Min(const V& a, const V& b) {
  return a < b ? a : b;
}
template <class V>
THALWEG_INLINE V Max(const V& a, const V& b) {
  return a > b ? a : b;
}
/// Widens the first or the last 16 of 32 bytes.
template <int kHalf>
THALWEG_INLINE Words Widen(const Bytes& v) {
  HalfBytes half;
  __builtin_memcpy(&half, reinterpret_cast<const uint8_t*>(&v) + 16 * kHalf, 16);
  return __builtin_convertvector(half, Words);
}
THALWEG_INLINE uint16_t LeastOf(const Words& v) {
  using Eight = uint16_t __attribute__((vector_size(16)));
  Eight m = Min(__builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7),
                __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15));
  m = Min(m, __builtin_shufflevector(m, m, 4, 5, 6, 7, 4, 5, 6, 7));
  m = Min(m, __builtin_shufflevector(m, m, 2, 3, 2, 3, 2, 3, 2, 3));
  m = Min(m, __builtin_shufflevector(m, m, 1, 1, 1, 1, 1, 1, 1, 1));
  return m[0];
}
THALWEG_INLINE uint8_t LeastOf(const Bytes& v) {
  HalfBytes m =
      Min(__builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
          __builtin_shufflevector(v, v, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31));
  m = Min(m, __builtin_shufflevector(m, m, 8, 9, 10, 11, 12, 13, 14, 15, 8, 9, 10, 11, 12, 13, 14, 15));
  m = Min(m, __builtin_shufflevector(m, m, 4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7));
  m = Min(m, __builtin_shufflevector(m, m, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3));
  m = Min(m, __builtin_shufflevector(m, m, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1));
  return m[0];
}
THALWEG_INLINE Bytes Differences(uint8_t left, const uint8_t* right, const Bytes& cut) {
  const Bytes l = AllBytes(left);
  const Bytes r = Load<Bytes>(right);
  return Min(Max(l, r) - Min(l, r), cut);
}

void AddDifferences(const uint8_t* left_in, const uint8_t* right_in, const uint8_t* left_out,
                    const uint8_t* right_out, int columns, int stride, uint8_t cut, uint16_t* sums) {
  const Bytes cuts = AllBytes(cut);
  for (ptrdiff_t c = 0; c < columns; ++c) {
    for (ptrdiff_t d = 0; d < stride; d += kLanes) {
      uint16_t* const to = sums + c * stride + d;
      const Bytes in = Differences(left_in[c], right_in + d - c, cuts);
      Words low = Load<Words>(to) + Widen<0>(in);
      Words high = Load<Words>(to + 16) + Widen<1>(in);
      if (left_out != nullptr) {
        const Bytes out = Differences(left_out[c], right_out + d - c, cuts);
        low -= Widen<0>(out);
        high -= Widen<1>(out);
      }
      Store(to, low);
      Store(to + 16, high);
    }
  }
}

void SumWindows(const uint16_t* sums, int columns, int window, int stride, uint16_t* windows) {
  for (ptrdiff_t d = 0; d < stride; d += 16) {
    Words sum{};
    for (ptrdiff_t c = 0; c < window; ++c) sum += Load<Words>(sums + c * stride + d);
    Store(windows + d, sum);
  }
  for (ptrdiff_t c = 1; c < columns; ++c) {
    const uint16_t* const out = sums + (c - 1) * stride;
    const uint16_t* const in = sums + (c + window - 1) * stride;
    uint16_t* const to = windows + c * stride;
    for (ptrdiff_t d = 0; d < stride; d += 16) {
      Store(to + d, Load<Words>(to - stride + d) + Load<Words>(in + d) - Load<Words>(out + d));
    }
  }
}

void AddSupports(const uint16_t* above, const uint16_t* here, const uint16_t* below, int columns, int radius,
                 int stride, uint16_t* scores) {
  const ptrdiff_t middle = ptrdiff_t{radius} * stride;
  const ptrdiff_t count = ptrdiff_t{columns} * stride;
  for (ptrdiff_t i = 0; i < count; i += 16) {
    const Words a = Load<Words>(above + i);
    const Words b = Load<Words>(above + i + 2 * middle);
    const Words c = Load<Words>(below + i);
    const Words d = Load<Words>(below + i + 2 * middle);
    const Words best_two = Min(Min(a + b, c + d), Words(Min(a, b) + Min(c, d)));
    Store(scores + i, Load<Words>(here + i + middle) + best_two);
  }
}

void Choose(uint16_t* costs, int columns, int candidates, int stride, Choice* choices,
            const RightBest& right) {
  const Words first_lanes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  for (ptrdiff_t i = 0; i < columns + stride; ++i) right.cost[i] = kNever;
  for (ptrdiff_t c = 0; c < columns; ++c) {
    uint16_t* const cost = costs + c * stride;
    for (ptrdiff_t d = c + 1 < candidates ? c + 1 : candidates; d < stride; ++d) cost[d] = kNever;
    uint16_t* const right_cost = right.cost + (columns - 1 - c);
    uint16_t* const right_d = right.d + (columns - 1 - c);
    Words least = AllWords(kNever);
    Words least_d{};
    Words lanes = first_lanes;
    for (ptrdiff_t d = 0; d < stride; d += 16, lanes += 16) {
      const Words here = Load<Words>(cost + d);
      const Words less = Words(here < least);
      least = less ? here : least;
      least_d = less ? lanes : least_d;
      const Words other = Load<Words>(right_cost + d);
      const Words wins = Words(here < other);
      Store(right_cost + d, Words(wins ? here : other));
      Store(right_d + d, Words(wins ? lanes : Load<Words>(right_d + d)));
    }
    const uint16_t best = LeastOf(least);
    const Words at_best = Words(least == AllWords(best));
    const uint16_t d = LeastOf(Words(at_best ? least_d : AllWords(kNever)));
    Choice& choice = choices[c];
    choice.d = d;
    choice.cost = best;
    choice.before = d > 0 ? cost[d - 1] : kNever;
    choice.after = d + 1 < stride ? cost[d + 1] : kNever;
    // The second best, with the costs of the best and its neighbors temporarily replaced.
    if (d > 0) cost[d - 1] = kNever;
    cost[d] = kNever;
    if (d + 1 < stride) cost[d + 1] = kNever;
    least = AllWords(kNever);
    for (ptrdiff_t k = 0; k < stride; k += 16) least = Min(least, Load<Words>(cost + k));
    choice.second = LeastOf(least);
    if (d > 0) cost[d - 1] = choice.before;
    cost[d] = best;
    if (d + 1 < stride) cost[d + 1] = choice.after;
  }
}

constexpr int kCensusReach = 4;  // columns to either side
constexpr int kCensusRows = 7;

void Census(const uint8_t* const* rows, int columns, uint64_t* bits) {
  for (ptrdiff_t c = 0; c < columns; c += kLanes) {
    const Bytes middle = Load<Bytes>(rows[kCensusRows / 2] + c);
    Bytes planes[8]{};
    int bit = 0;
    for (int row = 0; row < kCensusRows; ++row) {
      for (int shift = -kCensusReach; shift <= kCensusReach; ++shift) {
        if (row == kCensusRows / 2 && shift == 0) continue;
        const Bytes darker = Bytes(Load<Bytes>(rows[row] + c + shift) < middle);
        planes[bit / 8] |= darker & AllBytes(static_cast<uint8_t>(1 << (bit % 8)));
        ++bit;
      }
    }
    const ptrdiff_t count = columns - c < kLanes ? columns - c : kLanes;
    for (ptrdiff_t k = 0; k < count; ++k) {
      uint64_t word = 0;
      for (int plane = 0; plane < 8; ++plane) word |= uint64_t{planes[plane][k]} << (8 * plane);
      bits[c + k] = word;
    }
  }
}

void MatchCost(const uint64_t* left_census, const uint64_t* right_census, const uint8_t* left,
               const uint8_t* right, int columns, int stride, uint8_t census_weight, uint8_t cut,
               uint8_t* costs) {
  const Bytes cuts = AllBytes(cut);
  for (ptrdiff_t c = 0; c < columns; ++c) {
    const uint64_t own = left_census[c];
    const uint64_t* const others = right_census - c;
    uint8_t* const to = costs + c * stride;
    for (ptrdiff_t d = 0; d < stride; d += kLanes) {
      uint8_t bits[kLanes];
      for (int k = 0; k < kLanes; ++k) {
        bits[k] = static_cast<uint8_t>(__builtin_popcountll(own ^ others[d + k]));
      }
      const Bytes census = Bytes(Load<Bytes>(bits) * census_weight) >> 2;
      Store(to + d, Bytes(census + Differences(left[c], right + d - c, cuts)));
    }
  }
}

/// Advances a path by one column: cost plus the cheapest transition from the previous column, stored minus
/// the minimum. Adds the stored values to the sums.
template <int kVectors>
THALWEG_INLINE void Step(const uint8_t* cost, const uint8_t* from, uint8_t* to, uint8_t slope, uint8_t jump,
                         Words (&sums)[2 * kVectors]) {
  const Bytes jumps = AllBytes(jump);
  const Bytes slopes = AllBytes(slope);
  Bytes path[kVectors];
  Bytes least = AllBytes(255);
  for (int k = 0; k < kVectors; ++k) {
    const uint8_t* const p = from + kLanes + k * kLanes;
    const Bytes near = Min(Load<Bytes>(p - 1), Load<Bytes>(p + 1)) + slopes;
    path[k] = Load<Bytes>(cost + k * kLanes) + Min(Min(Load<Bytes>(p), near), jumps);
    least = Min(least, path[k]);
  }
  const Bytes leasts = AllBytes(LeastOf(least));
  for (int k = 0; k < kVectors; ++k) {
    const Bytes relative = path[k] - leasts;
    Store(to + kLanes + k * kLanes, relative);
    sums[2 * k] += Widen<0>(relative);
    sums[2 * k + 1] += Widen<1>(relative);
  }
}

/// A specialization for columns of `kVectors` vectors keeps their path costs in registers.
template <int kVectors>
void AggregateRow(const PathRow& row) {
  const ptrdiff_t stride = kVectors * kLanes;
  const ptrdiff_t path_stride = stride + 2 * kLanes;
  ptrdiff_t c = row.step > 0 ? 0 : row.width - 1;
  uint8_t* along_from = row.along;
  uint8_t* along_to = row.along + path_stride;
  for (int k = 0; k < row.width; ++k, c += row.step) {
    const uint8_t* const cost = row.cost + c * stride;
    Words sums[2 * kVectors];
    for (int i = 0; i < 2 * kVectors; ++i) {
      sums[i] = row.add ? Load<Words>(row.sum + c * stride + 16 * i) : Words{};
    }
    Step<kVectors>(cost, along_from, along_to, row.slope, row.jump[0][c], sums);
    for (int path = 0; path < 3; ++path) {
      const ptrdiff_t shift = (path - 1) * row.step;  // behind, straight, ahead
      Step<kVectors>(cost, row.before[path] + (c + 1 + shift) * path_stride,
                     row.here[path] + (c + 1) * path_stride, row.slope, row.jump[path + 1][c], sums);
    }
    for (int i = 0; i < 2 * kVectors; ++i) Store(row.sum + c * stride + 16 * i, sums[i]);
    uint8_t* const swap = along_from;
    along_from = along_to;
    along_to = swap;
  }
}

void Aggregate(const PathRow& row) {
  switch (row.stride / kLanes) {
    case 1:
      return AggregateRow<1>(row);
    case 2:
      return AggregateRow<2>(row);
    case 3:
      return AggregateRow<3>(row);
    case 4:
      return AggregateRow<4>(row);
    case 5:
      return AggregateRow<5>(row);
    case 6:
      return AggregateRow<6>(row);
    case 7:
      return AggregateRow<7>(row);
    default:
      return AggregateRow<8>(row);
  }
}

}  // namespace

extern const Kernels kKernels;
const Kernels kKernels{AddDifferences, SumWindows, AddSupports, Choose, Census, MatchCost, Aggregate};

#undef THALWEG_INLINE

}  // namespace thalweg::stereo::THALWEG_STEREO_ISA
