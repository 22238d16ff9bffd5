// The sweeps, once; every file that includes this compiles them for one instruction set and says so in
// THALWEG_FIELD_ISA. Nothing of the standard library with code of its own may be used here: the linker could
// take it for the rest of the program.
#include "services/explorer/core/field/kernels.h"

namespace thalweg::explorer::field::THALWEG_FIELD_ISA {
namespace {

#define THALWEG_INLINE inline __attribute__((always_inline))

using std::ptrdiff_t;

THALWEG_INLINE float Diagonal(const FineOperator& a, ptrdiff_t i) {
  const auto degree = static_cast<float>(a.degree[i]);
  return degree > 0.0F ? degree + a.screening : 0.0F;
}
THALWEG_INLINE float Diagonal(const CoarseOperator& a, ptrdiff_t i) {
  return a.diagonal[i];
}

/// Sum over the open faces of weight times the neighbour's value.
THALWEG_INLINE float Neighbours(const FineOperator& a, const float* v, ptrdiff_t i) {
  return (v[i - 1] + v[i + 1]) + (v[i - a.stride_y] + v[i + a.stride_y]) +
         (v[i - a.stride_z] + v[i + a.stride_z]);
}
THALWEG_INLINE float Neighbours(const CoarseOperator& a, const float* v, ptrdiff_t i) {
  return (a.weight_x[i] * v[i + 1] + a.weight_x[i - 1] * v[i - 1]) +
         (a.weight_y[i] * v[i + a.stride_y] + a.weight_y[i - a.stride_y] * v[i - a.stride_y]) +
         (a.weight_z[i] * v[i + a.stride_z] + a.weight_z[i - a.stride_z] * v[i - a.stride_z]);
}

/// r - A z, 0 where there is no unknown.
template <class Operator>
THALWEG_INLINE float ResidualAt(const Operator& a, const float* __restrict r, const float* __restrict z,
                                ptrdiff_t i) {
  const float d = Diagonal(a, i);
  const float residual = r[i] - d * z[i] + Neighbours(a, z, i);
  return d > 0.0F ? residual : 0.0F;
}

template <class Operator>
void Start(const Operator& a, const Segment* first, const Segment* last, const float* __restrict r,
           float* __restrict z) {
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
#pragma omp simd
    for (ptrdiff_t i = begin; i < end; ++i) {
      const float d = Diagonal(a, i);
      z[i] = d > 0.0F ? kRelaxation * r[i] / d : 0.0F;
    }
  }
}

template <class Operator>
void Subtract(const Operator& a, const Segment* first, const Segment* last, const float* __restrict z,
              float* __restrict r) {
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
#pragma omp simd
    for (ptrdiff_t i = begin; i < end; ++i) r[i] = ResidualAt(a, r, z, i);
  }
}

template <class Operator>
void RestrictResidual(const Operator& a, const Segment* first, const Segment* last, const float* __restrict r,
                      const float* __restrict z, float* __restrict coarse) {
  constexpr ptrdiff_t kBatch = 256;
  alignas(64) float residual[kBatch];
  for (const Segment* s = first; s != last; ++s) {
    const auto length = static_cast<ptrdiff_t>(s->length);
    for (ptrdiff_t done = 0; done < length; done += kBatch) {
      const ptrdiff_t count = length - done < kBatch ? length - done : kBatch;
      const ptrdiff_t begin = static_cast<ptrdiff_t>(s->begin) + done;
#pragma omp simd
      for (ptrdiff_t k = 0; k < count; ++k) residual[k] = ResidualAt(a, r, z, begin + k);
      float* __restrict out = coarse + s->coarse + done / 2;
#pragma omp simd
      for (ptrdiff_t k = 0; k < count / 2; ++k) {
        out[k] += 0.5F * (residual[2 * k] + residual[2 * k + 1]);
      }
    }
  }
}

template <class Operator>
void Correct(const Operator& a, const Segment* first, const Segment* last, const float* __restrict coarse,
             float* __restrict z) {
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const float* __restrict c = coarse + s->coarse;
#pragma omp simd
    for (ptrdiff_t k = 0; k < static_cast<ptrdiff_t>(s->length / 2); ++k) {
      const ptrdiff_t i = begin + 2 * k;
      z[i] += Diagonal(a, i) > 0.0F ? c[k] : 0.0F;
      z[i + 1] += Diagonal(a, i + 1) > 0.0F ? c[k] : 0.0F;
    }
  }
}

template <class Operator>
double Finish(const Operator& a, const Segment* first, const Segment* last, const float* __restrict r,
              const float* __restrict z, float* __restrict out) {
  double total = 0.0;
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
    float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
    for (ptrdiff_t i = begin; i < end; ++i) {
      const float d = Diagonal(a, i);
      const float step = kRelaxation * (r[i] + Neighbours(a, z, i)) / d;
      const float value = d > 0.0F ? (1.0F - kRelaxation) * z[i] + step : 0.0F;
      out[i] = value;
      sum += value * r[i];
    }
    total += static_cast<double>(sum);
  }
  return total;
}

void Direction(const Segment* first, const Segment* last, float beta, const float* __restrict z,
               float* __restrict p) {
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
#pragma omp simd
    for (ptrdiff_t i = begin; i < end; ++i) p[i] = z[i] + beta * p[i];
  }
}

double Apply(const FineOperator& a, const Segment* first, const Segment* last, const float* __restrict p,
             float* __restrict q) {
  double total = 0.0;
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
    float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
    for (ptrdiff_t i = begin; i < end; ++i) {
      const float d = Diagonal(a, i);
      const float full = d * p[i] - Neighbours(a, p, i);
      const float value = d > 0.0F ? full : 0.0F;
      q[i] = value;
      sum += value * p[i];
    }
    total += static_cast<double>(sum);
  }
  return total;
}

double Advance(const FineOperator& a, const Segment* first, const Segment* last, float alpha,
               const float* __restrict p, const float* __restrict q, float* __restrict x, float* __restrict r,
               float* __restrict z) {
  double total = 0.0;
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
    float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
    for (ptrdiff_t i = begin; i < end; ++i) {
      const float d = Diagonal(a, i);
      const float residual = r[i] - alpha * q[i];
      x[i] += alpha * p[i];
      r[i] = residual;
      z[i] = d > 0.0F ? kRelaxation * residual / d : 0.0F;
      sum += residual * residual;
    }
    total += static_cast<double>(sum);
  }
  return total;
}

double TrueResidual(const FineOperator& a, const Segment* first, const Segment* last,
                    const float* __restrict high, const float* __restrict low, float* __restrict r) {
  const auto at = [ high, low ](ptrdiff_t i) __attribute__((always_inline)) {
    return double{high[i]} + double{low[i]};
  };
  double total = 0.0;
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (ptrdiff_t i = begin; i < end; ++i) {
      const double around = (at(i - 1) + at(i + 1)) + (at(i - a.stride_y) + at(i + a.stride_y)) +
                            (at(i - a.stride_z) + at(i + a.stride_z));
      const float d = Diagonal(a, i);
      const double full = around - static_cast<double>(d) * at(i);
      const double value = d > 0.0F ? full : 0.0;
      r[i] = static_cast<float>(value);
      sum += value * value;
    }
    total += sum;
  }
  return total;
}

void Add(const Segment* first, const Segment* last, const float* __restrict term, float* __restrict sum) {
  for (const Segment* s = first; s != last; ++s) {
    const auto begin = static_cast<ptrdiff_t>(s->begin);
    const auto end = static_cast<ptrdiff_t>(s->begin + s->length);
#pragma omp simd
    for (ptrdiff_t i = begin; i < end; ++i) sum[i] += term[i];
  }
}

template <class Operator>
constexpr Sweeps<Operator> kSweeps{Start<Operator>, Subtract<Operator>, RestrictResidual<Operator>,
                                   Correct<Operator>, Finish<Operator>};

}  // namespace

extern const Kernels kKernels;
const Kernels kKernels{
    kSweeps<FineOperator>, kSweeps<CoarseOperator>, Direction, Apply, Advance, TrueResidual, Add};

#undef THALWEG_INLINE

}  // namespace thalweg::explorer::field::THALWEG_FIELD_ISA
