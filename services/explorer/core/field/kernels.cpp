#include "services/explorer/core/field/kernels.h"

namespace thalweg::explorer::field {

namespace baseline {
extern const Kernels kKernels;
}
#ifdef THALWEG_FIELD_AVX2
namespace avx2 {
extern const Kernels kKernels;
}
#endif

const Kernels& BestKernels() {
#ifdef THALWEG_FIELD_AVX2
  static const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (has_avx2) return avx2::kKernels;
#endif
  return baseline::kKernels;
}

}  // namespace thalweg::explorer::field
