#pragma once

#include <cstddef>
#include <cstdint>

#include "services/explorer/core/field/layout.h"
#include "services/explorer/core/field/multigrid_constants.h"

/// The sweeps over a level, compiled for several instruction sets; the best one that the machine supports is
/// selected at run time. The selection affects the last bits of results; the number of threads never does.
namespace thalweg::explorer::field {

/// The finest level. Every open face has weight 1, so half a byte per cell holds all of the topology. Vectors
/// are 0 in cells that are not unknowns, so the sum over all six neighbors equals the sum over the open
/// faces.
struct FineOperator {
  /// Four bits for each of kChunk cells, lowest bits first: the number of open faces, to unknowns or to cells
  /// with given phi; 0 = not an unknown.
  const std::uint32_t* degrees;
  std::ptrdiff_t stride_y, stride_z;
  alignas(32) float diagonal[8];  ///< By degree, screening included.
  alignas(32) float step[8];      ///< kRelaxation / diagonal; 0 for degree 0.
};

/// A coarse level with the weights of the faces toward +x, +y and +z.
struct CoarseOperator {
  const float* diagonal;  ///< 0 = not an unknown.
  const float *weight_x, *weight_y, *weight_z;
  std::ptrdiff_t stride_y, stride_z;
};

/// A vector whose planes below, here and above may be stored in different places. Each pointer is shifted so
/// that a cell's offset in the level addresses it. For a contiguous vector all three are equal.
struct Planes {
  const float *below, *here, *above;
};

/// The sweeps that every level needs. In all sweeps, `first` to `last` are the segments to sweep, A is the
/// operator, D its diagonal, P the constant interpolation from 2x2x2 blocks, and w = kRelaxation.
template <class Operator>
struct Sweeps {
  /// coarse += P^T (r - A z) / 2
  void (*restrict_residual)(const Operator&, const Segment* first, const Segment* last, const float* r,
                            const Planes& z, float* coarse);
  /// out = z + w D^-1 (r - A z); returns r . out
  double (*finish)(const Operator&, const Segment* first, const Segment* last, const float* r,
                   const Planes& z, float* out);
  /// out += z + w D^-1 (r - A z)
  void (*finish_onto)(const Operator&, const Segment* first, const Segment* last, const float* r,
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
  /// x += alpha p, with the p before; p = z + beta p
  void (*direction)(const Segment* first, const Segment* last, float alpha, float beta, const float* z,
                    float* x, float* p);
  /// q = A p; returns p . q
  double (*apply)(const FineOperator&, const Segment* first, const Segment* last, const float* p, float* q);
  /// r -= alpha q; returns r . r
  double (*descend)(const Segment* first, const Segment* last, float alpha, const float* q, float* r);
  /// r -= alpha q; z = w D^-1 r; returns r . r
  double (*advance)(const FineOperator&, const Segment* first, const Segment* last, float alpha,
                    const float* q, float* r, float* z);
  /// z = w D^-1 r
  void (*start_finest)(const FineOperator&, const Segment* first, const Segment* last, const float* r,
                       float* z);
  /// z = w D^-1 r + P coarse
  void (*start_corrected)(const FineOperator&, const Segment* first, const Segment* last, const float* coarse,
                          const float* r, float* z);
  /// r = b - A high in double precision, less A low in single precision; returns r . r
  /// Here `high` also holds the given values of phi. @param low  nullptr for 0.
  double (*true_residual)(const FineOperator&, const Segment* first, const Segment* last, const float* high,
                          const float* low, float* r);
  /// sum += factor term
  void (*add)(const Segment* first, const Segment* last, float factor, const float* term, float* sum);
};

/// The fastest version for this machine.
const Kernels& BestKernels();

}  // namespace thalweg::explorer::field
