#pragma once

#include <cstddef>
#include <cstdint>

#include "services/explorer/core/field/layout.h"

/// The sweeps over a level, compiled for several instruction sets; the best that the machine has is chosen
/// when the program runs. Results depend on that choice in the last bits, never on the number of threads.
namespace thalweg::explorer::field {

/// Weight of the Jacobi smoother.
inline constexpr float kRelaxation = 0.83F;

/// The finest level: every open face has weight 1, so half a byte a cell is all its topology. Vectors are 0
/// in cells that are no unknowns, which makes the sum over all six neighbours the sum over the open faces.
struct FineOperator {
  /// Of each kChunk cells, four bits each, the first lowest: the number of open faces, to unknowns or to
  /// cells of given phi; 0 = no unknown.
  const std::uint32_t* degrees;
  std::ptrdiff_t stride_y, stride_z;
  alignas(32) float diagonal[8];  ///< Of each degree, screening included.
  alignas(32) float step[8];      ///< kRelaxation / diagonal; 0 for degree 0.
};

/// A coarse level: weights of the faces towards +x, +y, +z.
struct CoarseOperator {
  const float* diagonal;  ///< 0 = no unknown.
  const float *weight_x, *weight_y, *weight_z;
  std::ptrdiff_t stride_y, stride_z;
};

/// A vector of which the planes below, here and above may lie in different memory: each pointer is such that
/// the offset of a cell in the level finds it. Three times the same for a vector that lies in one piece.
struct Planes {
  const float *below, *here, *above;
};

/// What every level needs. In all sweeps `first` to `last` are the segments to sweep, A is the operator, D
/// its diagonal, P the constant interpolation from 2x2x2 blocks and w = kRelaxation.
template <class Operator>
struct Sweeps {
  /// coarse += P^T (r - A z) / 2
  void (*restrict_residual)(const Operator&, const Segment* first, const Segment* last, const float* r,
                            const Planes& z, float* coarse);
  /// out = z + w D^-1 (r - A z); returns r . out
  double (*finish)(const Operator&, const Segment* first, const Segment* last, const float* r,
                   const Planes& z, float* out);
};

struct Kernels {
  Sweeps<FineOperator> fine;
  Sweeps<CoarseOperator> coarse;
  /// z = w D^-1 r
  void (*start)(const CoarseOperator&, const Segment* first, const Segment* last, const float* r, float* z);
  /// r := r - A z
  void (*subtract)(const CoarseOperator&, const Segment* first, const Segment* last, const float* z,
                   float* r);
  /// z += P coarse
  void (*correct)(const CoarseOperator&, const Segment* first, const Segment* last, const float* coarse,
                  float* z);
  /// p = z + beta p
  void (*direction)(const Segment* first, const Segment* last, float beta, const float* z, float* p);
  /// q = A p; returns p . q
  double (*apply)(const FineOperator&, const Segment* first, const Segment* last, const float* p, float* q);
  /// x += alpha p; r_new = r - alpha q; z = w D^-1 r_new; returns r_new . r_new
  double (*advance)(const FineOperator&, const Segment* first, const Segment* last, float alpha,
                    const float* p, const float* q, const float* r, float* x, float* r_new, float* z);
  /// z = w D^-1 (r - alpha q)
  void (*advance_beside)(const FineOperator&, const Segment* first, const Segment* last, float alpha,
                         const float* q, const float* r, float* z);
  /// z = w D^-1 r + P coarse
  void (*start_corrected)(const FineOperator&, const Segment* first, const Segment* last, const float* coarse,
                          const float* r, float* z);
  /// r = b - A (high + low) in double precision, `high` holding the given values of phi, too; returns r . r
  double (*true_residual)(const FineOperator&, const Segment* first, const Segment* last, const float* high,
                          const float* low, float* r);
  /// sum += term
  void (*add)(const Segment* first, const Segment* last, const float* term, float* sum);
};

/// The best for this machine.
const Kernels& BestKernels();

}  // namespace thalweg::explorer::field
