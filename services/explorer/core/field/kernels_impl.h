// The sweeps, written once. Every file that includes this one compiles them for one instruction set, named by
// THALWEG_FIELD_ISA. They use the compiler's vector extensions, eight cells at a time, because the compiler
// does not vectorize them on its own. Do not use functions of the standard library here that are compiled out
// of line: the linker could pick their version for this instruction set for the rest of the program.
#include "services/explorer/core/field/kernels.h"

namespace thalweg::explorer::field::THALWEG_FIELD_ISA {
namespace {

#define THALWEG_INLINE inline __attribute__((always_inline))

using std::ptrdiff_t;
using Vec = float __attribute__((vector_size(32)));
using Double4 = double __attribute__((vector_size(32)));
using Half = float __attribute__((vector_size(16)));
using Int = int __attribute__((vector_size(32)));
static_assert(kChunk * sizeof(float) == sizeof(Vec));

template <class V = Vec, class T>
THALWEG_INLINE V Load(const T* p) {
  V v;
  __builtin_memcpy(&v, p, sizeof(V));
  return v;
}
template <class V>
THALWEG_INLINE void Store(float* p, const V& v) {
  __builtin_memcpy(p, &v, sizeof(V));
}
THALWEG_INLINE float Sum(const Vec& v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

/// The elements of a table that eight indices name, by the lowest three bits of each.
THALWEG_INLINE Vec Pick(const Vec& table, const Int& indices) {
#ifdef __clang__  // which only shuffles by constants
  Vec picked;
  for (int k = 0; k < 8; ++k) picked[k] = table[indices[k] & 7];
  return picked;
#else
  return __builtin_shuffle(table, indices);
#endif
}

/// Degrees of eight cells. Only the lowest three bits of each are valid, which is all that a shuffle uses.
THALWEG_INLINE Int DegreesAt(const FineOperator& a, ptrdiff_t i) {
  const Int shifts = {0, 4, 8, 12, 16, 20, 24, 28};
  const auto word = static_cast<int>(a.degrees[i / 8]);
  const Int all = {word, word, word, word, word, word, word, word};
  return all >> shifts;
}

/// The operator's rows for eight cells.
struct FineRows {
  Int degrees;
  Vec diagonal;
  THALWEG_INLINE Int Active() const { return diagonal > 0.0F; }
};
THALWEG_INLINE FineRows RowsAt(const FineOperator& a, ptrdiff_t i) {
  const Int degrees = DegreesAt(a, i);
  return {degrees, Pick(Load(a.diagonal), degrees)};
}
THALWEG_INLINE Vec Step(const FineOperator& a, const FineRows& rows) {
  return Pick(Load(a.step), rows.degrees);
}

struct CoarseRows {
  Vec diagonal;
  THALWEG_INLINE Int Active() const { return diagonal > 0.0F; }
};
THALWEG_INLINE CoarseRows RowsAt(const CoarseOperator& a, ptrdiff_t i) {
  return {Load(a.diagonal + i)};
}
THALWEG_INLINE Vec Step(const CoarseOperator&, const CoarseRows& rows) {
  const Vec none{};
  return rows.Active() ? kRelaxation / rows.diagonal : none;
}

/// Sum over the open faces of weight times the neighbor's value.
THALWEG_INLINE Vec Neighbors(const FineOperator& a, const Planes& v, ptrdiff_t i) {
  return (Load(v.here + i - 1) + Load(v.here + i + 1)) +
         (Load(v.here + i - a.stride_y) + Load(v.here + i + a.stride_y)) +
         (Load(v.below + i - a.stride_z) + Load(v.above + i + a.stride_z));
}
THALWEG_INLINE Vec Neighbors(const CoarseOperator& a, const Planes& v, ptrdiff_t i) {
  const ptrdiff_t y = a.stride_y;
  const ptrdiff_t z = a.stride_z;
  return (Load(a.weight_x + i) * Load(v.here + i + 1) + Load(a.weight_x + i - 1) * Load(v.here + i - 1)) +
         (Load(a.weight_y + i) * Load(v.here + i + y) + Load(a.weight_y + i - y) * Load(v.here + i - y)) +
         (Load(a.weight_z + i) * Load(v.above + i + z) + Load(a.weight_z + i - z) * Load(v.below + i - z));
}

/// Calls cells(i) for every eight cells.
template <class Cells>
THALWEG_INLINE void Sweep(const Segment* first, const Segment* last, Cells&& cells) {
  for (const Segment* s = first; s != last; ++s) {
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
    for (auto i = static_cast<ptrdiff_t>(s->begin); i < end; i += static_cast<ptrdiff_t>(kChunk)) cells(i);
  }
}
/// As Sweep; returns the sum of what cells(i) returns, in single precision per segment and in double over
/// all.
template <class Cells>
THALWEG_INLINE double SweepSum(const Segment* first, const Segment* last, Cells&& cells) {
  double total = 0.0;
  for (const Segment* s = first; s != last; ++s) {
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
    Vec sum{};
    for (auto i = static_cast<ptrdiff_t>(s->begin); i < end; i += static_cast<ptrdiff_t>(kChunk)) {
      sum += cells(i);
    }
    total += static_cast<double>(Sum(sum));
  }
  return total;
}
#define THALWEG_CELLS [&](ptrdiff_t i) __attribute__((always_inline))

/// r - A z; 0 in cells that are not unknowns.
template <class Operator>
THALWEG_INLINE Vec ResidualAt(const Operator& a, const float* r, const Planes& z, ptrdiff_t i) {
  const auto rows = RowsAt(a, i);
  const Vec residual = Load(r + i) - rows.diagonal * Load(z.here + i) + Neighbors(a, z, i);
  const Vec none{};
  return rows.Active() ? residual : none;
}

template <class Operator>
void Start(const Operator& a, const Segment* first, const Segment* last, const float* r, float* z) {
  Sweep(
      first, last, THALWEG_CELLS { Store(z + i, Step(a, RowsAt(a, i)) * Load(r + i)); });
}

void Subtract(const CoarseOperator& a, const Segment* first, const Segment* last, const float* z, float* r) {
  const Planes planes{z, z, z};
  Sweep(
      first, last, THALWEG_CELLS { Store(r + i, ResidualAt(a, r, planes, i)); });
}

template <class Operator>
void RestrictResidual(const Operator& a, const Segment* first, const Segment* last, const float* r,
                      const Planes& z, float* coarse) {
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    float* out = coarse + s->coarse;
    for (ptrdiff_t k = 0; k < static_cast<ptrdiff_t>(s->length); k += 8, out += 4) {
      const Vec v = ResidualAt(a, r, z, begin + k);
      const Half even = __builtin_shufflevector(v, v, 0, 2, 4, 6);
      const Half odd = __builtin_shufflevector(v, v, 1, 3, 5, 7);
      Store(out, Load<Half>(out) + 0.5F * (even + odd));
    }
  }
}

void Correct(const CoarseOperator& a, const Segment* first, const Segment* last, const float* coarse,
             float* z) {
  const Vec none{};
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const float* in = coarse + s->coarse;
    for (ptrdiff_t k = 0; k < static_cast<ptrdiff_t>(s->length); k += 8, in += 4) {
      const Half c = Load<Half>(in);
      const Vec pairs = __builtin_shufflevector(c, c, 0, 0, 1, 1, 2, 2, 3, 3);
      Store(z + begin + k, Load(z + begin + k) + (RowsAt(a, begin + k).Active() ? pairs : none));
    }
  }
}

/// z + w D^-1 (r - A z)
template <class Operator>
THALWEG_INLINE Vec FinishedAt(const Operator& a, const Vec& right, const Planes& z, ptrdiff_t i) {
  // In cells that are not unknowns, z and the step are 0.
  return (1.0F - kRelaxation) * Load(z.here + i) + Step(a, RowsAt(a, i)) * (right + Neighbors(a, z, i));
}

template <class Operator>
double Finish(const Operator& a, const Segment* first, const Segment* last, const float* r, const Planes& z,
              float* out) {
  return SweepSum(
      first, last, THALWEG_CELLS {
        const Vec right = Load(r + i);
        const Vec value = FinishedAt(a, right, z, i);
        Store(out + i, value);
        return value * right;
      });
}

template <class Operator>
void FinishOnto(const Operator& a, const Segment* first, const Segment* last, const float* r, const Planes& z,
                float* out) {
  Sweep(
      first, last, THALWEG_CELLS { Store(out + i, Load(out + i) + FinishedAt(a, Load(r + i), z, i)); });
}

void Direction(const Segment* first, const Segment* last, float alpha, float beta, const float* z, float* x,
               float* p) {
  Sweep(
      first, last, THALWEG_CELLS {
        const Vec before = Load(p + i);
        Store(x + i, Load(x + i) + alpha * before);
        Store(p + i, Load(z + i) + beta * before);
      });
}

double Apply(const FineOperator& a, const Segment* first, const Segment* last, const float* p, float* q) {
  const Planes planes{p, p, p};
  const Vec none{};
  return SweepSum(
      first, last, THALWEG_CELLS {
        const FineRows rows = RowsAt(a, i);
        const Vec here = Load(p + i);
        const Vec full = rows.diagonal * here - Neighbors(a, planes, i);
        const Vec value = rows.Active() ? full : none;
        Store(q + i, value);
        return value * here;
      });
}

double Descend(const Segment* first, const Segment* last, float alpha, const float* q, float* r) {
  return SweepSum(
      first, last, THALWEG_CELLS {
        const Vec residual = Load(r + i) - alpha * Load(q + i);
        Store(r + i, residual);
        return residual * residual;
      });
}

double Advance(const FineOperator& a, const Segment* first, const Segment* last, float alpha, const float* q,
               float* r, float* z) {
  return SweepSum(
      first, last, THALWEG_CELLS {
        const Vec residual = Load(r + i) - alpha * Load(q + i);
        Store(r + i, residual);
        Store(z + i, Step(a, RowsAt(a, i)) * residual);
        return residual * residual;
      });
}

void StartCorrected(const FineOperator& a, const Segment* first, const Segment* last, const float* coarse,
                    const float* r, float* z) {
  const Vec none{};
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const float* in = coarse + s->coarse;
    for (ptrdiff_t k = 0; k < static_cast<ptrdiff_t>(s->length); k += 8, in += 4) {
      const Half c = Load<Half>(in);
      const Vec pairs = __builtin_shufflevector(c, c, 0, 0, 1, 1, 2, 2, 3, 3);
      const FineRows rows = RowsAt(a, begin + k);
      Store(z + begin + k, Step(a, rows) * Load(r + begin + k) + (rows.Active() ? pairs : none));
    }
  }
}

template <bool kWithLow>
double TrueResidualOf(const FineOperator& a, const Segment* first, const Segment* last, const float* high,
                      const float* low, float* r) {
  const auto at = [high](ptrdiff_t i) __attribute__((always_inline)) {
    return __builtin_convertvector(Load<Half>(high + i), Double4);
  };
  const Vec none{};
  const Planes low_planes{low, low, low};
  double total = 0.0;
  for (const Segment* s = first; s != last; ++s) {
    Double4 sum{};
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
    for (auto i = static_cast<ptrdiff_t>(s->begin); i < end; i += 8) {
      const FineRows rows = RowsAt(a, i);
      Half part[2];
      for (ptrdiff_t k = 0; k < 2; ++k) {
        const ptrdiff_t j = i + 4 * k;
        const Double4 around = (at(j - 1) + at(j + 1)) + (at(j - a.stride_y) + at(j + a.stride_y)) +
                               (at(j - a.stride_z) + at(j + a.stride_z));
        const Half diagonal = k == 0 ? __builtin_shufflevector(rows.diagonal, rows.diagonal, 0, 1, 2, 3)
                                     : __builtin_shufflevector(rows.diagonal, rows.diagonal, 4, 5, 6, 7);
        const Double4 full = around - __builtin_convertvector(diagonal, Double4) * at(j);
        part[k] = __builtin_convertvector(full, Half);
      }
      Vec full = __builtin_shufflevector(part[0], part[1], 0, 1, 2, 3, 4, 5, 6, 7);
      if constexpr (kWithLow) full += Neighbors(a, low_planes, i) - rows.diagonal * Load(low + i);
      const Vec value = rows.Active() ? full : none;
      Store(r + i, value);
      const Double4 low4 =
          __builtin_convertvector(__builtin_shufflevector(value, value, 0, 1, 2, 3), Double4);
      const Double4 high4 =
          __builtin_convertvector(__builtin_shufflevector(value, value, 4, 5, 6, 7), Double4);
      sum += low4 * low4 + high4 * high4;
    }
    total += (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
  return total;
}

double TrueResidual(const FineOperator& a, const Segment* first, const Segment* last, const float* high,
                    const float* low, float* r) {
  return low == nullptr ? TrueResidualOf<false>(a, first, last, high, low, r)
                        : TrueResidualOf<true>(a, first, last, high, low, r);
}

void Add(const Segment* first, const Segment* last, float factor, const float* term, float* sum) {
  Sweep(
      first, last, THALWEG_CELLS { Store(sum + i, Load(sum + i) + factor * Load(term + i)); });
}

template <class Operator>
constexpr Sweeps<Operator> kSweeps{RestrictResidual<Operator>, Finish<Operator>, FinishOnto<Operator>};

}  // namespace

extern const Kernels kKernels;
const Kernels kKernels{kSweeps<FineOperator>,
                       kSweeps<CoarseOperator>,
                       Start<CoarseOperator>,
                       Subtract,
                       Correct,
                       Direction,
                       Apply,
                       Descend,
                       Advance,
                       Start<FineOperator>,
                       StartCorrected,
                       TrueResidual,
                       Add};

#undef THALWEG_CELLS
#undef THALWEG_INLINE

}  // namespace thalweg::explorer::field::THALWEG_FIELD_ISA
